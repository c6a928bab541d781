// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/charuco.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>

#include <fmt/format.h>
#include <opencv2/aruco.hpp>

#include "hardware/board/board_plane.h"
#include "hardware/board/corner_fit.h"
#include "hardware/board/measured_board.h"

namespace glint {
namespace {

constexpr std::size_t kMinMarkerCorners = 6;
constexpr int kFirstSide =
    1300;  ///< longest side of the level on which markers are looked for first

cv::Ptr<cv::aruco::Dictionary> dictionary_of(const Board& board) {
  constexpr std::array<int, 4> kNames = {cv::aruco::DICT_4X4_1000,
                                         cv::aruco::DICT_5X5_1000,
                                         cv::aruco::DICT_6X6_1000,
                                         cv::aruco::DICT_7X7_1000};
  return cv::aruco::getPredefinedDictionary(kNames[static_cast<std::size_t>(board.dictionary)]);
}

/// The colour of the first square. White ones have markers.
enum class FirstSquare { kDark, kWhite };

bool is_white(const Eigen::Vector2i& square, FirstSquare first) {
  return ((square.x() + square.y()) % 2 == 0) == (first == FirstSquare::kWhite);
}

/// Squares with markers in the order of their numbers.
std::vector<Eigen::Vector2i> marker_squares(const Board& board, FirstSquare first) {
  std::vector<Eigen::Vector2i> squares;
  for (int row = 0; row <= board.rows; ++row) {
    for (int col = 0; col <= board.cols; ++col) {
      if (is_white({col, row}, first)) {
        squares.emplace_back(col, row);
      }
    }
  }
  return squares;
}

/// Markers of the dictionary as OpenCV finds them.
struct FoundMarkers {
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
};

/// Corners of markers, in squares counted from the first inner corner, and where they appear.
struct MarkersSeen {
  FirstSquare first = FirstSquare::kDark;
  std::vector<Eigen::Vector2d> places;
  std::vector<Eigen::Vector2d> picture_px;
  std::vector<Eigen::Vector2i> squares;  ///< of each marker
};

cv::Mat bytes_of(const ImageF& picture) {
  cv::Mat bytes(picture.height(), picture.width(), CV_8UC1);
  for (int y = 0; y < picture.height(); ++y) {
    std::transform(picture.row(y), picture.row(y) + picture.width(), bytes.ptr(y), [](float grey) {
      return static_cast<std::uint8_t>(std::clamp(255.0F * grey + 0.5F, 0.0F, 255.0F));
    });
  }
  return bytes;
}

FoundMarkers find_markers(const ImageF& picture, const Board& board) {
  FoundMarkers found;
  cv::aruco::detectMarkers(bytes_of(picture), dictionary_of(board), found.corners, found.ids);
  return found;
}

/// Where the markers are on the board. @param factor  picture's pixels in one of the level
MarkersSeen placed(const FoundMarkers& found,
                   double factor,
                   const Board& board,
                   FirstSquare first) {
  const std::vector<Eigen::Vector2i> squares = marker_squares(board, first);
  const double half = 0.5 * marker_side_mm(board) / board.square_mm;
  // Clockwise from the top left, seen from the front.
  const std::array<Eigen::Vector2d, 4> offsets = {Eigen::Vector2d(-half, -half),
                                                  Eigen::Vector2d(half, -half),
                                                  Eigen::Vector2d(half, half),
                                                  Eigen::Vector2d(-half, half)};
  MarkersSeen seen{.first = first};
  for (std::size_t i = 0; i < found.ids.size(); ++i) {
    if (static_cast<std::size_t>(found.ids[i]) >= squares.size()) {
      continue;
    }
    const Eigen::Vector2i& square = squares[static_cast<std::size_t>(found.ids[i])];
    seen.squares.push_back(square);
    const Eigen::Vector2d center = square.cast<double>() - Eigen::Vector2d(0.5, 0.5);
    for (std::size_t k = 0; k < 4; ++k) {
      seen.places.emplace_back(center + offsets[k]);
      const cv::Point2f& at = found.corners[i][k];  // OpenCV counts from the first pixel's centre
      seen.picture_px.emplace_back(factor *
                                   (Eigen::Vector2d(at.x, at.y) + Eigen::Vector2d(0.5, 0.5)));
    }
  }
  return seen;
}

/// OpenCV before 4.6 began with a white square where the rows of squares are even in number.
bool may_begin_white(const Board& board) {
  return board.rows % 2 == 1;
}

/// Corners of squares whose marker was seen: (col, row) on the board.
std::vector<Eigen::Vector2i> corners_beside(const MarkersSeen& seen, const Board& board) {
  std::set<std::pair<int, int>> beside;
  for (const Eigen::Vector2i& square : seen.squares) {
    for (const int row : {square.y() - 1, square.y()}) {
      for (const int col : {square.x() - 1, square.x()}) {
        if (row >= 0 && row < board.rows && col >= 0 && col < board.cols) {
          beside.emplace(row, col);
        }
      }
    }
  }
  std::vector<Eigen::Vector2i> corners;
  for (const auto& [row, col] : beside) {
    corners.emplace_back(col, row);
  }
  return corners;
}

CornerGuess guess_at(const BoardPlane& plane, const Eigen::Vector2i& corner, FirstSquare first) {
  const Eigen::Vector2d place = corner.cast<double>();
  const Eigen::Vector2d x(0.5, 0.0);
  const Eigen::Vector2d y(0.0, 0.5);
  const Eigen::Vector2d along = plane(place + x) - plane(place - x);
  const Eigen::Vector2d down = plane(place + y) - plane(place - y);
  const double area = std::abs(along.x() * down.y() - along.y() * down.x());
  const bool is_dark_before = !is_white(corner, first);
  return {.at_px = plane(place),
          .rising = is_dark_before ? down.normalized() : along.normalized(),
          .falling = is_dark_before ? Eigen::Vector2d(-along.normalized()) : down.normalized(),
          .clearance_px = area / std::max(along.norm(), down.norm())};
}

bool is_spread(const std::vector<Eigen::Vector2i>& corners) {
  std::set<int> cols;
  std::set<int> rows;
  for (const Eigen::Vector2i& corner : corners) {
    cols.insert(corner.x());
    rows.insert(corner.y());
  }
  return corners.size() >= kMinMarkerCorners && cols.size() >= 2 && rows.size() >= 2;
}

BoardView too_few(std::size_t markers, std::size_t corners) {
  return {
      .outcome = BoardOutcome::kNoBoard,
      .why = fmt::format("{} markers and {} corners beside them were found, {} corners are needed",
                         markers,
                         corners,
                         kMinMarkerCorners)};
}

BoardView measured(PictureLevels& levels, int level, const Board& board, const MarkersSeen& seen) {
  const auto plane = BoardPlane::fitted(
      seen.places, seen.picture_px, Eigen::Vector2d(levels.width(), levels.height()), 1 << level);
  std::vector<Eigen::Vector2i> corners;
  std::vector<CornerFit> fits;
  std::vector<double> clearance_px;
  // A window may not reach the nearest markers.
  const double free = std::sqrt(0.5) * (1.0 - marker_side_mm(board) / board.square_mm) / 0.42;
  for (const Eigen::Vector2i& corner :
       plane ? corners_beside(seen, board) : std::vector<Eigen::Vector2i>()) {
    CornerGuess guess = guess_at(*plane, corner, seen.first);
    const double clearance = guess.clearance_px;
    guess.clearance_px *= std::min(1.0, free);
    const auto fit = fit_corner(levels, level, guess);
    if (fit && fit->contrast > 0.0 && fit->noise < 0.5 * fit->contrast) {
      corners.push_back(corner);
      fits.push_back(*fit);
      clearance_px.push_back(clearance);
    }
  }
  if (!is_spread(corners)) {
    return too_few(seen.squares.size(), corners.size());
  }
  BoardView view = judged_corners(board, corners, fits, clearance_px);
  view.is_orientation_known = true;
  return view;
}

}  // namespace

std::vector<CharucoMarker> charuco_markers(const Board& board) {
  const auto dictionary = dictionary_of(board);
  std::vector<CharucoMarker> markers;
  int id = 0;
  for (const Eigen::Vector2i& square : marker_squares(board, FirstSquare::kDark)) {
    CharucoMarker marker = {.id = id, .square = square, .side = dictionary->markerSize + 2};
    cv::Mat modules;
    cv::aruco::drawMarker(dictionary, id++, marker.side, modules, 1);
    for (int y = 0; y < marker.side; ++y) {
      for (int x = 0; x < marker.side; ++x) {
        marker.is_dark.push_back(modules.at<std::uint8_t>(y, x) == 0);
      }
    }
    markers.push_back(std::move(marker));
  }
  return markers;
}

std::optional<BoardView> find_charuco(PictureLevels& levels, const Board& board) {
  int level = 0;
  while (std::max(levels.width(), levels.height()) >> level > kFirstSide) {
    ++level;
  }
  std::optional<BoardView> best;
  for (; level >= 0; --level) {
    const FoundMarkers found = find_markers(levels.level(level), board);
    const MarkersSeen seen = placed(found, 1 << level, board, FirstSquare::kDark);
    if (seen.squares.empty()) {
      continue;
    }
    best = measured(levels, level, board, seen);
    if (best->outcome == BoardOutcome::kNoBoard && may_begin_white(board)) {
      BoardView older =
          measured(levels, level, board, placed(found, 1 << level, board, FirstSquare::kWhite));
      best = older.outcome == BoardOutcome::kNoBoard ? std::move(best) : std::move(older);
    }
    if (best->outcome != BoardOutcome::kNoBoard) {
      return best;
    }
  }
  return best;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/measured_board.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/median.h"
#include "core/units.h"
#include "hardware/board/board_plane.h"
#include "hardware/board/corner_guesses.h"
#include "hardware/board/larger_board.h"

namespace glint {
namespace {

constexpr double kBorderPx = 3.0;      ///< of a level: too little for a window
constexpr double kMaxBlur = 0.2;       ///< of the way to the next edges
constexpr double kMinNoises = 4.0;     ///< of the contrast
constexpr double kMinContrast = 0.02;  ///< of full scale
constexpr double kMaxBend = 0.1;       ///< rms from a plane, of the way to the next edges

Eigen::Vector2d size_of(const PictureLevels& levels) {
  return {levels.width(), levels.height()};
}

/// A grid's corners on a plane, in px of the picture.
std::optional<BoardPlane> plane_of(const PictureLevels& levels,
                                   int level,
                                   std::span<const SaddlePoint> points,
                                   const CornerGrid& grid) {
  std::vector<Eigen::Vector2d> places;
  std::vector<Eigen::Vector2d> picture_px;
  for (const GridCorner& corner : grid) {
    places.emplace_back(corner.col, corner.row);
    picture_px.emplace_back(points[corner.point].at_px * (1 << level));
  }
  return BoardPlane::fitted(places, picture_px, size_of(levels), 0.3 * (1 << level));
}

/// Distance of a point from the nearest border, negative outside.
double inside_px(const PictureLevels& levels, const Eigen::Vector2d& at_px) {
  return std::min({at_px.x(), at_px.y(), levels.width() - at_px.x(), levels.height() - at_px.y()});
}

/// The corners of a grid that are the board's.
CornerGrid board_part(const Board& board, const CornerGrid& grid, const GridPlacement& placement) {
  const Eigen::Vector2i a = placement.first;
  const Eigen::Vector2i b = placement.place(board.cols - 1, board.rows - 1);
  const Eigen::Vector2i low = a.cwiseMin(b);
  const Eigen::Vector2i high = a.cwiseMax(b);
  CornerGrid part;
  std::ranges::copy_if(grid, std::back_inserter(part), [&](const GridCorner& corner) {
    return corner.col >= low.x() && corner.col <= high.x() && corner.row >= low.y() &&
           corner.row <= high.y();
  });
  return part;
}

/// Mean grey value of a disc around a place of the plane, radii in places.
double grey_in_disc(PictureLevels& levels,
                    int level,
                    const BoardPlane& plane,
                    const Eigen::Vector2d& center,
                    double radius) {
  constexpr int kSamples = 12;
  const ImageF& picture = levels.level(level);
  double sum = 0.0;
  for (int k = 0; k < kSamples; ++k) {
    const double angle = 2.0 * kPi * k / kSamples;
    const Eigen::Vector2d at =
        plane(center + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle))) / (1 << level);
    const int x = std::clamp(static_cast<int>(at.x()), 0, picture.width() - 1);
    const int y = std::clamp(static_cast<int>(at.y()), 0, picture.height() - 1);
    sum += static_cast<double>(picture(x, y));
  }
  return sum / kSamples;
}

/// Whether the first square of a placement has the dot of the other colour.
bool has_mark(PictureLevels& levels,
              int level,
              const BoardPlane& plane,
              const GridPlacement& placement,
              double contrast) {
  const Eigen::Vector2d center =
      placement.first.cast<double>() - 0.5 * (placement.along + placement.down).cast<double>();
  const double dot = grey_in_disc(levels, level, plane, center, 0.3 * kMarkSquares);
  const double around =
      grey_in_disc(levels, level, plane, center, 0.5 * (0.5 * kMarkSquares + 0.5));
  return std::abs(dot - around) > 0.4 * contrast;
}

/// The placement that the mark tells, else the one whose +x points most to the right.
struct ChosenPlacement {
  GridPlacement placement;
  bool is_known = false;
};

ChosenPlacement chosen(PictureLevels& levels,
                       int level,
                       const Board& board,
                       const BoardPlane& plane,
                       std::span<const GridPlacement> placements,
                       double contrast) {
  std::vector<GridPlacement> marked;
  if (board.mark) {
    std::ranges::copy_if(placements, std::back_inserter(marked), [&](const GridPlacement& p) {
      return has_mark(levels, level, plane, p, contrast);
    });
    if (marked.size() == 1) {
      return {.placement = marked.front(), .is_known = true};
    }
  }
  const auto rightwards = [&](const GridPlacement& p) {
    const Eigen::Vector2d first = plane(p.first.cast<double>());
    const Eigen::Vector2d step = plane((p.first + p.along).cast<double>()) - first;
    return -step.x();
  };
  return {.placement = *std::ranges::min_element(placements, {}, rightwards),
          .is_known = !board.mark && num_symmetries(board) == 1 && placements.size() == 1};
}

/// The first corner of the board that a window does not fit around, when there is one.
std::optional<Eigen::Vector2i> corner_outside(const PictureLevels& levels,
                                              int level,
                                              const Board& board,
                                              const BoardPlane& plane,
                                              const GridPlacement& placement) {
  for (int row = 0; row < board.rows; ++row) {
    for (int col = 0; col < board.cols; ++col) {
      const Eigen::Vector2d at_px = plane(placement.place(col, row).cast<double>());
      if (!(inside_px(levels, at_px) > kBorderPx * (1 << level))) {
        return Eigen::Vector2i(col, row);
      }
    }
  }
  return std::nullopt;
}

/// Whether light is clipped at a point.
bool is_clipped(PictureLevels& levels, int level, const Eigen::Vector2d& at_px) {
  const ImageF& picture = levels.level(level);
  const int x = std::clamp(static_cast<int>(at_px.x()) >> level, 0, picture.width() - 1);
  const int y = std::clamp(static_cast<int>(at_px.y()) >> level, 0, picture.height() - 1);
  return static_cast<double>(picture(x, y)) >= levels.clipped_value();
}

/// The board's corners, fitted one by one.
struct FittedBoard {
  std::vector<Eigen::Vector2i> col_row;
  std::vector<CornerFit> fits;
  std::vector<double> clearance_px;
  std::string fault;                              ///< empty: all were fitted
  BoardOutcome outcome = BoardOutcome::kNoBoard;  ///< where there is a fault
};

FittedBoard fitted_board(PictureLevels& levels,
                         const Board& board,
                         int level,
                         const CornerGuesses& guesses,
                         const GridPlacement& placement) {
  FittedBoard result;
  for (int row = 0; row < board.rows; ++row) {
    for (int col = 0; col < board.cols; ++col) {
      const CornerGuess guess = guesses(placement.place(col, row));
      const auto fit = fit_corner(levels, level, guess);
      if (!fit) {
        result.outcome = is_clipped(levels, level, guess.at_px) ? BoardOutcome::kSaturated
                                                                : BoardOutcome::kNoBoard;
        result.fault = fmt::format("the corner at column {}, row {} cannot be measured", col, row);
        return result;
      }
      result.col_row.emplace_back(col, row);
      result.fits.push_back(*fit);
      result.clearance_px.push_back(guess.clearance_px);
    }
  }
  return result;
}

/// A corner that looks unlike all others is something else: a hand, a spot of light.
void find_fault(FittedBoard& fitted) {
  std::vector<double> contrasts;
  for (const CornerFit& fit : fitted.fits) {
    contrasts.push_back(fit.contrast);
  }
  const double usual = median(contrasts);
  for (std::size_t i = 0; i < fitted.fits.size(); ++i) {
    const CornerFit& fit = fitted.fits[i];
    if (fit.contrast < 0.15 * usual || fit.noise > 0.5 * std::max(fit.contrast, 0.5 * usual)) {
      fitted.fault = fmt::format("the corner at column {}, row {} does not look like one",
                                 fitted.col_row[i].x(),
                                 fitted.col_row[i].y());
      fitted.outcome = fit.clipped_share > 0.3 ? BoardOutcome::kSaturated : BoardOutcome::kNoBoard;
      return;
    }
  }
}

/// The measured corners on a plane.
std::optional<BoardPlane> fine_plane(const PictureLevels& levels, const FittedBoard& fitted) {
  std::vector<Eigen::Vector2d> places;
  std::vector<Eigen::Vector2d> picture_px;
  for (std::size_t i = 0; i < fitted.fits.size(); ++i) {
    places.emplace_back(fitted.col_row[i].cast<double>());
    picture_px.push_back(fitted.fits[i].at_px);
  }
  constexpr double kAccuracyPx = 0.05;
  return BoardPlane::fitted(places, picture_px, size_of(levels), kAccuracyPx);
}

/// What keeps measured corners from being used: the view, refused, or as it is.
BoardView judged(BoardView view, double max_blur) {
  if (view.contrast < std::max(kMinContrast, kMinNoises * view.noise)) {
    return refused_view(
        BoardOutcome::kDark,
        fmt::format("white differs from black by {:.1f} % of full scale, noise is {:.1f} %",
                    100.0 * view.contrast,
                    100.0 * view.noise));
  }
  if (max_blur > kMaxBlur) {
    return refused_view(
        BoardOutcome::kBlurred,
        fmt::format("edges are blurred by {:.0f} % of a square, at most {:.0f} % are "
                    "allowed",
                    100.0 * max_blur,
                    100.0 * kMaxBlur));
  }
  return view;
}

/// Columns and rows from begin to end, both included.
struct GridRange {
  Eigen::Vector2i begin;
  Eigen::Vector2i end;
};

/// The places of a grid and those around it that the board may have as well.
GridRange with_neighbours(const CornerGrid& grid, const Board& board) {
  Eigen::Vector2i low(grid.front().col, grid.front().row);
  Eigen::Vector2i high = low;
  for (const GridCorner& corner : grid) {
    low = low.cwiseMin(Eigen::Vector2i(corner.col, corner.row));
    high = high.cwiseMax(Eigen::Vector2i(corner.col, corner.row));
  }
  const Eigen::Vector2i size = high - low + Eigen::Vector2i::Ones();
  const bool is_upright = size.x() <= board.cols && size.y() <= board.rows;
  const int missing_x = (is_upright ? board.cols : board.rows) - size.x();
  const int missing_y = (is_upright ? board.rows : board.cols) - size.y();
  const Eigen::Vector2i grow(missing_x > 0 ? 1 : 0, missing_y > 0 ? 1 : 0);
  return {.begin = low - grow, .end = high + grow};
}

/// Pixels around a place where a corner is missing.
struct PixelCount {
  int inside = 0;
  int clipped = 0;

  void add(PictureLevels& levels, int level, const Eigen::Vector2d& at_px) {
    const ImageF& picture = levels.level(level);
    const Eigen::Vector2d on_level = at_px / (1 << level);
    for (int k = -2; k <= 2; ++k) {
      const float grey =
          picture(static_cast<int>(on_level.x()) + k, static_cast<int>(on_level.y()) + k);
      ++inside;
      clipped += static_cast<double>(grey) >= levels.clipped_value() ? 1 : 0;
    }
  }
};

}  // namespace

BoardView judged_corners(const Board& board,
                         std::span<const Eigen::Vector2i> col_row,
                         std::span<const CornerFit> fits,
                         std::span<const double> clearance_px) {
  BoardView view = {.outcome = BoardOutcome::kAccepted};
  std::vector<double> noises;
  std::vector<double> contrasts;
  double max_blur = 0.0;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    view.board_mm.push_back(corner_mm(board, col_row[i].x(), col_row[i].y()));
    view.picture_px.push_back(fits[i].at_px);
    view.blur_px.push_back(fits[i].blur_px);
    noises.push_back(fits[i].noise);
    contrasts.push_back(fits[i].contrast);
    max_blur = std::max(max_blur, fits[i].blur_px / clearance_px[i]);
  }
  view.noise = median(noises);
  view.contrast = median(contrasts);
  return judged(std::move(view), max_blur);
}

BoardView measured_board(PictureLevels& levels,
                         const Board& board,
                         int level,
                         std::span<const SaddlePoint> points,
                         const CornerGrid& whole_grid,
                         std::span<const GridPlacement> placements) {
  const CornerGrid grid = board_part(board, whole_grid, placements.front());
  const auto plane = plane_of(levels, level, points, grid);
  if (!plane) {
    return refused_view(BoardOutcome::kNoBoard, "the corners lie on a line");
  }
  const ChosenPlacement choice =
      chosen(levels, level, board, *plane, placements, points[grid.front().point].contrast);
  const auto outside = corner_outside(levels, level, board, *plane, choice.placement);
  if (outside) {
    return refused_view(
        BoardOutcome::kCutOff,
        fmt::format("the corner at column {}, row {} lies outside the picture or at its border",
                    outside->x(),
                    outside->y()));
  }
  const CornerGuesses guesses(level, *plane, points, grid);
  FittedBoard fitted = fitted_board(levels, board, level, guesses, choice.placement);
  if (fitted.fault.empty()) {
    find_fault(fitted);
  }
  if (!fitted.fault.empty()) {
    return refused_view(fitted.outcome, fitted.fault);
  }
  const auto fine = fine_plane(levels, fitted);
  const double clearance = *std::ranges::min_element(fitted.clearance_px);
  if (!fine || fine->rms_px() > std::max(1.0, kMaxBend * clearance)) {
    return refused_view(BoardOutcome::kNoBoard, "the corners do not lie on a plane");
  }
  BoardView view = judged_corners(board, fitted.col_row, fitted.fits, fitted.clearance_px);
  if (view.is_accepted()) {
    const Eigen::Vector2i larger =
        larger_grid(levels, level, board, choice.placement, guesses, view.contrast);
    if (!larger.isZero()) {
      return refused_as_larger(board, larger);
    }
  }
  view.is_orientation_known = choice.is_known;
  return view;
}

MissingPart missing_part(PictureLevels& levels,
                         const Board& board,
                         int level,
                         std::span<const SaddlePoint> points,
                         const CornerGrid& grid) {
  MissingPart result;
  const auto plane = plane_of(levels, level, points, grid);
  if (!plane) {
    return result;
  }
  const auto [begin, end] = with_neighbours(grid, board);
  PixelCount pixels;
  for (int x = begin.x(); x <= end.x(); ++x) {
    for (int y = begin.y(); y <= end.y(); ++y) {
      const auto is_here = [&](const GridCorner& c) { return c.col == x && c.row == y; };
      if (std::ranges::any_of(grid, is_here)) {
        continue;
      }
      const Eigen::Vector2d at_px = (*plane)(Eigen::Vector2d(x, y));
      // Nothing is found within 8 px of the border of a level.
      if (!(inside_px(levels, at_px) > 8.0 * (1 << level))) {
        result.reaches_border = true;
        continue;
      }
      pixels.add(levels, level, at_px);
    }
  }
  result.clipped_share =
      pixels.inside == 0 ? 0.0 : static_cast<double>(pixels.clipped) / pixels.inside;
  return result;
}

}  // namespace glint

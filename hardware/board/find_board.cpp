// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/find_board.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "hardware/board/board_plane.h"
#include "hardware/board/charuco.h"
#include "hardware/board/corner_grid.h"
#include "hardware/board/larger_board.h"
#include "hardware/board/measured_board.h"
#include "hardware/board/picture_levels.h"

namespace glint {
namespace {

constexpr int kFirstWidth = 500;   ///< longest side of the level that is tried first, px
constexpr int kSmallestSide = 48;  ///< of a level
constexpr double kMaxMissing = 0.15;

/// The grid that shows most of the board, on one level.
struct BestGrid {
  int level = 0;
  std::vector<SaddlePoint> points;
  CornerGrid grid;
  BoardInGrid found;
};

std::optional<BestGrid> best_grid(PictureLevels& levels, int level, const Board& board) {
  const ImageF& picture = levels.level(level);
  BestGrid best = {.level = level,
                   .points = find_saddle_points(picture, std::max(400, 5 * num_corners(board)))};
  for (CornerGrid& grid : find_corner_grids(best.points, picture)) {
    if (static_cast<int>(grid.size()) <= best.found.num_found) {
      break;  // they come by size
    }
    BoardInGrid found = board_in_grid(board, grid);
    if (found.num_found > best.found.num_found) {
      best.found = std::move(found);
      best.grid = std::move(grid);
    }
  }
  return best.grid.empty() ? std::nullopt : std::optional(std::move(best));
}

/// Levels in the order they are tried.
std::vector<int> search_order(const PictureLevels& levels) {
  int first = 0;
  while (std::max(levels.width(), levels.height()) >> first > kFirstWidth) {
    ++first;
  }
  std::vector<int> order;
  for (int level = first; level >= 0; --level) {
    order.push_back(level);
  }
  const int smaller_side = std::min(levels.width(), levels.height());
  for (int level = first + 1; level <= first + 3 && smaller_side >> level >= kSmallestSide;
       ++level) {
    order.push_back(level);
  }
  return order;
}

bool is_whole(const BestGrid& best, const Board& board) {
  const int missing = num_corners(board) - best.found.num_found;
  return missing <= static_cast<int>(kMaxMissing * num_corners(board)) &&
         best.found.num_beyond <= std::min(board.cols, board.rows) / 2;
}

/// A grey value that a share of the pixels does not exceed.
double grey_quantile(const ImageF& picture, double share) {
  std::vector<float> values(picture.values().begin(), picture.values().end());
  const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, values.begin() + at);
  return static_cast<double>(values[static_cast<std::size_t>(at)]);
}

/// Of a picture in which no part of a board was found. @param why  it may not be its light
BoardView without_board(PictureLevels& levels, const char* why) {
  const ImageF& coarse = levels.level(search_order(levels).front());
  constexpr double kDark = 0.06;
  const double bright = grey_quantile(coarse, 0.995);
  if (bright < kDark) {
    return refused_view(
        BoardOutcome::kDark,
        fmt::format("its brightest parts reach {:.1f} % of full scale", 100.0 * bright));
  }
  if (grey_quantile(coarse, 0.5) >= levels.clipped_value()) {
    return refused_view(BoardOutcome::kSaturated, "half of its pixels are at full scale");
  }
  return refused_view(BoardOutcome::kNoBoard, why);
}

/// Of a picture with a part of a board.
BoardView incomplete(PictureLevels& levels, const Board& board, const BestGrid& best) {
  const std::string found =
      fmt::format("{} of {} corners were found", best.found.num_found, num_corners(board));
  if (best.found.num_beyond > std::min(board.cols, board.rows) / 2) {
    BoardView view = refused_view(BoardOutcome::kNoBoard,
                                  fmt::format("a grid of {} corners, the board has {} x {}",
                                              best.grid.size(),
                                              board.cols,
                                              board.rows));
    if (best.found.num_found == num_corners(board)) {
      view.larger_grid = larger_grid(board, best.grid);
    }
    return view;
  }
  const MissingPart missing = missing_part(levels, board, best.level, best.points, best.grid);
  if (missing.reaches_border) {
    return refused_view(BoardOutcome::kCutOff, found + ", the board reaches the picture's border");
  }
  if (missing.clipped_share > 0.1) {
    return refused_view(BoardOutcome::kSaturated, found + ", beside them light is clipped");
  }
  return refused_view(BoardOutcome::kNoBoard, found);
}

BoardView find_checkerboard(PictureLevels& levels, const Board& board) {
  std::optional<BestGrid> most;
  std::optional<BoardView> refusal;
  for (const int level : search_order(levels)) {
    std::optional<BestGrid> best = best_grid(levels, level, board);
    if (best && is_whole(*best, board)) {
      BoardView view =
          measured_board(levels, board, level, best->points, best->grid, best->found.placements);
      // What looks incomplete on one level may be whole on the next.
      const bool is_larger = !view.larger_grid.isZero();
      if (is_larger ||
          (view.outcome != BoardOutcome::kNoBoard && view.outcome != BoardOutcome::kCutOff)) {
        return view;
      }
      if (!refusal || view.outcome == BoardOutcome::kCutOff) {
        refusal = std::move(view);
      }
    }
    if (best && (!most || best->found.num_found > most->found.num_found)) {
      most = std::move(best);
    }
  }
  // A few that look like a part of a grid are found in any noise.
  const int fewest = num_corners(board) / 4;
  if (refusal) {
    return *refusal;
  }
  return most && most->found.num_found >= fewest
             ? incomplete(levels, board, *most)
             : without_board(levels, "no part of a checkerboard was found");
}

}  // namespace

BoardView find_board(const Pixels& picture, const Board& board) {
  PictureLevels levels(picture);
  if (std::min(levels.width(), levels.height()) < kSmallestSide) {
    return refused_view(BoardOutcome::kNoBoard,
                        fmt::format("the picture has {} x {} pixels, at least {} x {} are needed",
                                    levels.width(),
                                    levels.height(),
                                    kSmallestSide,
                                    kSmallestSide));
  }
  if (board.kind != BoardKind::kCharuco) {
    return find_checkerboard(levels, board);
  }
  std::optional<BoardView> view = find_charuco(levels, board);
  return view ? *std::move(view) : without_board(levels, "no marker of the board was found");
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/larger_board.h"

#include <algorithm>

namespace glint {
namespace {

/// Looks at single corners beyond a board.
class Beyond {
 public:
  Beyond(PictureLevels& levels,
         int level,
         const GridPlacement& placement,
         const CornerGuesses& guesses,
         double contrast)
      : levels_(levels),
        level_(level),
        placement_(placement),
        guesses_(guesses),
        contrast_(contrast) {}

  /// Where the outermost squares end two edges meet in a T, which the model of a corner leaves a
  /// quarter of the contrast and more of.
  bool has_corner(int col, int row) const {
    constexpr double kMinContrast = 0.6;
    constexpr double kMaxNoise = 0.2;
    const auto fit = fit_corner(levels_, level_, guesses_(placement_.place(col, row)));
    return fit && fit->contrast > kMinContrast * contrast_ &&
           fit->noise < kMaxNoise * fit->contrast;
  }

  bool has_column(int col, int rows) const {
    return has_corner(col, rows / 2) && all_of(rows, [&](int row) { return has_corner(col, row); });
  }

  bool has_row(int row, int cols) const {
    return has_corner(cols / 2, row) && all_of(cols, [&](int col) { return has_corner(col, row); });
  }

 private:
  template <class Test>
  static bool all_of(int count, const Test& test) {
    for (int i = 0; i < count; ++i) {
      if (!test(i)) {
        return false;
      }
    }
    return true;
  }

  PictureLevels& levels_;
  int level_;
  const GridPlacement& placement_;
  const CornerGuesses& guesses_;
  double contrast_;
};

}  // namespace

Eigen::Vector2i larger_grid(PictureLevels& levels,
                            int level,
                            const Board& board,
                            const GridPlacement& placement,
                            const CornerGuesses& guesses,
                            double contrast) {
  const Beyond beyond(levels, level, placement, guesses, contrast);
  const bool has_column =
      beyond.has_column(-1, board.rows) || beyond.has_column(board.cols, board.rows);
  const bool has_row = beyond.has_row(-1, board.cols) || beyond.has_row(board.rows, board.cols);
  if (!has_column && !has_row) {
    return Eigen::Vector2i::Zero();
  }
  return {board.cols + (has_column ? 1 : 0), board.rows + (has_row ? 1 : 0)};
}

Eigen::Vector2i larger_grid(const Board& board, const CornerGrid& grid) {
  Eigen::Vector2i low(grid.front().col, grid.front().row);
  Eigen::Vector2i high = low;
  for (const GridCorner& corner : grid) {
    low = low.cwiseMin(Eigen::Vector2i(corner.col, corner.row));
    high = high.cwiseMax(Eigen::Vector2i(corner.col, corner.row));
  }
  const Eigen::Vector2i size = high - low + Eigen::Vector2i::Ones();
  if (static_cast<double>(grid.size()) < 0.9 * size.prod()) {
    return Eigen::Vector2i::Zero();
  }
  const bool is_wide = board.cols >= board.rows;
  return {is_wide ? size.maxCoeff() : size.minCoeff(), is_wide ? size.minCoeff() : size.maxCoeff()};
}

}  // namespace glint

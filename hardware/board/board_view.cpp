// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/board_view.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"

namespace glint {
namespace {

bool is_same_view(const BoardView& a, const BoardView& b, double limit_px) {
  return std::ranges::equal(a.picture_px,
                            b.picture_px,
                            [&](const Eigen::Vector2d& p, const Eigen::Vector2d& q) {
                              return (p - q).norm() <= limit_px;
                            }) &&
         std::ranges::equal(a.board_mm, b.board_mm);
}

}  // namespace

std::string outcome_name(BoardOutcome outcome) {
  constexpr std::array<const char*, 7> kNames = {
      "accepted", "no board", "cut off", "blurred", "saturated", "dark", "doubled"};
  return kNames[static_cast<std::size_t>(outcome)];
}

BoardView refused_view(BoardOutcome outcome, std::string why) {
  return {.outcome = outcome, .why = std::move(why)};
}

BoardView refused_as_larger(const Board& board, const Eigen::Vector2i& larger_grid) {
  return {.outcome = BoardOutcome::kNoBoard,
          .why = fmt::format("a larger board: at least {} x {} corners, not {} x {}",
                             larger_grid.x(),
                             larger_grid.y(),
                             board.cols,
                             board.rows),
          .larger_grid = larger_grid};
}

void reject_doubled(std::vector<BoardView>& views,
                    const std::vector<std::string>& names,
                    double limit_px) {
  GLINT_CHECK(views.size() == names.size(), "a name for each view");
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (std::size_t j = 0; j < i && views[i].is_accepted(); ++j) {
      if (views[j].is_accepted() && is_same_view(views[i], views[j], limit_px)) {
        views[i] = {.outcome = BoardOutcome::kDoubled,
                    .why = fmt::format("shows the same view as {}", names[j])};
      }
    }
  }
}

}  // namespace glint

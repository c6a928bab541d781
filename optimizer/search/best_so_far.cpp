// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/search/best_so_far.h"

#include <utility>

#include "optimizer/algorithm/merit.h"
#include "optimizer/front/compromise.h"
#include "optimizer/front/front.h"
#include "optimizer/search/trade_off.h"

namespace glint {

void BestSoFar::add(int number, const Scores& scores) {
  if (has_several_objectives(*goal_) && is_feasible(*goal_, scores)) {
    add_to_front(number, scores);
  } else if (front_.empty() && (!best_ || is_better(*goal_, scores, scores_))) {
    best_ = number;
    scores_ = scores;
  }
}

void BestSoFar::add_to_front(int number, const Scores& scores) {
  front_.push_back(number);
  rows_.push_back(minimised_objectives(*goal_, scores));
  std::vector<int> kept;
  std::vector<std::vector<double>> rows;
  for (const std::size_t row : front_of(rows_)) {
    kept.push_back(front_[row]);
    rows.push_back(rows_[row]);
  }
  front_ = std::move(kept);
  rows_ = std::move(rows);
  best_ = front_[compromise_of(rows_, front_choice_of(*goal_))];
}

}  // namespace glint

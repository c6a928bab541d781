// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a search will cost, from its first evaluations.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace glint {

/// CPU seconds of a search while it goes on. Those of a batch that are evaluated at once also end
/// at once, so that only whole batches tell what one costs.
class SearchClock {
 public:
  /// @param at_once  evaluations at once, >= 1
  explicit SearchClock(int at_once) : at_once_(static_cast<std::size_t>(at_once)) {}

  /// @param evaluations  that have ended, >= 0 and never fewer than before
  /// @param spent_s  CPU seconds since the search began
  void note(int evaluations, double spent_s) {
    spent_s_.resize(static_cast<std::size_t>(evaluations), spent_s);
  }

  /// Enough is known. CPU seconds: on a busy machine as many designs are evaluated as on an idle
  /// one, since a search's first ones alone are no sample of the rest.
  bool is_long() const { return spent_s_.size() >= 2 * at_once_ && spent_s_.back() > kLong_s; }

  /// The mean over so many evaluations, of which the last ones are taken to cost what those of the
  /// later half so far do: the first pay for cold caches and are spread over all of the space.
  /// @param evaluations  >= 1
  double mean_s(int evaluations) const {
    if (spent_s_.empty()) {
      return 0.0;
    }
    const std::size_t whole = std::max<std::size_t>(1, spent_s_.size() / at_once_ * at_once_);
    const std::size_t half = whole / 2 / at_once_ * at_once_;
    const double first_s = half > 0 ? spent_s_[half - 1] : 0.0;
    const double each_s = (spent_s_[whole - 1] - first_s) / static_cast<double>(whole - half);
    const auto count = static_cast<double>(spent_s_.size());
    const double further = std::max(0.0, evaluations - count);
    return (spent_s_.back() + each_s * further) / (count + further);
  }

 private:
  static constexpr double kLong_s = 15.0;

  std::size_t at_once_ = 1;
  std::vector<double> spent_s_;  ///< after each evaluation
};

}  // namespace glint

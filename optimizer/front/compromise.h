// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which design of a front to take. All objectives are minimised, and each is measured in parts of
// the range that it has on the front: 0 is the best value there, 1 the worst.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace glint {

enum class ChoiceRule {
  kKnee,        ///< nearest to the best of all objectives at once
  kWeights,     ///< smallest weighted sum of what is given up
  kAspirations  ///< reaches what is aspired to; else misses it by least
};

/// "knee", "weights", "aspirations"
std::string_view choice_rule_name(ChoiceRule rule);

struct FrontChoice {
  ChoiceRule rule = ChoiceRule::kKnee;
  std::vector<double> weights = {};                     ///< > 0, one an objective; empty: all 1
  std::vector<std::optional<double>> aspirations = {};  ///< one an objective; empty: none
};

/// The row to take; of equals the first. Of rows that reach every aspiration the knee is taken;
/// where none does, the one whose largest weighted shortfall is smallest.
/// @param front  front_of() some rows, all finite, at least one
std::size_t compromise_of(std::span<const std::vector<double>> front, const FrontChoice& choice);

}  // namespace glint

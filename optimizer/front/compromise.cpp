// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/front/compromise.h"

#include <array>

#include "optimizer/front/choice_cost.h"

namespace glint {
namespace {

using Rows = std::span<const std::vector<double>>;

}  // namespace

std::string_view choice_rule_name(ChoiceRule rule) {
  constexpr std::array<std::string_view, 3> kNames = {"knee", "weights", "aspirations"};
  return kNames[static_cast<std::size_t>(rule)];
}

std::vector<std::vector<double>> given_up(Rows front) {
  const std::vector<ObjectiveRange> ranges = objective_ranges(front);
  std::vector<std::vector<double>> parts;
  for (const std::vector<double>& row : front) {
    parts.push_back(parts_of(row, ranges));
  }
  return parts;
}

std::size_t compromise_of(Rows front, const FrontChoice& choice) {
  return compromise_of(front, objective_ranges(front), choice);
}

}  // namespace glint

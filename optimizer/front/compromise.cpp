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

std::size_t compromise_of(Rows front, const FrontChoice& choice) {
  return compromise_of(front, objective_ranges(front), choice);
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What several verbs write of an inspection, always in the same way.
#pragma once

#include <nlohmann/json.hpp>

#include "metrics/inspection/inspection_settings.h"
#include "metrics/statistics/estimate.h"

namespace glint {

inline nlohmann::ordered_json estimate_json(const Estimate& estimate) {
  return {{"value", estimate.value}, {"low", estimate.low}, {"high", estimate.high}};
}

inline nlohmann::ordered_json limits_json(const GradeLimits& limits) {
  return {{"perfect_biggest", limits.perfect_biggest},
          {"perfect_sum", limits.perfect_sum},
          {"acceptable_biggest", limits.acceptable_biggest},
          {"acceptable_sum", limits.acceptable_sum}};
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// A comparison as JSON and as a sentence (docs/compare.md).
#pragma once

#include <optional>
#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "studies/compare/causes.h"
#include "studies/compare/compared_pair.h"
#include "studies/compare/inspected_pair.h"
#include "studies/compare/yardstick.h"

namespace glint {

/// One of the result's `pairs`; what is not known is null.
nlohmann::ordered_json pair_json(const ComparedPair& pair, const PairCauses& causes);

/// What the inspector finds on both sides.
nlohmann::ordered_json inspection_json(const InspectedPair& pair);

/// The result's `yardstick`; null without one.
nlohmann::ordered_json yardstick_json(const std::optional<Yardstick>& yardstick);

/// The verdict, from the pairs as pair_json() gives them.
std::string compare_verdict(const nlohmann::ordered_json& pairs,
                            const std::optional<Yardstick>& yardstick);

}  // namespace glint

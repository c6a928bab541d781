// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a report says of the finalists of each kind of light, `kinds` of a run's result.json.
//
//   kind_ahead  scored again, another kind than the winner's comes first; of one objective, and
//               where finalists raced only with a lead larger than the noise
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "studies/report/report_findings.h"

namespace glint::report_detail {

/// @param data  with `kinds` and the design "winner"; nothing is said without them
std::vector<Finding> findings_on_kinds(const nlohmann::ordered_json& data);

/// A section with a row for each kind. @param data  with `kinds`
nlohmann::ordered_json kinds_panel(const nlohmann::ordered_json& data);

}  // namespace glint::report_detail

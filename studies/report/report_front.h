// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a verdict says of a front. Private to the module.
//
//   front_range           from where to where its designs go in each objective
//   front_expected        it is of what the search's model expects, not of what was seen
//   front_holds           with fresh seeds none of its designs is beaten by another
//   front_shrinks         with fresh seeds some are, or miss a limit: which
//   compromise_dominated  the chosen design is one of them
//   reference_inside      designs that the reference cuts off
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "studies/report/report_findings.h"

namespace glint::report_detail {

/// @param data  with `front` as studies/report/report.h describes it
std::vector<Finding> findings_on_front(const nlohmann::ordered_json& data);

}  // namespace glint::report_detail

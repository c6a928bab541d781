// SPDX-License-Identifier: GPL-3.0-or-later
//
// Variables of a design that lie on their limits. Private to the module.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "studies/report/report_findings.h"

namespace glint::report_detail {

/// `on_limits`, where there are any; the design is larger or smaller than allowed where all of them
/// are sizes of lights at the same end.
std::vector<Finding> findings_on_limits(const nlohmann::ordered_json& data,
                                        const nlohmann::ordered_json& design);

}  // namespace glint::report_detail

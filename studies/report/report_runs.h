// SPDX-License-Identifier: GPL-3.0-or-later
//
// The verdict on a comparison of runs. Private to the module.
#pragma once

#include <nlohmann/json.hpp>

#include "studies/report/verdict_parts.h"

namespace glint::report_detail {

/// What is said about several runs. Only runs of one `group` are ranked: those that have the same
/// part, camera, defects and objective.
/// @param data  with `runs` as studies/report/report.h describes them
Verdict verdict_of_runs(const nlohmann::ordered_json& data);

}  // namespace glint::report_detail

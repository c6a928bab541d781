// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which runs of a comparison may be ranked, and what is not the same in them.
#pragma once

#include <string>
#include <vector>

#include "studies/definition/study.h"

namespace glint {

/// Whether two studies have the same part, material, camera, sensor, scan, defects, scored region,
/// inspection and objective, so that their scores are of one scale; of costs, coverage, likeness to
/// photographs and reach also the table that these are measured by. Exposure and gain, which suit a
/// lighting, and what one of them varies may differ. Files count by their content, wherever they
/// lie.
bool is_comparable(const Study& a, const Study& b);

/// What of two studies differs apart from lighting, variables and search, by tables:
/// "part (file, unit)", "camera (working_distance_mm)", "objective".
std::vector<std::string> differences(const Study& a, const Study& b);

}  // namespace glint

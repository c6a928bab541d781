// SPDX-License-Identifier: GPL-3.0-or-later
//
// Classes of parts from their biggest defect and the sum of all, as figures 24 and 25 of the first
// seed have them.
#pragma once

#include <span>
#include <string_view>

#include "metrics/inspection/inspector.h"

namespace glint {

enum class Grade { kPerfect, kAcceptable, kRejected };

std::string_view grade_name(Grade grade);  ///< "Perfect", "Acceptable", "Rejected"

/// The two quality figures of one class of defects on a part, in the unit of the settings' measure.
struct DefectSizes {
  double biggest = 0.0;
  double sum = 0.0;
};

DefectSizes sizes_of(std::span<const FoundDefect> defects,
                     DefectKind kind,
                     InspectionSettings::Measure measure);

/// The grade by one class of defects: both figures must be within the limits.
Grade grade_by(const DefectSizes& sizes, const GradeLimits& limits);

/// The worse of holes and scratches.
Grade grade_of(std::span<const FoundDefect> defects, const InspectionSettings& settings);

}  // namespace glint

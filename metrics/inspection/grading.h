// SPDX-License-Identifier: GPL-3.0-or-later
//
// Classes of parts from their biggest defect and the sum of all, as figures 24 and 25 of the first
// seed have them, and thresholds learned from labelled parts.
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

/// A part somebody has judged.
struct LabelledPart {
  DefectSizes holes;
  DefectSizes scratches;
  Grade grade = Grade::kPerfect;
};

/// Limits that give the most parts their grade; among equals those in the middle of the widest gap
/// between the parts inside and the worse ones outside. Figures that no part needs to be kept
/// outside by get limits half way to the largest value of the worse parts.
struct LearnedLimits {
  GradeLimits holes;
  GradeLimits scratches;
  int wrong = 0;          ///< of the parts learned from
  bool is_proven = true;  ///< no limits have fewer wrong; false: the search was cut short
};

/// @param parts  at least one @throws ConfigError for none, or for sizes that are no number >= 0
LearnedLimits learn_limits(std::span<const LabelledPart> parts);

}  // namespace glint

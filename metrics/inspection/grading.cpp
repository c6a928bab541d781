// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/inspection/grading.h"

#include <algorithm>

namespace glint {

std::string_view grade_name(Grade grade) {
  switch (grade) {
    case Grade::kPerfect:
      return "Perfect";
    case Grade::kAcceptable:
      return "Acceptable";
    case Grade::kRejected:
      return "Rejected";
  }
  return "";
}

DefectSizes sizes_of(std::span<const FoundDefect> defects,
                     DefectKind kind,
                     InspectionSettings::Measure measure) {
  DefectSizes sizes;
  for (const FoundDefect& defect : defects) {
    if (defect.kind == kind) {
      const double size = measure == InspectionSettings::Measure::kArea
                              ? static_cast<double>(defect.area_px)
                              : defect.weight;
      sizes.biggest = std::max(sizes.biggest, size);
      sizes.sum += size;
    }
  }
  return sizes;
}

Grade grade_by(const DefectSizes& sizes, const GradeLimits& limits) {
  if (sizes.biggest <= limits.perfect_biggest && sizes.sum <= limits.perfect_sum) {
    return Grade::kPerfect;
  }
  return sizes.biggest <= limits.acceptable_biggest && sizes.sum <= limits.acceptable_sum
             ? Grade::kAcceptable
             : Grade::kRejected;
}

Grade grade_of(std::span<const FoundDefect> defects, const InspectionSettings& settings) {
  const auto grade_for = [&](DefectKind kind, const GradeLimits& limits) {
    return grade_by(sizes_of(defects, kind, settings.measure), limits);
  };
  return std::max(grade_for(DefectKind::kHole, settings.holes),
                  grade_for(DefectKind::kScratch, settings.scratches));
}

}  // namespace glint

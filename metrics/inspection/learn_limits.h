// SPDX-License-Identifier: GPL-3.0-or-later
//
// The limits of the classes, learned from labelled parts: docs/theory/inspection_masks.md.
#pragma once

#include <span>

#include "metrics/inspection/grading.h"
#include "metrics/inspection/inspection_settings.h"

namespace glint {

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

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "optimizer/problem/exact_scores.h"
#include "studies/definition/study.h"

namespace glint {

/// The scores of a study's objectives and limits that follow from a design's settings alone: size,
/// LEDs, scan time and cost of its lights. Told without a picture, bit for bit as an evaluation
/// gives them. @param study  must outlive what is returned
ExactScores exact_lighting(const Study& study);

}  // namespace glint

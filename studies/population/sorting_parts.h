// SPDX-License-Identifier: GPL-3.0-or-later
//
// One part on its way through sorting: its defects, the expert's grade, what the line finds, the
// grade by learned limits.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "defects/definition/defect.h"
#include "defects/definition/defect_settings.h"
#include "metrics/inspection/grading.h"
#include "metrics/inspection/learn_limits.h"
#include "metrics/scores.h"
#include "studies/definition/population_settings.h"
#include "studies/inspection_line/simulated_line.h"

namespace glint {

/// What an expert sees of a part.
struct ExpertView {
  double widest_hole_mm = 0.0;      ///< 0: none
  int holes = 0;                    ///< dents, pits and bumps that count
  double longest_scratch_mm = 0.0;  ///< scratches and gouges; 0: none

  bool operator==(const ExpertView&) const = default;
};

ExpertView expert_view(std::span<const Defect> defects, const ExpertRule& rule);

Grade expert_grade(const ExpertView& view, const ExpertRule& rule);

/// Whether a size of the part lies within that share of one of the rule's limits of size: there the
/// grade hangs on a hair.
bool is_near_border(const ExpertView& view, const ExpertRule& rule, double share);

/// One part that passed the line.
struct SortedPart {
  int number = 0;
  ExpertView truth;
  Grade expert = Grade::kPerfect;
  DefectSizes holes;  ///< as the inspector found them
  DefectSizes scratches;
  int defects = 0;       ///< that the part has
  int found = 0;         ///< of these
  int other_kind = 0;    ///< found ones that were taken for the other kind
  int false_alarms = 0;  ///< blobs near no defect
  bool is_imprinted = false;

  /// Limits are learned from parts with even numbers and tested on the others.
  bool is_for_learning() const { return number % 2 == 0; }
};

/// The worse of both kinds of defects.
Grade grade_of(const SortedPart& part, const LearnedLimits& limits);

LearnedLimits limits_from(std::span<const SortedPart> parts);  ///< of those for learning

/// The groups of a part: those of its source, imprinted where the settings say so.
/// @param seed  of the scene's [imprint]
std::vector<NamedGroup> groups_of_part(const SortingSettings& settings,
                                       const std::vector<NamedGroup>& defects,
                                       int seed,
                                       std::int64_t number);

/// Whether the settings have that part's defects imprinted: every so many-th, with even and odd
/// numbers in turn.
bool is_imprinted(const SortingSettings& settings, std::int64_t number);

/// One part through the line, as figures for the records and back.
Scores inspect_part(const SimulatedLine& line,
                    const SortingSettings& settings,
                    double threshold,
                    std::int64_t number);
SortedPart sorted_part(const Scores& figures, int number);

}  // namespace glint

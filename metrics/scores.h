// SPDX-License-Identifier: GPL-3.0-or-later
//
// The names under which scores appear in objectives, constraints, result files and reports.
#pragma once

#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "metrics/defect_scores.h"
#include "metrics/fringe.h"
#include "metrics/homogeneity.h"

namespace glint {

/// Name -> value, in alphabetical order. A score that could not be measured is absent.
using Scores = std::map<std::string, double>;

/// What a score means, for `glint explain` and the docs.
struct ScoreDoc {
  std::string_view name;  ///< "defects.<label>.cnr" stands for every label
  std::string_view doc;
};

/// All scores, in the order in which a report shows them.
std::span<const ScoreDoc> score_docs();

/// What a score of that name means; empty when there is none. Any label is taken for a defect's.
std::optional<std::string_view> explain_score(std::string_view name);

/// All names for a scene with these defects; none of "defects." when there is no defect.
std::vector<std::string> score_names(std::span<const std::string> labels);

/// What to tell a user who asked for a score that the scene does not have: names the nearest one.
/// Empty when the scene has it.
std::string unknown_score(std::string_view name, std::span<const std::string> labels);

void add_scores(Scores& scores, const Homogeneity& homogeneity);
void add_scores(Scores& scores, const FringeScores& fringes);

/// What a part's defects are, however they show.
struct DefectTotals {
  int made = 0;
  double mean_depth_um = 0.0;
  double removed_volume_mm3 = 0.0;
};

/// Nothing for a part without defects.
void add_scores(Scores& scores, const DefectTotals& totals);

/// Each defect's scores and, for at least one defect, the summary.
void add_scores(Scores& scores, std::span<const DefectScores> defects);

}  // namespace glint

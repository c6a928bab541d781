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

#include "metrics/aspect_image/defect_scores.h"
#include "metrics/aspect_image/fringe.h"
#include "metrics/aspect_image/homogeneity.h"
#include "metrics/aspect_image/homogeneity_family.h"

namespace glint {

/// Name -> value, in alphabetical order. A score that could not be measured is absent.
using Scores = std::map<std::string, double>;

/// What a score means, for `glint explain` and the docs.
struct ScoreDoc {
  std::string_view name;  ///< "defects.<label>.cnr" stands for every label, <group> for every group
  std::string_view doc;
};

/// All scores, in the order in which a report shows them.
std::span<const ScoreDoc> score_docs();

/// Scores have intervals: "homogeneity.h_rms.low" and ".high" are the bounds of one.
enum class ScoreInterval {
  kNone,   ///< it is no estimate
  kScans,  ///< of scans with other noise
  kTrials  ///< of the parts of an inspection line
};

/// Where the interval of a score comes from, a bound's own too. Unknown names: kNone.
ScoreInterval interval_of(std::string_view name);

/// Whether the name is a bound, as "homogeneity.h_rms.low" is.
bool is_bound(std::string_view name);

/// The name without ".low" or ".high"; others are unchanged.
std::string_view without_bound(std::string_view name);

/// Scores of path-traced pictures have standard errors: "homogeneity.h_rms.error".
std::string error_name(std::string_view score);

/// Whether the name is a standard error.
bool is_error(std::string_view name);

/// The name without ".error"; others are unchanged.
std::string_view without_error(std::string_view name);

/// What a score of that name, or a bound or standard error of it, means; empty when there is none.
/// Any label is taken for a defect's, and any group for one of the scene.
std::optional<std::string> explain_score(std::string_view name);

/// All names without bounds for a scene with these defects and groups of defects; none of
/// "defects." when there is no defect, none of the inspection of defects when there is no group.
std::vector<std::string> score_names(std::span<const std::string> labels,
                                     std::span<const std::string> groups = {});

/// What to tell a user who asked for a score that the scene does not have: names the nearest one,
/// or says that there is no interval. Empty when the scene has it.
std::string unknown_score(std::string_view name,
                          std::span<const std::string> labels,
                          std::span<const std::string> groups = {});

void add_scores(Scores& scores, const Homogeneity& homogeneity);
void add_scores(Scores& scores, const HomogeneityFamily& family);
void add_scores(Scores& scores, const FringeScores& fringes);

/// Whether the score, or the bound of one, is of the homogeneity family.
bool is_of_family(std::string_view name);

/// Whether the score, or the bound of one, needs the stripes: the ripple is sought at their own
/// spacing.
bool needs_fringes(std::string_view name);

/// Whether the score of defects, or the bound or error of one, compares frames with those of the
/// flawless part.
bool needs_flawless(std::string_view name);

/// Whether the score tells what the views of a scene inspect: it needs no picture of its own.
bool is_of_coverage(std::string_view name);

/// Whether the score compares with the real pictures of [reference].
bool is_of_reference(std::string_view name);

/// Whether the score tells which views the arm of a cell can take.
bool is_of_reach(std::string_view name);

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

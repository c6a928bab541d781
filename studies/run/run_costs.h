// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a run of a study will cost, measured on pieces of its work. CPU seconds, of all threads
// together: what the clock on the wall shows depends on who else uses the machine.
#pragma once

#include <functional>
#include <optional>

#include "studies/definition/ladder/branch_split.h"
#include "studies/definition/study.h"
#include "studies/evaluation/evaluation.h"

namespace glint {

/// CPU seconds of a run, by what they go into.
struct RunCosts {
  double search_s = 0.0;     ///< all evaluations of the budget, choosing how to render them
  double rescoring_s = 0.0;  ///< fresh noise, finer sampling, repeated scans of each written design
  double writing_s = 0.0;    ///< frames, pictures, drawings of every design
  double manufacture_s = 0.0;  ///< designs as they will be built, at most
  double populations_s = 0.0;  ///< parts that are sorted, or inspected for their defects' size

  double total_s() const {
    return search_s + rescoring_s + writing_s + manufacture_s + populations_s;
  }
};

/// What the evaluations of a search will take.
struct PredictedSearch {
  double cpu_s = 0.0;
  int evaluations = 0;
  bool is_timed = false;  ///< the clock on the wall ends it
};

/// The limit of a budget that is met first counts: its evaluations, or the clock on the wall. Each
/// candidate has one thread: where there are more, more evaluations fit into the same time.
/// @param evaluation_s  CPU seconds of one
/// @param at_once       of them, >= 1
/// @return empty where only a stall or a target ends the search, which nothing tells beforehand
std::optional<PredictedSearch> predicted_search(const Budget& budget,
                                                double evaluation_s,
                                                int at_once);

/// The first evaluations of a study's search.
struct SearchSample {
  double evaluation_s = 0.0;  ///< CPU seconds, mean over the evaluations of the budget
  std::optional<Point> best;  ///< of those that were made; empty: all failed
};

inline constexpr int kSampledDesigns = 48;

/// Begins the search as a run does, in a scratch folder, and ends it after kSampledDesigns
/// evaluations, or earlier where they take long.
/// @param jobs  candidates at once, >= 1
/// @param step  called after each evaluation
/// @param rungs  how they are rendered; empty: as the study says
/// @throws IoError when no scratch folder can be made
SearchSample sample_search(const Study& study,
                           SceneStore& store,
                           int jobs,
                           const std::function<void()>& step,
                           const std::optional<SearchRungs>& rungs = {});

/// A design rendered as write_design() does, with its frames encoded and nothing written.
struct RenderedDesign {
  Evaluation evaluation;
  double cpu_s = 0.0;
};

RenderedDesign render_design(SceneStore& store,
                             const SceneSettings& scene,
                             const WantedScores& wanted);

/// CPU seconds of scoring a design again as a run does: once with finer sampling, estimated from
/// rendering_s where that takes long, and, of studies with an objective, in repeated scans, of
/// which the first are made.
double measure_rescoring_s(SceneStore& store,
                           const Study& study,
                           const SceneSettings& scene,
                           double rendering_s);

/// CPU seconds of a race of finalists (search_race.h), of whose replicates one is made.
/// @param best        a design that can be evaluated; empty: the study's own
/// @param replicates  likely_replicates(); 0: nothing is made
double measure_race_s(SceneStore& store,
                      const Study& study,
                      const std::optional<Point>& best,
                      int replicates);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a run of a study will cost, measured on pieces of its work. CPU seconds, of all threads
// together: what the clock on the wall shows depends on who else uses the machine.
#pragma once

#include <functional>
#include <string>

#include "studies/definition/study.h"
#include "studies/evaluation/evaluation.h"

namespace glint {

/// CPU seconds of a run, by what they go into.
struct RunCosts {
  double search_s = 0.0;     ///< all evaluations of the budget
  double rescoring_s = 0.0;  ///< fresh noise, finer sampling, repeated scans of each written design
  double writing_s = 0.0;    ///< frames, pictures, drawings of every design
  double populations_s = 0.0;  ///< parts that are sorted, or inspected for their defects' size

  double total_s() const { return search_s + rescoring_s + writing_s + populations_s; }
};

/// What a search wants of each candidate.
WantedScores wanted_in_search(const Study& study);

/// CPU seconds of one evaluation: the mean over designs spread over the search space.
/// @param step  called before each of at most kSampledDesigns evaluations
double measure_evaluation_s(const Study& study,
                            SceneStore& store,
                            const std::function<void()>& step);

inline constexpr int kSampledDesigns = 8;

/// A design rendered as write_design() does, with its frames encoded and nothing written.
struct RenderedDesign {
  Evaluation evaluation;
  double cpu_s = 0.0;
};

RenderedDesign render_design(SceneStore& store,
                             const SceneSettings& scene,
                             const WantedScores& wanted);

/// CPU seconds of re-scoring a scene; where that takes long, estimated from how long rendering
/// took.
double measure_rescoring_s(SceneStore& store,
                           const SceneSettings& scene,
                           const WantedScores& wanted,
                           double rendering_s);

/// CPU seconds of one scan of repeated_scores().
double measure_scan_s(SceneStore& store, const SceneSettings& scene, const WantedScores& wanted);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "metrics/scores.h"
#include "optimizer/problem/goal.h"
#include "optimizer/problem/space.h"
#include "simulator/render/scan/closed_scan.h"
#include "studies/evaluation/scene_gradient.h"
#include "studies/imaging/scene_picture.h"
#include "studies/imaging/scene_store.h"
#include "studies/imaging/traced_scene.h"

namespace glint {

/// One scene, scanned and scored.
struct Evaluation {
  Scores scores;
  ImageF aspect;  ///< mean of the frames; closed forms: right in the region and around the defects
  ScanForm form;  ///< how it came about; frames for the plain way
  std::shared_ptr<const TracedScene> traced;
  std::vector<DefectScores> defects;
  Gradients gradients;                ///< of the scores that were asked for
  std::vector<Scores> without_batch;  ///< the picture's scores without each batch of its samples
};

/// Which scores are wanted, beside homogeneity.
struct WantedScores {
  bool fringes = true;             ///< of the first frame; needs all of it
  bool defects = true;             ///< need the frames around the defects
  bool changes = true;             ///< of the defects, against the flawless part in each frame
  bool robust = true;              ///< homogeneity.robust: percentiles
  bool slot = true;                ///< view.slot_margin_mm: a sight line for each pixel
  bool family = false;             ///< homogeneity.residual and its like: passes of their own
  WantedGradients gradients = {};  ///< need closed forms
  bool coverage = false;           ///< what the views of the scene inspect: a ray for each place
  bool reference = false;          ///< against real pictures: a picture for each of them
  bool inner_edges = false;        ///< against these the edges inside the part, too
  bool reach = false;              ///< which views an arm can take: a plan
  bool lighting = false;           ///< size, scan time and cost: no picture; with [cost] always
  bool picture = true;             ///< any other score
  bool errors = true;              ///< "<score>.error" of path-traced scenes: the metrics once more
                                   ///< for each batch

  /// Scores that need more than this one scan: those of an inspection line ("inspection.") and
  /// bounds of intervals (".low", ".high"), which need scans with other noise.
  std::vector<std::string> trials = {};
  std::int64_t first_part = 0;  ///< of the line; others are other parts with other noise

  /// These trials alone, with everything that one scan gives.
  WantedScores with_whole_scan(std::int64_t first = 0) const {
    return {.family = true,
            .coverage = coverage,
            .reference = reference,
            .inner_edges = reference,
            .reach = reach,
            .lighting = lighting,
            .trials = trials,
            .first_part = first};
  }

  /// All but the trials.
  WantedScores of_one_scan() const;
};

/// What a search needs for its objective and constraints.
WantedScores wanted_by(const Goal& goal);

/// The same without scores beside them that cost renderings of their own.
WantedScores needed_by(const Goal& goal);

/// The same with their derivatives by each variable.
WantedScores wanted_with_gradients(const Goal& goal, const SearchSpace& space);

/// Scores a picture: everything but trials. Of a picture with batches each score that its noise
/// moves has a standard error (docs/theory/path_tracing.md, "Standard errors of scores").
/// @param picture  asked for with what is wanted
/// @param consume  sees each frame's grey values in order; may be empty
Evaluation evaluate(const ScenePicture& picture,
                    ThreadPool& pool,
                    const FrameConsumer& consume = {},
                    const WantedScores& wanted = {});

/// The same for the picture of a scene, with trials. Single-threaded but for tracing rays. How
/// pictures come about is decided by scene.render.method; `auto` takes closed forms when no whole
/// frame is wanted.
/// @throws ConfigError beginning with the key at fault, IoError
Evaluation evaluate(SceneStore& store,
                    const SceneSettings& scene,
                    const FrameConsumer& consume = {},
                    const WantedScores& wanted = {});

/// The line's first part for re-scoring a finalist: parts and noise that no search has seen.
inline constexpr std::int64_t kFreshParts = 1000003;

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// A study's scores of a real picture, by the same code and in the same pixels as those of the
// simulated one.
#pragma once

#include "core/image/image.h"
#include "metrics/scores.h"
#include "studies/definition/scene.h"
#include "studies/evaluation/evaluation.h"
#include "studies/imaging/scene_store.h"

namespace glint {

struct BothScores {
  Scores simulated;
  Scores real;
};

/// Scores of both sides of one view. The real picture's mean stands for its frames; what it would
/// show without a defect is the simulated flawless picture times the real over the simulated grey
/// around the defect.
/// @param scene   with one viewpoint: where the picture was taken
/// @param real    linear, of the camera's size
/// @param wanted  without trials, coverage and reference, which a picture does not give
/// @throws ConfigError beginning with the key at fault, IoError
BothScores scores_of_both(SceneStore& store,
                          const SceneSettings& scene,
                          const ImageF& real,
                          WantedScores wanted);

}  // namespace glint

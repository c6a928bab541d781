// SPDX-License-Identifier: GPL-3.0-or-later
//
// A study's scores of a real picture, by the same code and in the same pixels as those of the
// simulated one; and by which factor it is brighter.
#pragma once

#include "core/image/image.h"
#include "metrics/scores.h"
#include "studies/definition/scene.h"
#include "studies/evaluation/evaluation.h"
#include "studies/imaging/scene_store.h"
#include "studies/validate/grey_fit.h"

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

/// What fit_grey() is to designs whose light is not path traced (mirrors under a tunnel): one
/// exposure, real over simulated grey in the pixels of the region of interest where neither side is
/// clipped, at most three views. Not known where there are too few of these or no light.
/// @throws ConfigError beginning with the key at fault, IoError
GreyFit fit_exposure(SceneStore& store, const GreyDesign& design);

}  // namespace glint

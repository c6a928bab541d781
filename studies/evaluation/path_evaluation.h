// SPDX-License-Identifier: GPL-3.0-or-later
//
// Scores of scenes that are path-traced: the same frames, sensor and metrics as under a tunnel
// alone, and a standard error for each score that the pictures' noise moves.
// docs/theory/path_tracing.md, "Standard errors of scores"
#pragma once

#include "studies/evaluation/evaluation.h"

namespace glint {

/// evaluate() for a scene with needs_paths(). One frame under area lights alone, as many as
/// scan.positions under a tunnel.
/// @throws ConfigError beginning with the key at fault, IoError
Evaluation evaluate_paths(SceneStore& store,
                          const SceneSettings& scene,
                          const FrameConsumer& consume,
                          const WantedScores& wanted);

/// Standard error of a figure from its values without one batch each (delete-one jackknife):
/// sqrt((B - 1) / B sum of (value - mean)^2).
/// Source: B. Efron, C. Stein, "The jackknife estimate of variance", Annals of Statistics 9(3),
/// 1981.
/// @param without_one  two or more values
double jackknife_error(std::span<const double> without_one);

}  // namespace glint

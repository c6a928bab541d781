// SPDX-License-Identifier: GPL-3.0-or-later
//
// Random squares of a picture by path tracing, rendered without the rest of it: what a second look
// at a design takes where a score follows from its pixels one by one (docs/accuracy.md, "Random
// pixels").
#pragma once

#include <optional>
#include <vector>

#include "core/rng.h"
#include "studies/definition/scene.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// The mean grey value of a pixel over the frames, as two ways to render a scene give it.
struct GreyPair {
  double cheap = 0.0;
  double dearer = 0.0;
};

/// Pixels of the region of interest in a square of 8 x 8 pixels: 1 to 64 of them.
using SampledSquare = std::vector<GreyPair>;

/// So many squares are drawn of a picture that has at least twice as many.
inline constexpr int kSampledSquares = 32;

/// The share of a picture's pixels that is rendered for kSampledSquares squares, at most; above 1
/// for a small picture. A square needs what the sensor's blur spreads into it: up to a radius of 4
/// pixels four times its own pixels.
double share_of_squares(const SceneSettings& scene);

/// Pixels of random squares as their whole pictures have them, bit for bit. Squares with pixels of
/// the region of interest are drawn without replacement, all with the same chance; together they
/// are the region.
/// @param cheap, dearer  the same scene, with the same random numbers; they differ in the settings
///                       of [render.paths]
/// @return nothing where a square cannot be rendered without the rest, as the exposure or the
///         number of samples follows from the whole picture; where no paths are followed; and where
///         the region has less than twice as many squares
/// @throws ConfigError beginning with the key at fault, IoError
std::optional<std::vector<SampledSquare>> sampled_squares(SceneStore& store,
                                                          const SceneSettings& cheap,
                                                          const SceneSettings& dearer,
                                                          Rng rng);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// How far the simulation agrees with real pictures, as scores: what a search fits roughness,
// exposure, light power, pose and blur by. docs/fitting.md
#pragma once

#include "metrics/scores.h"
#include "studies/definition/scene.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// Whether "overlap.edge_distance_px" is measured: edges are fitted along every line inside the
/// part, which few studies ask for.
enum class InnerEdgeScore { kLeftOut, kMeasured };

/// "overlap." and "appearance." of metrics/scores.h: means over the pictures of [reference], of
/// which the first belongs to the first viewpoint, and so on. The simulated side is the mean of the
/// frames, after the sensor. The part is where the masks of [reference] and the simulation say;
/// without masks both sides are segmented alike, by Otsu's threshold. Pictures that are a whole
/// number of times as large as the camera's are reduced to its size by means. A mask is the part
/// above three quarters of full scale, and nothing is compared where it is grey, a quarter to three
/// quarters; "appearance.ssim" and outlines are compared 5 px away from there and farther. A pixel
/// of a reduced mask is the part's where most of it is, and grey where any of it is. With
/// `render.paths.debias` what the noise of the paths adds to "appearance.rms" is taken off.
/// @throws ConfigError beginning with the key at fault: no pictures, more pictures than viewpoints,
///         another size than the camera's, no part in a picture; IoError
Scores reference_scores(SceneStore& store,
                        const SceneSettings& scene,
                        InnerEdgeScore inner = InnerEdgeScore::kMeasured);

}  // namespace glint

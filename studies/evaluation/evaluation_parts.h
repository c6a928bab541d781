// SPDX-License-Identifier: GPL-3.0-or-later
//
// What scores of a picture are made of.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "defects/part/defective_part.h"
#include "metrics/scores.h"
#include "simulator/sensor/sensor.h"
#include "studies/definition/scene.h"

namespace glint {

/// Grey levels per full scale decide what can be told apart when the sensor adds no noise.
double sigma_floor(const SensorSettings& sensor);

DefectTotals totals_of(const DefectivePart& part);

/// Change of a pixel in one frame that is neither noise nor rounding: five standard deviations at
/// full scale, where shot noise is largest.
double change_threshold(const SceneSettings& scene);

/// Scores of all defects, in the aspect image and in the frame that shows each best.
std::vector<DefectScores> scored_defects(const ImageF& aspect,
                                         std::span<const DefectPixels> defects,
                                         const BestFrames& best,
                                         const SceneSettings& scene);

/// What parts fine from coarse in this scene.
FamilyScales scales_of(const SceneSettings& scene,
                       std::span<const DefectPixels> defects,
                       const std::optional<FringeScores>& fringes);

}  // namespace glint

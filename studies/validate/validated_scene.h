// SPDX-License-Identifier: GPL-3.0-or-later
//
// The scene of a design as its real pictures were taken: with the calibrated camera, from the poses
// that the robot told.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "studies/definition/scene.h"
#include "studies/imaging/scene_store.h"
#include "studies/validate/geometry_fit.h"
#include "studies/validate/real_pictures.h"

namespace glint {

/// Takes camera and hand-eye of a calibration.toml; all else stays. The picture's size must be the
/// same. @throws ConfigError, IoError
void take_calibration(const std::filesystem::path& file, SceneSettings& scene);

/// The scene of a design at the exposure that `glint acquire` gives its pictures: the one that
/// sensor.expose_to means, which is found by rendering. Where it cannot be had, because no light
/// reaches the part, the scene at its sensor.exposure, with a note.
/// @param name  of the design
SceneSettings exposed_as_acquired(SceneStore& store,
                                  const SceneSettings& scene,
                                  const std::string& name,
                                  std::vector<std::string>& notes);

/// The viewpoints of the pictures: by the robot's poses where they are told and scene has
/// [calibration] and [cell], else those of the scene whose names ("view_03", "03", "3") are the
/// pictures'. One picture of a scene with one viewpoint may have any name.
/// @param viewpoints  all of the scene
/// @throws ConfigError for a picture that is of no viewpoint
std::vector<Viewpoint> viewpoints_of_pictures(const RealDesign& design,
                                              const SceneSettings& scene,
                                              const std::vector<Viewpoint>& viewpoints);

/// The camera's lens with the changes that a fit has found.
void put_lens_change(const GeometryFit& fit, SceneSettings& scene);

/// What calibration and placement say of their errors. Each number that is not told, or is 0, is
/// taken as kUnknownRotation, kUnknownPosition and kUnknownFocal, with a note.
GeometryBudget budget_of(const SceneSettings& scene, std::vector<std::string>& notes);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The scene of a simulated picture with what explains the real one put in.
#pragma once

#include <optional>
#include <span>
#include <string>

#include "studies/compare/causes.h"
#include "studies/compare/compare_sources.h"
#include "studies/definition/scene.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// What a picture was rendered from, exposed as that picture is: sensor.expose_to holds for
/// designs, views of `glint render` (image.tif, image.png) are exposed as sensor.exposure says.
/// @throws ConfigError, IoError
SceneSettings read_exposed_scene(const CompareSource& source);

/// The scene with the causes put in: camera, viewpoint (which moves against the part as the part
/// does against it), gain and roughness.
SceneSettings refined_scene(const SceneSettings& scene, const PairCauses& causes);

/// The same as a TOML file. Where the gain takes sensor.expose_to beyond full scale the exposure
/// that it stands for is found by rendering, and written in its place.
/// @param source  a rendered view @throws ConfigError, IoError
std::string refined_toml(const CompareSource& source, const PairCauses& causes, SceneStore& store);

/// A view of several that are refined together.
struct RefinedView {
  SceneSettings scene;  ///< read_exposed_scene(), of one viewpoint
  PairCauses causes;    ///< without a calibration
};

/// One scene of all views: each from its own viewpoint as its picture has it, with the lens that
/// fits all of them together (fit_joint_lens(), of what some view says that its lens does), and the
/// median of their gains; where views tell a change of roughness, its median and that of the gains
/// beside which it was fitted, of these views alone.
/// @return nothing for fewer than two viewpoints, for views of scenes that differ in more than
///         their viewpoint, of which one has doubtful edges, or that allow one viewpoint only
std::optional<SceneSettings> jointly_refined(std::span<const RefinedView> views);

}  // namespace glint

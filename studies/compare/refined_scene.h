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
/// does against it), gain and roughness. The gain is one of light: it goes into sensor.expose_to
/// where that is set, else into sensor.gain, or sensor.exposure where there is a dark signal, which
/// it leaves alone.
SceneSettings refined_scene(const SceneSettings& scene, const PairCauses& causes);

/// read_exposed_scene(); where causes leave no level that sensor.expose_to could say, with the
/// exposure that it stands for, which is found by rendering: a gain beyond full scale, or other
/// metal, whose gain is one beside the exposure of the simulated picture.
/// @param source  a rendered view @throws ConfigError, IoError
SceneSettings refinable_scene(const CompareSource& source,
                              const PairCauses& causes,
                              SceneStore& store);

/// The refined_scene() of a refinable_scene() as a TOML file.
/// @param source  a rendered view @throws ConfigError, IoError
std::string refined_toml(const CompareSource& source, const PairCauses& causes, SceneStore& store);

/// A view of several that are refined together.
struct RefinedView {
  SceneSettings scene;  ///< refinable_scene(), of one viewpoint
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

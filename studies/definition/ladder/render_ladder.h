// SPDX-License-Identifier: GPL-3.0-or-later
//
// The settings that a scene may be rendered with, from cheap to dear, when the program chooses them
// (docs/accuracy.md). What a rung costs is counted from the settings, with constants of the source:
// a decision that is made by it is the same on every machine.
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "studies/definition/accuracy_table.h"
#include "studies/definition/ladder/counted_work.h"
#include "studies/definition/scene.h"
#include "studies/definition/study.h"

namespace glint {

/// One way to render a scene.
struct RenderRung {
  std::string name;       ///< unique in its ladder: "direct light, 16 samples"
  std::string level;      ///< "level 0", "blurred", "direct sum", "half resolution", ...
  RenderSettings render;  ///< of scenes that do not need path tracing
  PathSettings paths;     ///< of those that do, and of those that a rung without noise cannot
  double work = 0.0;      ///< counted_work() of the scene at this rung
  int group = 0;          ///< rungs of a group differ in their number of samples or rays alone
  bool has_derivatives = false;
  bool is_for_search = true;  ///< false: beyond what is kept; others are compared with it
  bool is_noisy = false;      ///< paths: errors fall as the root of the number of samples
  bool is_summed = false;     ///< rough metal without noise, by render.rays_per_axis alone
  int pixel_factor = 1;       ///< of paths: 2 has half as many pixels along both sides
  /// Of scores at half resolution: how far they are above the top's, the mean over the designs of a
  /// trial. less_offsets() takes it out; empty before the trial.
  std::map<std::string, double> offsets;
};

/// The ladder of a scene by rising work. Its last rung is the top, which the others are compared
/// with: what finalists are re-scored with (rescoring_settings()), with the scene's own seeds.
///
///   a mirror under a tunnel   footprints with directions to 2, 0.6, 0.2, 0.06 mrad; plain sampling
///                             where render.method asks for it: 1, 2, 4 rays along both axes
///   path tracing              1, 2, 4, 8 reflections, each with 8, 16, 32 ... samples; all
///                             reflections in half as many pixels a side, with 8, 32, ... samples
///   rough metal in the range  the same, and blurred reflections of 1, 2, 4 rays along both axes,
///   of blurred_problems()     where they are cheaper than the top and render.method is not kept;
///                             these alone where it asks for them
///   rough metal under a lamp  likewise, with the sum of direct light
///   without direct_problems()
///
/// render.paths.samples is an upper limit and shortens the ladder where it is kept, as
/// max_reflections does always; where that is kept, all paths have so many. All others stay as they
/// are.
std::vector<RenderRung> render_ladder(const SceneSettings& scene, const KeptKeys& kept);

/// Of the kind that the designs of a study need: of path tracing where one of them does.
/// @param designs  at least one
std::vector<RenderRung> render_ladder(std::span<const SceneSettings> designs, const KeptKeys& kept);

/// @throws ConfigError when what the study keeps leaves its search one rung: there is nothing to
///         choose
void check_ladder(const Study& study, const std::vector<RenderRung>& ladder);

/// The scene rendered so. Scenes of both levels take what is theirs, and those that a rung of
/// blurred reflections or of a direct sum does not model follow paths, as many as the ladder's
/// scene has.
SceneSettings at_rung(SceneSettings scene, const RenderRung& rung);

/// Scores of a design that was rendered at the rung, without the rung's mean errors (a control
/// variate of coefficient 1). Those of a scene that the rung renders in all its pixels stay.
/// @param scene  of the design, not yet at the rung
void less_offsets(const SceneSettings& scene,
                  const RenderRung& rung,
                  std::map<std::string, double>& scores);

/// Whether all rungs render the scene in the same way, as those of paths do with a mirror.
bool is_rendered_alike(const SceneSettings& scene, std::span<const RenderRung> ladder);

/// How fine a rung is beside others of its group: samples or rays a pixel, or the inverse square of
/// the direction error in rad.
double fineness_of(const RenderRung& rung);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Why a simulated picture differs from a real one: from its scene and the geometry that was
// rendered with it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "simulator/camera/pinhole_camera.h"
#include "studies/compare/compared_pair.h"
#include "studies/compare/fit/cause_fit.h"
#include "studies/definition/scene.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// A cause as the result tells it.
struct ToldCause {
  std::string name;
  double value = 0.0;
  std::string unit;
  double sigma = 0.0;
  double share = 0.0;                   ///< of the misfit that it is about, in [0, 1]
  std::string of;                       ///< that misfit: "edges" or "grey"
  std::vector<std::string> group = {};  ///< all that cannot be told apart, itself among them
};

struct PairCauses {
  std::vector<ToldCause> told;
  std::optional<CauseFit> edges;                         ///< empty: no geometry, or too few edges
  Eigen::Vector3d middle_mm = Eigen::Vector3d::UnitZ();  ///< turns are about it; camera frame
  double gain = 1.0;                                     ///< of light; 1: none beyond noise
  double roughness_change = 0.0;                         ///< of material.roughness
  double roughness_bound = 0.0;                          ///< of its sigma: RoughnessFit::bound
  bool is_roughness_open = false;                        ///< neither it nor the gain is told
  std::optional<PinholeIntrinsics> calibrated = {};      ///< the real camera, where it is known
  std::vector<std::string> notes = {};                   ///< why none is told
  bool is_pose_doubtful = false;                         ///< edges do not tell where the part lies
  std::vector<SpaceEdge> space_edges = {};               ///< matched; empty where they are doubtful
};

/// Edges of the pair with their places in space, matched where the causes take them, and how far
/// the next edge of the simulated surface is, up to 20 px.
/// @param scene  of the simulated picture @throws ConfigError, IoError
std::vector<SpaceEdge> space_edges(const ComparedPair& pair, const SceneSettings& scene);

/// What is known of the real camera.
struct KnownCamera {
  bool is_lens_known = false;  ///< the scene has its lens: only pose and gain may differ
  /// Its calibration: edges of the real picture are led through it into the scene's camera, and
  /// what is left is a matter of pose and gain.
  std::optional<PinholeIntrinsics> calibrated = {};
};

/// @throws ConfigError, IoError for files of the simulated view that cannot be read; ConfigError
/// where the calibration is of pictures of another size
PairCauses find_causes(const ComparedPair& pair, const KnownCamera& known = {});

/// Adds the roughness of the metal, and the gain beside it, where grey values tell it: renders the
/// scene up to three times with the causes put in. Leaves all as it is where there is no such
/// scene, and but for a note where the part's pose is doubtful, the picture seems to be turned, or
/// both pictures hardly correlate. Where the change is too large for three renderings to say how
/// large it is, a note takes the place of roughness and gain.
/// @throws ConfigError, IoError
void add_roughness(const ComparedPair& pair, SceneStore& store, PairCauses& causes);

/// Notes that roughness was not looked for, where a gain was told of metal that could be rougher or
/// smoother instead.
/// @throws ConfigError, IoError
void note_unsought_roughness(const ComparedPair& pair, PairCauses& causes);

}  // namespace glint

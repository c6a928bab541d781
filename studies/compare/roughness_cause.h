// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much rougher or smoother the real metal is than the simulated one, from grey values of the
// part rendered again. Private to the room. Method: docs/theory/comparison.md.
#pragma once

#include <optional>

#include "studies/compare/compared_pair.h"
#include "studies/definition/scene.h"
#include "studies/imaging/scene_store.h"

namespace glint::compare_detail {

/// real = gain (simulated at the changed roughness).
struct RoughnessFit {
  double change = 0.0;       ///< of material.roughness
  double sigma = 0.0;        ///< of the change, by noise and by what three renderings leave open
  double noise_sigma = 0.0;  ///< by the scatter of blocks of pixels alone
  /// Cramer-Rao bound of noise_sigma, were the photograph's noise all that is not known, and
  /// independent and alike in all reduced pixels.
  double bound = 0.0;
  double gain = 1.0;
  double gain_sigma = 0.0;  ///< as sigma
  double share = 0.0;       ///< of the misfit of grey values, in [0, 1]
  double gain_share = 0.0;  ///< the same, of the gain
  int renders = 0;          ///< at most 3, of at most 612 x 512 pixels
  /// Whether these tell the change: all fits have it within a factor of 1.7 of the scene's
  /// roughness, and the gain does not move far between them.
  bool is_within_reach = true;
};

/// Whether a scene's grey values may tell its roughness: path-traced metal with material.roughness,
/// seen by a grey sensor.
bool tells_roughness(const SceneSettings& scene);

/// @param scene  of the simulated picture, with pose and lens as the edges say
/// @returns nothing for scenes that are not path traced, of a colour sensor or whose metal has no
///          roughness (a mirror, `alpha` instead), and where fewer than 1000 reduced pixels show
///          the sound part or do not tell roughness from gain
/// @throws ConfigError, IoError as SceneStore::picture()
std::optional<RoughnessFit> fit_roughness(const ComparedPair& pair,
                                          const SceneSettings& scene,
                                          SceneStore& store);

}  // namespace glint::compare_detail

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What light makes of places on a part that a camera looks at: how bright they are, and whether
// mirrored rays meet the light at all. Answers for any scene, whichever transport it needs.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "studies/definition/scene.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// A place that a camera sees, no part of the part being in the way.
struct SeenPlace {
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, of the smooth surface, outwards
  Eigen::Vector2d pixel_px = Eigen::Vector2d::Zero();
};

/// Grey values are shares of full scale, without noise, before clipping; the dark
/// signal is in them.
struct PlaceLight {
  double mean = 0.0;     ///< over the frames
  double darkest = 0.0;  ///< of the frames: at full scale there is none that shows anything
  /// Mirrors under a tunnel: of the scan's positions, those at which the mirrored ray meets the
  /// luminous wall between its ends and the wall does not stand in the camera's way; after one
  /// reflection. 1 in all other scenes.
  double lit_share = 1.0;
  bool is_hidden = false;  ///< a light stands between camera and place
};

/// The light of the part without its defects. Of a mirror under a tunnel (level 0) by one ray for
/// each place; of all else, rough metal of blurred reflections too, from a picture of a quarter of
/// the resolution, blurred over 3 x 3 of its pixels of the same surface.
/// @param samples  paths for each pixel of that picture
/// @return as many as places
/// @throws ConfigError beginning with the key at fault, IoError
std::vector<PlaceLight> light_of_places(SceneStore& store,
                                        const SceneSettings& scene,
                                        const Viewpoint& viewpoint,
                                        std::span<const SeenPlace> places,
                                        int samples);

}  // namespace glint

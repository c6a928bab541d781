// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where on a part a defect can show at all: seen by the camera, and sending it light of the tunnel.
#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include "studies/imaging/scene_store.h"

namespace glint {

struct IlluminatedPlaces {
  /// x and y in the part's frame, as [defects.<name>] takes them, the best one first
  std::vector<Eigen::Vector2d> places_mm;
  double lit_share = 0.0;  ///< of the part's pixels that light reaches
};

/// Places around which, over `margin_mm` on every side, the part is seen, lit after one reflection,
/// and free of steps and creases; those nearest to the middle of the picture first, and two margins
/// apart. Where there are too few of them, places with steeper surroundings follow, and where there
/// are none at all those with a smaller margin, down to a few pixels. The scene's own defects are
/// left out.
///
/// @param margin_mm  > 0; as far as a defect's background reaches
/// @param wanted     >= 1; how many places at most
/// @return no place when none is left
/// @throws ConfigError, IoError as SceneStore::trace()
IlluminatedPlaces illuminated_places(SceneStore& store,
                                     const SceneSettings& scene,
                                     double margin_mm,
                                     std::size_t wanted = 1);

}  // namespace glint

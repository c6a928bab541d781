// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where on a part a defect can show at all: seen by the camera, and sending it light of the tunnel.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "studies/imaging/scene_store.h"

namespace glint {

struct IlluminatedPlace {
  Eigen::Vector2d place_mm;  ///< x and y in the part's frame, as [defects.<name>] takes them
  double lit_share = 0.0;    ///< of the part's pixels that light reaches
};

/// The place nearest to the middle of the picture around which, over `margin_mm` on every side, the
/// part is seen, lit after one reflection, and free of steps and creases. Where there is no such
/// place steeper surroundings will do, then a smaller margin, down to a few pixels. The scene's own
/// defects are left out.
///
/// @param margin_mm  > 0; as far as a defect's background reaches
/// @return empty when no place is left
/// @throws ConfigError, IoError as SceneStore::trace()
std::optional<IlluminatedPlace> illuminated_place(SceneStore& store,
                                                  const SceneSettings& scene,
                                                  double margin_mm);

}  // namespace glint

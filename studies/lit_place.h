// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where on a part a defect can show at all: seen by the camera, and sending it light of the tunnel.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "studies/traced_scene.h"

namespace glint {

/// The place nearest to the middle of the picture around which, over `margin_mm` on every side, the
/// part is seen, lit after one reflection, and free of steps and creases. Where there is no such
/// place the margin shrinks, down to a few pixels. The scene's own defects are left out.
///
/// @param margin_mm  > 0; two or three radii of the defect
/// @return x and y in the part's frame, as [defects.<name>] takes them; empty when no place is left
/// @throws ConfigError, IoError as SceneStore::trace()
std::optional<Eigen::Vector2d> lit_place(SceneStore& store,
                                         const SceneSettings& scene,
                                         double margin_mm);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a scene's part should be in the pictures of its views. Private to the room.
#pragma once

#include <span>
#include <vector>

#include "core/image/image.h"
#include "hardware/planning/view_plan.h"
#include "studies/cell/cell_file.h"
#include "studies/definition/scene.h"

namespace glint::acquire_detail {

struct ExpectedParts {
  /// Of each view a picture reduced to at most 160 pixels of width, true on the part; empty where
  /// it cannot be told.
  std::vector<Mask> masks;
  /// Of each view the sigma of the part's edges as the camera blurs them [px], those farthest out
  /// of focus; as many as masks.
  std::vector<double> blur_px;
  double tolerance_px = 0.0;  ///< of the camera's own pixels: three sigma of what places it there
};

/// Empty for scenes that do not lie in the cell, or have no place of the camera on the flange.
/// @throws ConfigError beginning with the key at fault, IoError
ExpectedParts expected_parts(const SceneSettings& scene,
                             const Cell& cell,
                             std::span<const PlannedView> views);

}  // namespace glint::acquire_detail

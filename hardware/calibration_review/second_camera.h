// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures of two cameras that were taken for those of one.
#pragma once

#include <cstddef>
#include <optional>

#include "hardware/calibration/bundle.h"

namespace glint {

struct SecondCamera {
  std::size_t first_view = 0;  ///< of the bundle's views, the first that the second camera took
  double explained = 0.0;      ///< share of the squared residuals that two cameras explain
  double focal_ratio = 1.0;    ///< the second one's focal length over the first one's
};

/// Looks for a place in the row of views where two cameras, one before and one after it, leave less
/// than half of the squared residuals that one camera of all leaves, by one step of least squares
/// for each part: exact where the residuals are linear in the intrinsics. Each part needs 4 views.
/// A lens that was focused or zoomed in between is a second camera. None where no intrinsics are
/// estimated.
/// @param solved  without robot poses, its views in the order of the pictures
/// Cost: O(views).
std::optional<SecondCamera> find_second_camera(const Bundle& solved);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures of two cameras that were taken for those of one.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "hardware/calibration/bundle.h"

namespace glint {

struct SecondCamera {
  std::vector<bool> is_second;  ///< of each of the bundle's views; the first view is false
  std::size_t first_view = 0;   ///< the first that the second camera took
  double explained = 0.0;       ///< share of the squared residuals that two cameras explain
  double focal_ratio = 1.0;     ///< the second one's focal length over the first one's

  /// Whether all views from first_view on, and no others, are the second camera's.
  bool is_one_after_the_other() const;
};

/// Looks for two cameras that took the views, in any order, by turns of fitting both and giving
/// each view to the one that fits it better. Starts: by one step of least squares every place in
/// the row where the cameras may have changed, every second view, and random halves; the best
/// of them is then fitted in full.
///
/// Two cameras are found when they leave less than half of the squared residuals that one leaves,
/// and when the Bayesian information criterion prefers them: n ln(ratio) > p ln n + 2 v ln 2, with
/// v views, p intrinsics, n = 14 v, since neighbouring corners share their errors, and the last
/// term for the choice of views. Each needs 4 views. A lens that was focused or zoomed in between
/// is a second camera. None where no intrinsics are estimated.
/// @param solved  without robot poses, its views in the order of the pictures
/// Source: G. Schwarz, "Estimating the dimension of a model", Annals of Statistics 6(2), 1978.
/// Cost: O(views^2) small products, and up to 12 fits of a camera.
std::optional<SecondCamera> find_second_camera(const Bundle& solved);

}  // namespace glint

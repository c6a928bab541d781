// SPDX-License-Identifier: GPL-3.0-or-later
//
// Changes of a rendered picture that `glint compare` is to name, and how surely it can.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "core/thread_pool.h"
#include "studies/compare/causes.h"
#include "studies/imaging/scene_store.h"

namespace glint::test {

struct Change {
  CauseParameter parameter;
  double value;  ///< in inner units
};

/// Each moves edges by some tenths of a pixel of 612 in the picture's width.
inline const std::vector<Change>& known_changes() {
  static const std::vector<Change> changes = {{CauseParameter::kTurnX, 0.006},
                                              {CauseParameter::kTurnY, -0.006},
                                              {CauseParameter::kTurnZ, 0.002},
                                              {CauseParameter::kShiftX, 0.06},
                                              {CauseParameter::kShiftY, -0.06},
                                              {CauseParameter::kDistance, 0.4},
                                              {CauseParameter::kFocalLength, 2.0},
                                              {CauseParameter::kCentreX, 0.4},
                                              {CauseParameter::kCentreY, -0.4},
                                              {CauseParameter::kK1, 0.05},
                                              {CauseParameter::kP1, 0.002}};
  return changes;
}

/// Cramer-Rao bound of the roughness by the noise of single pixels, of which the sensor's blur
/// makes neighbours alike. Noise of S a square pixel under a Gaussian blur, averaged over pixels,
/// has the variance S m^2, m the mean of max(1 - |t|, 0) over normal t of root 2 times the blur, so
/// that m^-2 pixels tell what one would.
/// @param blur_px  of the picture
inline double roughness_bound(const ComparedPair& pair, double blur_px) {
  constexpr int kWidthPx = 612;  // that it is rendered at, at most
  const int factor = (pair.real.width() + kWidthPx - 1) / kWidthPx;
  const double spread = std::numbers::sqrt2 * blur_px / factor;
  const double mean =
      std::erf(1.0 / (std::numbers::sqrt2 * spread)) -
      spread * std::sqrt(2.0 / std::numbers::pi) * (1.0 - std::exp(-0.5 / (spread * spread)));
  ThreadPool pool(2);
  SceneStore store(pool);
  PairCauses causes = find_causes(pair);
  add_roughness(pair, store, causes);
  return causes.roughness_bound / mean;
}

}  // namespace glint::test

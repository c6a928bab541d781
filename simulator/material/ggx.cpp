// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/material/ggx.h"

namespace glint {

GgxAlpha<double> alpha_from_roughness(double roughness, double anisotropy) {
  constexpr double kFloor = 1e-3;
  const double alpha = roughness * roughness;
  const double aspect = std::sqrt(1.0 - 0.9 * std::abs(anisotropy));
  const double wide = std::max(kFloor, alpha / aspect);
  const double narrow = std::max(kFloor, alpha * aspect);
  return anisotropy >= 0.0 ? GgxAlpha<double>{.x = wide, .y = narrow}
                           : GgxAlpha<double>{.x = narrow, .y = wide};
}

}  // namespace glint

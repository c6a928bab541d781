// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/stability/reference/reference_light.h"

#include <cmath>

#include <Eigen/Geometry>

namespace glint::stability {

double polygon_irradiance(const std::array<Eigen::Vector3d, 4>& corners_mm,
                          const Eigen::Vector3d& place_mm,
                          const Eigen::Vector3d& normal,
                          double radiance) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners_mm.size(); ++i) {
    const Eigen::Vector3d a = (corners_mm[i] - place_mm).normalized();
    const Eigen::Vector3d b = (corners_mm[(i + 1) % corners_mm.size()] - place_mm).normalized();
    const Eigen::Vector3d across = a.cross(b);
    const double sine = across.norm();
    if (sine > 0.0) {
      sum += std::atan2(sine, a.dot(b)) * normal.dot(across) / sine;
    }
  }
  return 0.5 * radiance * std::abs(sum);
}

}  // namespace glint::stability

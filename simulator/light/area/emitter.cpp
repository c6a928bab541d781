// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/emitter.h"

#include <cmath>

namespace glint {

using Eigen::Array3f;
using Eigen::Vector3d;

double IesBody::projected_area_m2(const Vector3d& direction) const {
  const Vector3d d = frame.local(direction).cwiseAbs();
  const double face = size_mm.x() * size_mm.y() * (is_round ? kPi / 4.0 : 1.0);
  const double sides = size_mm.z() * (d.x() * size_mm.y() + d.y() * size_mm.x());
  return (d.z() * face + sides) * kM2PerMm2;
}

double IesBody::radiance(const Vector3d& direction) const {
  const double intensity = table.at(frame.local(direction));
  const double area = projected_area_m2(direction);
  return area > 0.0 ? intensity / area : 0.0;
}

Array3f emitted_radiance(const Emitter& emitter,
                         const std::vector<IesBody>& bodies,
                         double cosine,
                         const Vector3d& direction) {
  if (!(cosine > 0.0)) {
    return Array3f::Zero();
  }
  if (emitter.body >= 0) {
    const IesBody& body = bodies[static_cast<std::size_t>(emitter.body)];
    return emitter.radiance * static_cast<float>(body.radiance(direction));
  }
  if (emitter.exponent == 1.0) {
    return emitter.radiance;
  }
  return emitter.radiance * static_cast<float>(std::pow(cosine, emitter.exponent - 1.0));
}

Array3f lobe_power_w(const Emitter& emitter) {
  const double area_m2 = area_mm2(emitter.shape) * kM2PerMm2;
  return emitter.radiance * static_cast<float>(area_m2 * 2.0 * kPi / (emitter.exponent + 1.0));
}

double exponent_of_half_angle(double half_angle_rad) {
  const double exponent = std::log(0.5) / std::log(std::cos(half_angle_rad));
  // 60 degrees are a Lambertian surface, whatever the last digit of the cosine.
  return std::abs(exponent - 1.0) < 1e-12 ? 1.0 : exponent;
}

}  // namespace glint

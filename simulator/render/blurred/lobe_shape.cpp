// SPDX-License-Identifier: GPL-3.0-or-later
//
// A facet that reflects light between the directions L and v has the normal L + v. In the middle of
// the lobe L + v is along the surface's normal, with a length of twice the cosine of incidence;
// when L changes by dL, the facet's slope therefore changes by the part of dL along the surface
// over (2 cosine): by half the angle that L turns by in the plane of incidence, and by more across
// it.
#include "simulator/render/blurred/lobe_shape.h"

#include <algorithm>
#include <cmath>

namespace glint {

using Eigen::Vector2d;
using Eigen::Vector3d;

double LobeShape::width_along(double per_phi, double per_t) const {
  const double of_phi = per_phi + tilt * per_t;
  return std::sqrt(of_phi * of_phi / across + per_t * per_t / along);
}

LobeShape lobe_shape(const BlurredPoint& point, double alpha) {
  constexpr double kMin = 1e-6;  // of a direction along the tunnel, or of a grazing cosine
  const Vector3d sum = point.mirrored + point.to_viewer;
  const double length = std::max(sum.norm(), kMin);
  const Vector3d& r = point.mirrored;
  LobeShape shape;
  shape.frame = frame_at(sum / length, Vector3d::UnitX());
  const double in_plane = std::max(std::hypot(r.y(), r.z()), kMin);
  shape.phi0_rad = std::atan2(r.y(), r.z());
  shape.t0 = r.x() / in_plane;
  const Vector3d flat(shape.t0, r.y() / in_plane, r.z() / in_plane);
  const Vector3d by_phi(0.0, flat.z(), -flat.y());
  const Vector3d by_t = Vector3d::UnitX() - flat * (shape.t0 / (1.0 + shape.t0 * shape.t0));
  const double scale = 1.0 / (alpha * length * std::sqrt(1.0 + shape.t0 * shape.t0));
  const auto slope = [&](const Vector3d& change) {
    return Vector2d(scale *
                    Vector2d(shape.frame.tangent.dot(change), shape.frame.bitangent.dot(change)));
  };
  const Vector2d of_phi = slope(by_phi);
  const Vector2d of_t = slope(by_t);
  shape.along = of_t.squaredNorm();
  shape.tilt = -of_phi.dot(of_t) / shape.along;
  shape.across = (of_phi + shape.tilt * of_t).squaredNorm();
  return shape;
}

}  // namespace glint

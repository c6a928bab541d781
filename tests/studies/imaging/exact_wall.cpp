// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/studies/imaging/exact_wall.h"

#include <algorithm>
#include <cmath>

#include "simulator/light/tunnel/tunnel_profile.h"
#include "simulator/render/ray_cache/packet_tracer.h"

namespace glint {
namespace {

constexpr double kNearest_mm = 1e-3;

ExactRays rays_of(const RayCache& cache) {
  ExactRays rays;
  for (std::size_t i = 0; i < cache.weight.size(); ++i) {
    rays.origin_mm.push_back(vector_of(cache.origin_x[i], cache.origin_y[i], cache.origin_z[i]));
    rays.direction.push_back(
        vector_of(cache.direction_x[i], cache.direction_y[i], cache.direction_z[i]));
  }
  return rays;
}

/// Traces rays anew through places of the image; place_of(i) is that of ray i.
template <class PlaceOf>
void trace_anew(const TraceScene& scene,
                const CameraRays& camera,
                const PlaceOf& place_of,
                ExactRays& rays) {
  PacketTracer tracer(scene);
  const std::size_t total = rays.origin_mm.size();
  for (std::size_t first = 0; first < total; first += kPacketSize) {
    const std::size_t count = std::min<std::size_t>(kPacketSize, total - first);
    Lanes x = {};
    Lanes y = {};
    for (std::size_t lane = 0; lane < count; ++lane) {
      const Eigen::Vector2d place = place_of(first + lane);
      x[lane] = place.x();
      y[lane] = place.y();
    }
    CameraPacket packet;
    EscapePacket escapes;
    camera.through(x.data(), y.data(), static_cast<int>(count), packet);
    tracer.trace(packet, escapes);
    for (std::size_t lane = 0; lane < count; ++lane) {
      if (escapes.path[lane] == RayPath::kOnce) {
        rays.origin_mm[first + lane] = {
            escapes.origin_x[lane], escapes.origin_y[lane], escapes.origin_z[lane]};
        rays.direction[first + lane] = {
            escapes.direction_x[lane], escapes.direction_y[lane], escapes.direction_z[lane]};
      }
    }
  }
}

}  // namespace

ExactWall::ExactWall(const TunnelSettings& settings)
    : s_(settings),
      walls_(flat_walls(s_.distance_mm, s_.opening_rad, s_.panel_height_mm, s_.base_mm)) {
  if (s_.shape == TunnelSettings::Shape::kFree) {
    segments_ = with_straight_ends(free_segments(s_.control_mm, s_.base_mm));
  }
}

ExactPlace ExactWall::intersect(const Eigen::Vector3d& origin,
                                const Eigen::Vector3d& direction) const {
  const Eigen::Vector2d from = origin.tail<2>();
  const Eigen::Vector2d along = direction.tail<2>();
  const std::optional<double> t = distance(from, along);
  if (!t) {
    return {};
  }
  const Eigen::Vector2d point = from + *t * along;
  const double margin =
      s_.shape == TunnelSettings::Shape::kFlat ? flat_margin(point) : point.y() - s_.base_mm;
  return {.x_mm = origin.x() + *t * direction.x(), .y_mm = point.x(), .margin_mm = margin};
}

std::optional<double> ExactWall::distance(const Eigen::Vector2d& from,
                                          const Eigen::Vector2d& along) const {
  switch (s_.shape) {
    case TunnelSettings::Shape::kFlat:
      return to_panels(from, along);
    case TunnelSettings::Shape::kFree:
      return hit_segments(segments_, from, along, kNearest_mm);
    case TunnelSettings::Shape::kSemicylinder:
      return to_curve({s_.radius_mm, s_.radius_mm}, 2.0, from, along);
    case TunnelSettings::Shape::kEllipse:
      return to_curve({s_.half_width_mm, s_.height_mm}, 2.0, from, along);
    default:
      return to_curve({s_.half_width_mm, s_.height_mm}, s_.exponent, from, along);
  }
}

std::optional<double> ExactWall::to_panels(const Eigen::Vector2d& from,
                                           const Eigen::Vector2d& along) const {
  std::optional<double> nearest;
  for (const FlatWall& wall : walls_) {
    const Eigen::Vector2d normal(wall.normal_y, wall.normal_z);
    const double slope = normal.dot(along);
    const double t = (wall.offset_mm - normal.dot(from)) / slope;
    if (slope > 0.0 && t > kNearest_mm && (!nearest || t < *nearest)) {
      nearest = t;
    }
  }
  return nearest;
}

double ExactWall::flat_margin(const Eigen::Vector2d& point) const {
  const FlatWall& wall = walls_[1];
  const double sine = std::sin(0.5 * s_.opening_rad);
  const bool touch_at_top = s_.panel_height_mm * sine >= s_.distance_mm * (1.0 - 1e-9);
  const double along = (std::abs(point.x()) - wall.start_y_mm) * wall.along_y +
                       (point.y() - wall.start_z_mm) * wall.along_z;
  return touch_at_top ? along : std::min(along, wall.length_mm - along);
}

/// By Newton's method on the norm, which is convex along a ray; rays start inside.
std::optional<double> ExactWall::to_curve(const Eigen::Vector2d& axes,
                                          double exponent,
                                          const Eigen::Vector2d& from,
                                          const Eigen::Vector2d& along) const {
  const Eigen::Vector2d p = (from - Eigen::Vector2d(0.0, s_.base_mm)).cwiseQuotient(axes);
  const Eigen::Vector2d v = along.cwiseQuotient(axes);
  const double a = v.squaredNorm();
  const double b = p.dot(v);
  const double c = p.squaredNorm() - 1.0;
  if (!(b * b - a * c > 0.0) || !(a > 0.0)) {
    return std::nullopt;
  }
  double t = (std::sqrt(b * b - a * c) - b) / a;
  constexpr int kMaxSteps = 50;
  for (int step = 0; exponent != 2.0 && step < kMaxSteps; ++step) {
    const Eigen::Vector2d q = (p + t * v).cwiseAbs();
    const Eigen::Vector2d w(p.x() + t * v.x() < 0.0 ? -v.x() : v.x(),
                            p.y() + t * v.y() < 0.0 ? -v.y() : v.y());
    const Eigen::Vector2d g(std::pow(q.x(), exponent - 1.0), std::pow(q.y(), exponent - 1.0));
    // The norm (sum of powers)^(1 / exponent) is convex along the ray.
    const double sum = g.dot(q);
    const double norm = std::pow(sum, 1.0 / exponent);
    const double change = (norm - 1.0) * sum / (norm * g.dot(w));
    t -= change;
    if (std::abs(change) < 1e-15 * t) {
      break;
    }
  }
  const bool is_hit = t > kNearest_mm && p.y() + t * v.y() >= -2.0;
  return is_hit ? std::optional(t) : std::nullopt;
}

ExactPicture picture_of(const CornerRays& rays) {
  ExactPicture picture = {.corners = rays_of(rays.corners), .refined = {}};
  for (const RefinedGroup& group : rays.refined) {
    picture.refined.push_back(rays_of(group.rays));
  }
  return picture;
}

ExactPicture picture_from(const TracedScene& traced,
                          const SceneSettings& scene,
                          const RigidTransform& camera_from_world) {
  const PinholeCamera camera(intrinsics_of(scene.camera));
  const CameraRays through(camera, camera_from_world);
  const TraceScene world(traced.built().part, *traced.built().bvh, traced.detail(), scene.render);
  ExactPicture picture = picture_of(traced.corners);
  const auto columns = static_cast<std::size_t>(traced.corners.width_px) + 1;
  trace_anew(
      world,
      through,
      [&](std::size_t i) {
        return Eigen::Vector2d(static_cast<double>(i % columns), static_cast<double>(i / columns));
      },
      picture.corners);
  for (std::size_t g = 0; g < picture.refined.size(); ++g) {
    const RefinedGroup& group = traced.corners.refined[g];
    const auto n = static_cast<std::size_t>(group.cells_per_axis);
    const auto width = static_cast<std::size_t>(traced.corners.width_px);
    trace_anew(
        world,
        through,
        [&](std::size_t i) {
          const auto pixel = static_cast<std::size_t>(group.pixels[i / ((n + 1) * (n + 1))]);
          const std::size_t corner = i % ((n + 1) * (n + 1));
          const auto cells = static_cast<double>(n);
          return Eigen::Vector2d(
              static_cast<double>(pixel % width) + static_cast<double>(corner % (n + 1)) / cells,
              static_cast<double>(pixel / width) + static_cast<double>(corner / (n + 1)) / cells);
        },
        picture.refined[g]);
  }
  return picture;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/surface/simulated_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "core/error.h"
#include "core/image/exr_layers.h"

namespace glint {

using Eigen::Vector2d;
using Eigen::Vector3d;

SimulatedSurface::SimulatedSurface(const std::filesystem::path& geometry,
                                   int width_px,
                                   int height_px,
                                   const RigidTransform& camera_from_scene)
    : camera_from_scene_(camera_from_scene) {
  const std::array<std::string, 7> names = {"position_mm.x",
                                            "position_mm.y",
                                            "position_mm.z",
                                            "normal.x",
                                            "normal.y",
                                            "normal.z",
                                            "depth_mm"};
  channels_ = read_exr_channels(geometry, names);
  if (width() != width_px || height() != height_px) {
    throw ConfigError(fmt::format(
        "{}: is {} x {} pixels, the simulated picture is {} x {}: both must be of one rendering",
        geometry.string(),
        width(),
        height(),
        width_px,
        height_px));
  }
}

Vector3d SimulatedSurface::point_mm(int x, int y) const {
  return vector_of(channels_[0](x, y), channels_[1](x, y), channels_[2](x, y));
}

Vector3d SimulatedSurface::normal(int x, int y) const {
  return vector_of(channels_[3](x, y), channels_[4](x, y), channels_[5](x, y)).normalized();
}

double SimulatedSurface::depth_mm(int x, int y) const {
  return static_cast<double>(channels_[kDepth](x, y));
}

Vector3d SimulatedSurface::in_camera_mm(int x, int y) const {
  return camera_from_scene_ * point_mm(x, y);
}

std::optional<Vector3d> SimulatedSurface::at_edge(const PinholeCamera& camera,
                                                  const Vector2d& at_px,
                                                  const Vector2d& normal) const {
  constexpr double kNear_px = 2.0;
  constexpr double kMaxBend = 0.02;  ///< of the depth, from within to the edge
  double nearest = 0.0;
  for (const double side : {-1.0, 1.0}) {
    const Vector2d step = side * kNear_px * normal;
    const double first = inverse_depth(at_px + step);
    const double second = inverse_depth(at_px + 2.0 * step);
    const double slope = second > 0.0 ? first - second : 0.0;
    const bool is_bent = std::abs(slope) > kMaxBend * first;
    nearest = std::max(nearest, first > 0.0 && !is_bent ? first + slope : first);
  }
  const auto ray = camera.ray_through(at_px);
  if (nearest <= 0.0 || !ray) {
    return std::nullopt;
  }
  return Vector3d(*ray / (ray->z() * nearest));
}

double SimulatedSurface::free_px(const Vector2d& at_px,
                                 const Vector2d& normal,
                                 double reach_px) const {
  constexpr double kOwn_px = 2.0;  // nearer pixels may mix what lies on both sides of this edge
  constexpr double kStep_px = 1.0;
  for (double away_px = kOwn_px; away_px + kStep_px <= reach_px; away_px += kStep_px) {
    for (const double side : {-1.0, 1.0}) {
      const Vector2d first_px = at_px + side * away_px * normal;
      const Vector2d second_px = first_px + side * kStep_px * normal;
      if (is_within(first_px) && is_within(second_px) && is_edge_between(first_px, second_px)) {
        return away_px;
      }
    }
  }
  return std::numeric_limits<double>::infinity();
}

Vector3d SimulatedSurface::middle_mm() const {
  Vector3d sum = Vector3d::Zero();
  double count = 0.0;
  for (int y = 0; y < height(); ++y) {
    for (int x = 0; x < width(); ++x) {
      if (is_part(x, y)) {
        sum += in_camera_mm(x, y);
        count += 1.0;
      }
    }
  }
  return count > 0.0 ? Vector3d(sum / count) : Vector3d(0.0, 0.0, 1.0);
}

bool SimulatedSurface::is_within(const Vector2d& at_px) const {
  return at_px.minCoeff() >= 0.0 && at_px.x() < width() && at_px.y() < height();
}

/// Of the pixels of two neighbouring places.
bool SimulatedSurface::is_edge_between(const Vector2d& first_px, const Vector2d& second_px) const {
  constexpr double kMinCos = 0.97;  // of 14 degrees: faces that meet, no curved one
  constexpr double kMinStep = 0.5;  // of the way between both points, across the surface
  const Eigen::Vector2i first = first_px.cast<int>();
  const Eigen::Vector2i second = second_px.cast<int>();
  if (!is_part(first.x(), first.y()) || !is_part(second.x(), second.y())) {
    return is_part(first.x(), first.y()) != is_part(second.x(), second.y());
  }
  const Vector3d normal_before = normal(first.x(), first.y());
  const Vector3d way_mm = point_mm(second.x(), second.y()) - point_mm(first.x(), first.y());
  return normal_before.dot(normal(second.x(), second.y())) < kMinCos ||
         std::abs(normal_before.dot(way_mm)) > kMinStep * way_mm.norm();
}

/// Between the centres of pixels; 0 where one of them is not on the part.
double SimulatedSurface::inverse_depth(const Vector2d& at_px) const {
  const double u = at_px.x() - 0.5;
  const double v = at_px.y() - 0.5;
  const int x0 = static_cast<int>(std::floor(u));
  const int y0 = static_cast<int>(std::floor(v));
  if (x0 < 0 || y0 < 0 || x0 + 1 >= width() || y0 + 1 >= height()) {
    return 0.0;
  }
  double sum = 0.0;
  for (const int x : {x0, x0 + 1}) {
    for (const int y : {y0, y0 + 1}) {
      if (!is_part(x, y)) {
        return 0.0;
      }
      sum += (1.0 - std::abs(u - x)) * (1.0 - std::abs(v - y)) / in_camera_mm(x, y).z();
    }
  }
  return sum;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/lit_place.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Neighbouring pixels whose reflected rays differ by more lie on two sides of a crease.
constexpr double kLargestTurn_rad = 0.2;

constexpr int kSmallestMargin_px = 3;

Vector3d origin_of(const RayCache& rays, std::size_t ray) {
  return {static_cast<double>(rays.origin_x[ray]),
          static_cast<double>(rays.origin_y[ray]),
          static_cast<double>(rays.origin_z[ray])};
}

Vector3d direction_of(const RayCache& rays, std::size_t ray) {
  return {static_cast<double>(rays.direction_x[ray]),
          static_cast<double>(rays.direction_y[ray]),
          static_cast<double>(rays.direction_z[ray])};
}

/// Whether the ray left the part where the camera sees it: not after a second reflection.
bool is_first_hit(const TracedScene& traced,
                  const PinholeCamera& camera,
                  int x,
                  int y,
                  const Vector3d& origin_mm) {
  constexpr double kFar_px = 1.5;
  const auto pixel = camera.project(traced.camera_from_world * origin_mm);
  return pixel && (*pixel - Vector2d(x + 0.5, y + 0.5)).norm() < kFar_px;
}

/// 1 where all rays of a pixel are lit after one reflection, and go the way of its left and upper
/// neighbours' rays.
Mask good_pixels(const TracedScene& traced, const Tunnel& tunnel, const PinholeCamera& camera) {
  const RayCache& rays = traced.rays;
  const WallRays wall = meet_wall(rays, tunnel, traced.camera_in_world_mm);
  const auto pixels = static_cast<std::size_t>(rays.num_pixels());
  Mask good(rays.width_px, rays.height_px);
  for (int y = 1; y < rays.height_px; ++y) {
    for (int x = 1; x < rays.width_px; ++x) {
      const std::size_t pixel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(rays.width_px) +
          static_cast<std::size_t>(x);
      bool is_good = rays.coverage(x, y) > 0.999F &&
                     is_first_hit(traced, camera, x, y, origin_of(rays, pixel));
      for (int s = 0; is_good && s < rays.samples; ++s) {
        is_good = wall.gain[static_cast<std::size_t>(s) * pixels + pixel] > 0.0F;
      }
      const Vector3d here = direction_of(rays, pixel);
      const double smallest_cosine = std::cos(kLargestTurn_rad);
      is_good = is_good && here.dot(direction_of(rays, pixel - 1)) > smallest_cosine &&
                here.dot(direction_of(rays, pixel - static_cast<std::size_t>(rays.width_px))) >
                    smallest_cosine;
      good(x, y) = is_good ? 1 : 0;
    }
  }
  return good;
}

/// Pixels of the mask, the nearest to the middle of the picture first.
std::vector<Vector2d> from_the_middle(const Mask& mask) {
  std::vector<Vector2d> places;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (mask(x, y) != 0) {
        places.emplace_back(x, y);
      }
    }
  }
  const Vector2d middle(0.5 * mask.width(), 0.5 * mask.height());
  std::ranges::stable_sort(
      places, {}, [&](const Vector2d& place) { return (place - middle).squaredNorm(); });
  return places;
}

/// A defect is placed by a line down the part's z axis; that must meet what the camera sees.
std::optional<Vector2d> place_at(const TracedScene& traced,
                                 const Vector3d& point_mm,
                                 double near_mm) {
  const Part& part = traced.built->part;
  const Vector3d in_part = inverse(part.scene_from_part) * point_mm;
  const auto place = place_on_surface(part, *traced.built->bvh, in_part.x(), in_part.y());
  if (!place || (place->centre_mm - point_mm).norm() > near_mm) {
    return std::nullopt;
  }
  return in_part.head<2>();
}

}  // namespace

std::optional<Vector2d> lit_place(SceneStore& store, const SceneSettings& scene, double margin_mm) {
  SceneSettings flawless = scene;
  flawless.defects.clear();
  const auto traced = store.trace(flawless);
  const PinholeCamera camera(intrinsics_of(scene.camera));
  const Mask good = good_pixels(*traced, Tunnel(scene.tunnel), camera);
  const double pixels_per_mm = camera.intrinsics().focal_px.x() / traced->camera_in_world_mm.norm();
  int margin_px =
      std::max(kSmallestMargin_px, static_cast<int>(std::ceil(margin_mm * pixels_per_mm)));
  for (; margin_px >= kSmallestMargin_px; margin_px = margin_px * 2 / 3) {
    for (const Vector2d& pixel : from_the_middle(eroded(good, margin_px))) {
      const auto index =
          static_cast<std::size_t>(pixel.y()) * static_cast<std::size_t>(traced->rays.width_px) +
          static_cast<std::size_t>(pixel.x());
      const auto place = place_at(*traced, origin_of(traced->rays, index), 2.0 / pixels_per_mm);
      if (place) {
        return place;
      }
    }
  }
  return std::nullopt;
}

}  // namespace glint

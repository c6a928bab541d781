// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/illuminated_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "simulator/render/scan/scan.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Neighbouring pixels whose reflected rays differ by more lie on two sides of a crease. Evener
/// surroundings are looked for first: a defect among creases has no even background.
constexpr std::array kLargestTurns_rad = {0.01, 0.05, 0.2};

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

/// Whether a ray meets the wall, wherever the scan has moved its ends.
bool is_lit(const WallRays& wall, const TunnelSettings& tunnel, std::size_t ray) {
  const double half_length_mm = 0.5 * tunnel.length_mm - tunnel.period_mm;
  return wall.gain[ray] > 0.0F && std::abs(static_cast<double>(wall.x_mm[ray])) < half_length_mm;
}

/// Share of the part's pixels that the first of their rays shows lit.
double lit_share(const TracedScene& traced, const SceneSettings& scene) {
  const WallRays wall =
      intersect_wall(traced.rays, Tunnel(scene.tunnel), traced.camera_in_world_mm);
  double lit = 0.0;
  for (std::size_t pixel = 0; pixel < traced.part_mask.size(); ++pixel) {
    lit += traced.part_mask.values()[pixel] != 0 && is_lit(wall, scene.tunnel, pixel) ? 1.0 : 0.0;
  }
  return lit / static_cast<double>(count_inside(traced.part_mask));
}

/// Whether the ray of a pixel leaves almost as those of the pixels to the left and above.
bool is_smooth(const RayCache& rays, std::size_t pixel, double smallest_cosine) {
  const Vector3d here = direction_of(rays, pixel);
  const std::size_t above = pixel - static_cast<std::size_t>(rays.width_px);
  return here.dot(direction_of(rays, pixel - 1)) > smallest_cosine &&
         here.dot(direction_of(rays, above)) > smallest_cosine;
}

/// 1 where all rays of a pixel are lit after one reflection, and go the way of its left and upper
/// neighbours' rays.
Mask good_pixels(const TracedScene& traced,
                 const Tunnel& tunnel,
                 const PinholeCamera& camera,
                 double largest_turn_rad) {
  const RayCache& rays = traced.rays;
  const WallRays wall = intersect_wall(rays, tunnel, traced.camera_in_world_mm);
  const auto pixels = static_cast<std::size_t>(rays.num_pixels());
  const double smallest_cosine = std::cos(largest_turn_rad);
  Mask good(rays.width_px, rays.height_px);
  for (int y = 1; y < rays.height_px; ++y) {
    for (int x = 1; x < rays.width_px; ++x) {
      const std::size_t pixel =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(rays.width_px) +
          static_cast<std::size_t>(x);
      bool is_good = rays.coverage(x, y) > 0.999F &&
                     is_first_hit(traced, camera, x, y, origin_of(rays, pixel));
      for (int s = 0; is_good && s < rays.samples; ++s) {
        is_good = is_lit(wall, tunnel.settings(), static_cast<std::size_t>(s) * pixels + pixel);
      }
      good(x, y) = is_good && is_smooth(rays, pixel, smallest_cosine) ? 1 : 0;
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

/// A defect is placed by a line down the part's z axis. That line, and its neighbours, must meet
/// what the camera sees, so that no overhang's edge catches it.
std::optional<Vector2d> place_at(const TracedScene& traced,
                                 const Vector3d& point_mm,
                                 double pixel_mm) {
  const Part& part = traced.built().part;
  const Vector2d middle = (inverse(part.scene_from_part) * point_mm).head<2>();
  constexpr double kSide_px = 3.0;
  for (const Vector2d& side :
       {Vector2d(0, 0), Vector2d(1, 0), Vector2d(-1, 0), Vector2d(0, 1), Vector2d(0, -1)}) {
    const Vector2d at = middle + kSide_px * pixel_mm * side;
    const auto place = place_on_surface(part, *traced.built().bvh, at.x(), at.y());
    if (!place || (place->centre_mm - point_mm).norm() > 3.0 * kSide_px * pixel_mm) {
      return std::nullopt;
    }
  }
  return middle;
}

/// Adds places on the good pixels until there are as many as wanted.
void add_places(const TracedScene& traced,
                const Mask& good,
                double pixel_mm,
                double apart_mm,
                std::size_t wanted,
                std::vector<Vector2d>& places_mm) {
  const auto is_free = [&](const Vector2d& place) {
    return std::ranges::all_of(
        places_mm, [&](const Vector2d& other) { return (other - place).norm() >= apart_mm; });
  };
  const Part& part = traced.built().part;
  for (const Vector2d& pixel : from_the_middle(good)) {
    if (places_mm.size() >= wanted) {
      return;
    }
    const auto index =
        static_cast<std::size_t>(pixel.y()) * static_cast<std::size_t>(traced.rays.width_px) +
        static_cast<std::size_t>(pixel.x());
    const Vector3d point_mm = origin_of(traced.rays, index);
    if (!is_free((inverse(part.scene_from_part) * point_mm).head<2>())) {
      continue;
    }
    if (const auto place = place_at(traced, point_mm, pixel_mm)) {
      places_mm.push_back(*place);
    }
  }
}

}  // namespace

IlluminatedPlaces illuminated_places(SceneStore& store,
                                     const SceneSettings& scene,
                                     double margin_mm,
                                     std::size_t wanted) {
  SceneSettings flawless = scene;
  flawless.defects.clear();
  if (!keeps_rays(flawless)) {
    flawless.render.method = RenderSettings::Method::kSampled;  // any few rays a pixel will do
  }
  const auto traced = store.trace(flawless);
  const PinholeCamera camera(intrinsics_of(scene));
  const double pixels_per_mm = camera.intrinsics().focal_px.x() / traced->camera_in_world_mm.norm();
  const int widest_px =
      std::max(kSmallestMargin_px, static_cast<int>(std::ceil(margin_mm * pixels_per_mm)));
  IlluminatedPlaces found{.lit_share = lit_share(*traced, scene)};
  for (const double turn_rad : kLargestTurns_rad) {
    const Mask good = good_pixels(*traced, Tunnel(scene.tunnel), camera, turn_rad);
    const bool is_last = turn_rad == kLargestTurns_rad.back();
    for (int margin_px = widest_px; margin_px >= kSmallestMargin_px;
         margin_px = margin_px * 2 / 3) {
      add_places(*traced,
                 eroded(good, margin_px),
                 1.0 / pixels_per_mm,
                 2.0 * margin_mm,
                 wanted,
                 found.places_mm);
      if (!is_last || !found.places_mm.empty()) {
        break;
      }
    }
  }
  return found;
}

}  // namespace glint

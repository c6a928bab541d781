// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/wall/occluded_pixels.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "simulator/render/footprint/visible_part.h"
#include "tests/simulator/render/footprint/footprint_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;

TunnelSettings random_wall(Rng& rng) {
  using Shape = TunnelSettings::Shape;
  const double size = rng.uniform(30.0, 200.0);
  return {.shape = static_cast<Shape>(rng.next_u32() % 5),
          .base_mm = rng.uniform(-20.0, 5.0),
          .radius_mm = size,
          .half_width_mm = size,
          .height_mm = rng.uniform(30.0, 350.0),
          .exponent = rng.uniform(1.2, 8.0),
          .distance_mm = rng.uniform(20.0, 60.0),
          .opening_rad = rng.uniform(0.0, 1.0),
          .panel_height_mm = rng.uniform(50.0, 400.0),
          .control_mm = {size, rng.uniform(30.0, 200.0), size, rng.uniform(30.0, 350.0), 150.0},
          .length_mm = rng.uniform(20.0, 200.0),
          .slot_mm = rng.uniform(0.0, 30.0)};
}

/// A part, and what a camera anywhere above it sees of it.
struct SightBench {
  Part part;
  Bvh bvh;
  PinholeCamera camera;
  RigidTransform camera_from_world;
  Vector3d camera_mm;
  CornerRays rays;

  SightBench(const PartSettings& part_settings,
             const CameraSettings& camera_settings,
             const Viewpoint& viewpoint)
      : part(build_part(part_settings)),
        bvh(part.mesh),
        camera(intrinsics_of(camera_settings)),
        camera_from_world(glint::camera_from_world(viewpoint)),
        camera_mm(inverse(camera_from_world).translation_mm) {
    ThreadPool pool(1);
    rays = trace_corner_rays(part, bvh, {}, camera, camera_from_world, {}, pool);
  }
};

Viewpoint random_viewpoint(Rng& rng) {
  const std::vector<double> position_mm = {
      rng.uniform(-40.0, 40.0), rng.uniform(-60.0, 60.0), rng.uniform(60.0, 400.0)};
  return {.position_mm = position_mm,
          .direction = {-position_mm[0], -position_mm[1], -position_mm[2]},
          .up = {rng.uniform(-1.0, 1.0), 1.0, 0.0}};
}

/// Whether the part stands between flat walls, as scenes must, and the slot stays above half their
/// height (docs/theory/tunnel.md, "Limits").
bool is_sensible(const Tunnel& tunnel, const CornerRays& rays) {
  const TunnelSettings& s = tunnel.settings();
  if (s.shape != TunnelSettings::Shape::kFlat) {
    return true;
  }
  const double middle_mm = 0.5 * (s.base_mm + tunnel.top_mm());
  const double at_middle_mm = s.distance_mm - std::tan(s.opening_rad) * (middle_mm - s.base_mm);
  if (at_middle_mm < 0.5 * s.slot_mm) {
    return false;
  }
  for (std::size_t i = 0; i < rays.coverage.values().size(); ++i) {
    if (rays.coverage.values()[i] > 0.0F &&
        !tunnel.contains(static_cast<double>(rays.seen_y.values()[i]),
                         static_cast<double>(rays.seen_z.values()[i]))) {
      return false;
    }
  }
  return true;
}

/// How many of some walls hide some of the part and not all of it; tiles must find what every pixel
/// by itself finds.
int compare_with_pixels(const CornerRays& rays,
                        const Vector3d& camera_mm,
                        int walls,
                        std::uint64_t seed) {
  Rng rng(seed, Stream::kTest, 0);
  int partly = 0;
  for (int trial = 0; trial < walls; ++trial) {
    const Tunnel tunnel(random_wall(rng));
    if (!is_sensible(tunnel, rays)) {
      continue;
    }
    const OccludedPixels found = occluded_pixels(rays, tunnel, camera_mm);
    const OccludedPixels expected = occluded_pixels_one_by_one(rays, tunnel, camera_mm);
    EXPECT_EQ(found, expected) << "seed " << seed << ", trial " << trial << ", "
                               << shape_name(tunnel.settings().shape);
    const auto whole = std::ranges::count(found.whole.values(), 1);
    partly += !found.edges.empty() && whole < 5000 ? 1 : 0;
    EXPECT_TRUE(std::ranges::is_sorted(found.edges, {}, &OccludedEdge::pixel));
  }
  return partly;
}

// Walls of all shapes, some with their ends, their rim or the camera in view.
TEST(OccludedPixels, TilesFindWhatEveryPixelByItselfFinds) {
  int partly = 0;
  for (std::uint64_t place = 0; place < 25; ++place) {
    Rng rng(11, Stream::kTest, place);
    CameraSettings camera = test::bench_camera();
    camera.k1 = place % 3 == 0 ? 0.1 : 0.0;
    const SightBench bench(test::bench_strip(), camera, random_viewpoint(rng));
    partly += compare_with_pixels(bench.rays, bench.camera_mm, 40, place);
  }
  EXPECT_GT(partly, 80);
}

// A part that fills the picture: its first tile has no neighbour.
TEST(OccludedPixels, TilesFindThemInThePicturesCorner) {
  PartSettings large = test::bench_strip();
  large.length_mm = 90.0;
  large.width_mm = 60.0;
  const test::FootprintBench bench(large, test::bench_camera());
  ASSERT_GT(bench.rays.coverage(0, 0), 0.0F);
  EXPECT_GT(compare_with_pixels(bench.rays, bench.camera_mm, 300, 6), 30);
}

TEST(OccludedPixels, TilesFindThemAroundThePartsOutline) {
  const test::FootprintBench bench(test::bench_strip(), test::bench_camera(), 0.4);
  EXPECT_GT(compare_with_pixels(bench.rays, bench.camera_mm, 1000, 4), 100);
}

TEST(OccludedPixels, NothingHidesWhereTheWallDoesNotBlockTheView) {
  const test::FootprintBench bench(test::bench_strip(), test::bench_camera());
  TunnelSettings settings = test::bench_tunnel();
  settings.slot_mm = 2.0;
  EXPECT_GT(
      hidden_share(
          occluded_pixels(bench.rays, Tunnel(settings), bench.camera_mm), settings, bench.rays),
      0.5);
  settings.blocks_view = false;
  EXPECT_EQ(occluded_pixels(bench.rays, Tunnel(settings), bench.camera_mm), OccludedPixels());
}

/// The share of n x n camera rays through a pixel that pass the wall, each met in double.
double passing_share(const SightBench& bench, const Tunnel& tunnel, int x, int y, int n) {
  const RigidTransform world_from_camera = inverse(bench.camera_from_world);
  const Vector3d seen =
      vector_of(bench.rays.seen_x(x, y), bench.rays.seen_y(x, y), bench.rays.seen_z(x, y));
  int passing = 0;
  for (int i = 0; i < n * n; ++i) {
    const int row = i / n;
    const auto direction = bench.camera.ray_through({x + (i % n + 0.5) / n, y + (row + 0.5) / n});
    const Vector3d along = world_from_camera.rotation * direction.value();
    const double distance_mm = (seen - bench.camera_mm).dot(along);
    const auto hit =
        tunnel.hit({.origin_mm = bench.camera_mm + distance_mm * along, .direction = -along});
    const bool is_stopped = hit && hit->t_mm < distance_mm &&
                            std::abs(hit->point_mm.x()) < 0.5 * tunnel.settings().length_mm;
    passing += is_stopped ? 0 : 1;
  }
  return static_cast<double>(passing) / (n * n);
}

// Slots, rims and ends of all shapes across the picture, through a lens that distorts.
TEST(OccludedPixels, HideAsMuchOfAPixelAsOfItsRays) {
  CameraSettings camera = test::bench_camera();
  camera.k1 = 0.2;
  Viewpoint viewpoint = test::turned_viewpoint(camera);
  const SightBench bench(test::bench_strip(), camera, viewpoint);
  Rng rng(5, Stream::kTest, 0);
  int edges = 0;
  double squares = 0.0;
  for (int trial = 0; trial < 200; ++trial) {
    TunnelSettings settings = random_wall(rng);
    settings.slot_mm = rng.uniform(0.05, 20.0);
    const Tunnel tunnel(settings);
    const OccludedPixels found = occluded_pixels(bench.rays, tunnel, bench.camera_mm);
    for (std::size_t i = 0; i < found.edges.size(); i += 7) {
      const std::int32_t pixel = found.edges[i].pixel;
      const double expected = passing_share(
          bench, tunnel, pixel % bench.rays.width_px, pixel / bench.rays.width_px, 24);
      const double area = VisiblePart(found.edges[i], settings).area();
      EXPECT_NEAR(area, expected, 0.05) << trial << ", " << shape_name(settings.shape);
      squares += (area - expected) * (area - expected);
      ++edges;
    }
  }
  EXPECT_GT(edges, 500);
  // An edge along rows or columns crosses 24 samples at once: up to 1/48.
  EXPECT_LT(std::sqrt(squares / edges), 0.01);
}

// All others are seen or hidden as a whole.
TEST(OccludedPixels, LeaveNoEdgeOut) {
  const CameraSettings camera = test::bench_camera();
  const SightBench bench(test::bench_strip(), camera, test::turned_viewpoint(camera));
  Rng rng(12, Stream::kTest, 0);
  for (int trial = 0; trial < 40; ++trial) {
    const TunnelSettings settings = random_wall(rng);
    const Tunnel tunnel(settings);
    const OccludedPixels found = occluded_pixels(bench.rays, tunnel, bench.camera_mm);
    auto edge = found.edges.begin();
    for (std::int32_t pixel = 0; pixel < bench.rays.num_pixels(); ++pixel) {
      if (edge != found.edges.end() && edge->pixel == pixel) {
        ++edge;
        continue;
      }
      const int x = pixel % bench.rays.width_px;
      const int y = pixel / bench.rays.width_px;
      if (bench.rays.coverage(x, y) > 0.0F && pixel % 5 == 0) {
        const bool is_hidden = !found.whole.empty() && found.whole(x, y) != 0;
        ASSERT_EQ(passing_share(bench, tunnel, x, y, 3), is_hidden ? 0.0 : 1.0)
            << trial << ", " << shape_name(settings.shape) << " " << x << " " << y;
      }
    }
  }
}

}  // namespace
}  // namespace glint

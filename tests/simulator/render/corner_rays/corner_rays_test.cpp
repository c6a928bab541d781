// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/corner_rays/corner_rays.h"

#include <cmath>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "core/rng.h"
#include "tests/simulator/render/corner_rays/corner_bench.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using test::askew_plate;
using test::CornerBench;
using test::kCornerCamera;
using test::same_bytes;
using test::small_strip;
using test::some_dents;

Vector3d bilinear(const RayCache::Floats& x,
                  const RayCache::Floats& y,
                  const RayCache::Floats& z,
                  const std::array<std::size_t, 4>& corner,
                  const Vector2d& at) {
  const auto value = [&](std::size_t i) { return vector_of(x[i], y[i], z[i]); };
  return (1 - at.y()) * ((1 - at.x()) * value(corner[0]) + at.x() * value(corner[1])) +
         at.y() * ((1 - at.x()) * value(corner[2]) + at.x() * value(corner[3]));
}

/// The error of interpolated rays against traced ones at random places in a cell.
struct CellError {
  double direction_rad = 0.0;
  double origin_mm = 0.0;
};

CellError error_in_cell(const CornerBench& bench,
                        const RayCache& rays,
                        const std::array<std::size_t, 4>& corner,
                        const Vector2d& corner_px,
                        double cell_px,
                        const Vector2d& at) {
  const EscapePacket traced = bench.trace_at(corner_px + cell_px * at);
  EXPECT_EQ(traced.path[0], RayPath::kOnce);
  const Vector3d direction(traced.direction_x[0], traced.direction_y[0], traced.direction_z[0]);
  const Vector3d origin(traced.origin_x[0], traced.origin_y[0], traced.origin_z[0]);
  return {
      .direction_rad =
          (bilinear(rays.direction_x, rays.direction_y, rays.direction_z, corner, at) - direction)
              .norm(),
      .origin_mm =
          (bilinear(rays.origin_x, rays.origin_y, rays.origin_z, corner, at) - origin).norm()};
}

// The camera of 30 x 20 mm sees only the top of the 60 x 40 mm plate: nothing is bent.
TEST(CornerRays, APlateThatFillsTheImageIsSmoothEverywhere) {
  const CornerBench bench(test::plate(), kCornerCamera);
  EXPECT_EQ(bench.count(PixelKind::kSmooth), bench.rays.num_pixels());
  EXPECT_TRUE(bench.rays.refined.empty());
  for (const float coverage : bench.rays.coverage.values()) {
    ASSERT_EQ(coverage, 1.0F);
  }
  EXPECT_EQ(bench.rays.counts.camera, 121 * 81);
  EXPECT_EQ(bench.rays.corners.origin_x.size(), 121U * 81U);
}

// Pixel (0, 0) spans x from -15 to -14.75 and y from 10 to 9.75 mm at z = 0, where the camera's
// pixels are 0.25 mm; the plate's top is 1 mm nearer to the camera at 300 mm: 299/300 of it.
TEST(CornerRays, ASmoothPixelSeesTheMeanOfItsCorners) {
  const CornerBench bench(test::plate(), kCornerCamera);
  EXPECT_NEAR(static_cast<double>(bench.rays.seen_x(0, 0)), -14.875 * 299.0 / 300.0, 1e-5);
  EXPECT_NEAR(static_cast<double>(bench.rays.seen_y(0, 0)), 9.875 * 299.0 / 300.0, 1e-5);
  EXPECT_NEAR(static_cast<double>(bench.rays.seen_z(0, 0)), 1.0, 1e-6);
}

TEST(CornerRays, CornersAreTheRaysThroughTheCornersOfThePixels) {
  const CornerBench bench(small_strip(), kCornerCamera);
  for (int y = 0; y <= 80; y += 16) {
    for (int x = 0; x <= 120; x += 12) {
      const EscapePacket traced = bench.trace_at({x, y});
      const auto i = static_cast<std::size_t>(y * 121 + x);
      EXPECT_EQ(bench.rays.corners.origin_x[i], static_cast<float>(traced.origin_x[0]));
      EXPECT_EQ(bench.rays.corners.direction_y[i], static_cast<float>(traced.direction_y[0]));
      EXPECT_EQ(bench.rays.corners.weight[i], traced.weight[0]);
    }
  }
}

TEST(CornerRays, AStripWithoutDefectsNeedsNoRefinement) {
  const CornerBench bench(small_strip(), kCornerCamera);
  EXPECT_EQ(bench.count(PixelKind::kSmooth), bench.rays.num_pixels());
}

// Without the projected reach the dents of 0.1 and 0.2 px sigma could lie between all corners.
TEST(CornerRays, EveryDentIsRefinedHoweverSmall) {
  const std::vector<HeightFeature> dents = some_dents(small_strip());
  const CornerBench bench(small_strip(), kCornerCamera, dents);
  for (const HeightFeature& dent : dents) {
    const Vector2d pixel = *bench.camera.project(bench.camera_from_world * dent.centre_mm);
    EXPECT_EQ(bench.rays.kind(static_cast<int>(pixel.x()), static_cast<int>(pixel.y())),
              PixelKind::kRefined)
        << dent.id;
  }
  EXPECT_LT(bench.count(PixelKind::kRefined), 1200);
  EXPECT_EQ(bench.count(PixelKind::kDark), 0);
}

TEST(CornerRays, SmoothPixelsAreWhatTheirCornersSayToTheStatedAngle) {
  const CornerBench bench(small_strip(), kCornerCamera, some_dents(small_strip()));
  Rng rng(31, Stream::kTest, 0);
  int checked = 0;
  double worst_rad = 0.0;
  for (int i = 0; i < 6000; ++i) {
    const int x = static_cast<int>(rng.uniform(0, 120));
    const int y = static_cast<int>(rng.uniform(0, 80));
    const Vector2d at(rng.uniform(), rng.uniform());
    if (bench.rays.kind(x, y) != PixelKind::kSmooth) {
      continue;
    }
    const auto first = static_cast<std::size_t>(y * 121 + x);
    const CellError error = error_in_cell(bench,
                                          bench.rays.corners,
                                          {first, first + 1, first + 121, first + 122},
                                          Vector2d(x, y),
                                          1.0,
                                          at);
    worst_rad = std::max(worst_rad, error.direction_rad);
    ASSERT_LT(error.origin_mm, 1e-3);
    ++checked;
  }
  EXPECT_GE(checked, 1000);
  EXPECT_LE(worst_rad, bench.render.max_direction_error_rad);
}

TEST(CornerRays, SmoothCellsOfRefinedPixelsAreWhatTheirCornersSayToTheStatedAngle) {
  const CornerBench bench(small_strip(), kCornerCamera, some_dents(small_strip()));
  Rng rng(32, Stream::kTest, 0);
  int checked = 0;
  int above = 0;
  double worst_rad = 0.0;
  for (const RefinedGroup& group : bench.rays.refined) {
    const int n = group.cells_per_axis;
    for (std::size_t p = 0; p < group.pixels.size(); ++p) {
      const Vector2d pixel(group.pixels[p] % 120, group.pixels[p] / 120);
      for (int k = 0; k < 6; ++k) {
        const int x = static_cast<int>(rng.uniform(0, n));
        const int y = static_cast<int>(rng.uniform(0, n));
        const Vector2d at(rng.uniform(), rng.uniform());
        const std::size_t cell =
            p * static_cast<std::size_t>(n * n) + static_cast<std::size_t>(y * n + x);
        if (group.is_smooth[cell] == 0) {
          continue;
        }
        const auto columns = static_cast<std::size_t>(n + 1);
        const std::size_t first = p * columns * columns + static_cast<std::size_t>(y) * columns +
                                  static_cast<std::size_t>(x);
        const CellError error =
            error_in_cell(bench,
                          group.rays,
                          {first, first + 1, first + columns, first + columns + 1},
                          pixel + Vector2d(x, y) / n,
                          1.0 / n,
                          at);
        worst_rad = std::max(worst_rad, error.direction_rad);
        above += error.direction_rad > bench.render.max_direction_error_rad ? 1 : 0;
        ++checked;
      }
    }
  }
  EXPECT_GE(checked, 1000);
  // The error is estimated from the corners, not bounded: one in a thousand may be a little above.
  EXPECT_LE(above, checked / 1000);
  EXPECT_LE(worst_rad, 1.5 * bench.render.max_direction_error_rad);
}

TEST(CornerRays, SilhouettesAreRefined) {
  const CornerBench bench(askew_plate(), kCornerCamera);
  EXPECT_GT(bench.count(PixelKind::kRefined), 150);  // outline 64 mm = 256 px and more
  EXPECT_GT(bench.count(PixelKind::kDark), 1000);
  EXPECT_GT(bench.count(PixelKind::kSmooth), 3000);
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 120; ++x) {
      const float coverage = bench.rays.coverage(x, y);
      const PixelKind kind = bench.rays.kind(x, y);
      ASSERT_EQ(kind == PixelKind::kDark, coverage == 0.0F);
      ASSERT_TRUE(kind != PixelKind::kSmooth || coverage == 1.0F);
      ASSERT_TRUE(kind == PixelKind::kRefined || coverage == 0.0F || coverage == 1.0F);
    }
  }
}

TEST(CornerRays, CoverageOfSilhouettesIsThatOfManySamples) {
  const CornerBench bench(askew_plate(), kCornerCamera);
  ThreadPool pool(1);
  const RayCache sampled = trace_rays(bench.part,
                                      bench.bvh,
                                      bench.detail,
                                      bench.camera,
                                      bench.camera_from_world,
                                      {.rays_per_axis = 16},
                                      pool);
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 120; ++x) {
      ASSERT_NEAR(bench.rays.coverage(x, y), sampled.coverage(x, y), 0.02) << x << " " << y;
      if (bench.rays.coverage(x, y) > 0.2F) {
        ASSERT_NEAR(bench.rays.seen_x(x, y), sampled.seen_x(x, y), 0.02);
        ASSERT_NEAR(bench.rays.seen_y(x, y), sampled.seen_y(x, y), 0.02);
      }
    }
  }
}

TEST(CornerRays, CountsAreThoseOfAllKeptRays) {
  const CornerBench bench(askew_plate(), kCornerCamera, some_dents(askew_plate()));
  std::int64_t rays = static_cast<std::int64_t>(bench.rays.corners.weight.size());
  std::int64_t lit =
      std::ranges::count_if(bench.rays.corners.weight, [](float w) { return w > 0; });
  for (const RefinedGroup& group : bench.rays.refined) {
    const std::size_t n = static_cast<std::size_t>(group.cells_per_axis);
    EXPECT_EQ(group.rays.weight.size(), group.pixels.size() * (n + 1) * (n + 1));
    EXPECT_EQ(group.is_smooth.size(), group.pixels.size() * n * n);
    EXPECT_TRUE(std::ranges::is_sorted(group.pixels));
    EXPECT_FALSE(group.pixels.empty());
    rays += static_cast<std::int64_t>(group.rays.weight.size());
    lit += std::ranges::count_if(group.rays.weight, [](float w) { return w > 0; });
  }
  EXPECT_EQ(bench.rays.counts.camera, rays);
  EXPECT_EQ(bench.rays.counts.part - bench.rays.counts.blocked, lit);
}

// 100 x 100 mm seen with 0.5 px pixels of 2 mm: the part's corner covers a part of one pixel and
// no corner of it.
TEST(CornerRays, ACornerOfThePartBetweenTheRaysIsFound) {
  PartSettings plate = askew_plate();
  plate.rotation_rad = {0.0, 0.0, 45.0 * kRadPerDeg};
  // The plate's lowest corner: (20 - 12) / 2 sqrt(2) right, -(20 + 12) / 2 sqrt(2) down.
  const double low_mm = -32.0 / (2.0 * std::sqrt(2.0));
  const double right_mm = -8.0 / (2.0 * std::sqrt(2.0));
  // It lands 0.3 pixels below the upper edge of a pixel, in its middle; the top face is 1 mm up.
  const double scale = 300.0 / 299.0;
  plate.position_mm = {0.125 / scale - right_mm, (-8.0 - 0.3 * 0.25) / scale - low_mm, 0.0};
  const CornerBench bench(plate, kCornerCamera);
  // A right angle upright, 0.3 px high: 0.3^2 = 0.09 of the pixel.
  EXPECT_NEAR(bench.rays.coverage(60, 72), 0.09F, 0.02F);
  EXPECT_EQ(bench.rays.kind(60, 72), PixelKind::kRefined);
  EXPECT_EQ(bench.rays.kind(60, 73), PixelKind::kDark);
}

TEST(CornerRays, AreTheSameBytesForOneTwoAndSevenThreads) {
  const tbb::global_control seven(tbb::global_control::max_allowed_parallelism, 7);
  const std::vector<HeightFeature> dents = some_dents(askew_plate());
  const CornerBench one(askew_plate(), kCornerCamera, dents, 1);
  for (const int threads : {2, 7}) {
    const CornerBench more(askew_plate(), kCornerCamera, dents, threads);
    EXPECT_TRUE(same_bytes(one.rays, more.rays)) << threads;
  }
}

TEST(CornerRays, ASmallerAllowedErrorTakesMoreCells) {
  const std::vector<HeightFeature> dents = some_dents(small_strip());
  std::int64_t before = 0;
  for (const double error_rad : {2e-3, 2e-4, 2e-5}) {
    const CornerBench bench(
        small_strip(), kCornerCamera, dents, 1, {.max_direction_error_rad = error_rad});
    EXPECT_GT(bench.rays.counts.camera, before) << error_rad;
    before = bench.rays.counts.camera;
  }
}

TEST(CornerRays, TeethOfAGearAreRefinedWhereTheyReflectEachOther) {
  PartSettings gear;
  gear.shape = PartSettings::Shape::kSpurGear;
  const CornerBench bench(
      gear,
      {.width_px = 80, .height_px = 60, .object_pixel_mm = 0.4, .working_distance_mm = 300.0},
      {},
      1,
      {.max_bounces = 8});
  EXPECT_GT(bench.rays.counts.followed, 0);
  for (int y = 0; y < 60; ++y) {
    for (int x = 0; x < 80; ++x) {
      const EscapePacket middle = bench.trace_at({x + 0.5, y + 0.5});
      if (middle.path[0] == RayPath::kFollowed) {
        EXPECT_NE(bench.rays.kind(x, y), PixelKind::kDark);
      }
    }
  }
}

TEST(CornerRays, APartOutsideTheImageIsAnError) {
  PartSettings away = test::plate();
  away.position_mm = {500.0, 0.0, 0.0};
  EXPECT_THAT([&] { const CornerBench bench(away, kCornerCamera); },
              ::testing::ThrowsMessage<ConfigError>(
                  ::testing::StartsWith("camera: the part is outside the image")));
}

TEST(CornerRays, RaysThatDoNotFitIntoMemoryAreRefused) {
  EXPECT_THAT([] { const CornerBench bench(test::plate(), test::far_camera(200000, 200000, 0.1)); },
              ::testing::ThrowsMessage<ConfigError>(::testing::StartsWith("camera.width_px: ")));
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/corner_rays/sparse_rays.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "simulator/render/corner_rays/sparse_kernels.h"
#include "simulator/render/footprint/footprints.h"
#include "simulator/render/wall/sparse_intersection.h"
#include "tests/simulator/render/footprint/footprint_fixtures.h"

namespace glint {
namespace {

using Shape = TunnelSettings::Shape;

TunnelSettings random_wall(Rng& rng) {
  TunnelSettings s = test::bench_tunnel();
  s.shape = static_cast<Shape>(static_cast<int>(rng.uniform(0.0, 4.999)));
  s.base_mm = rng.uniform(-20.0, 5.0);
  s.radius_mm = rng.uniform(60.0, 250.0);
  s.half_width_mm = rng.uniform(60.0, 200.0);
  s.height_mm = rng.uniform(60.0, 250.0);
  s.exponent = rng.uniform(1.5, 8.0);
  s.distance_mm = rng.uniform(20.0, 60.0);
  s.opening_rad = rng.uniform(0.0, 2.0);
  s.panel_height_mm = rng.uniform(100.0, 400.0);
  s.control_mm.clear();
  for (int i = 0; i < 5; ++i) {
    s.control_mm.push_back(rng.uniform(90.0, 200.0));
  }
  if (rng.uniform() < 0.2) {
    s.orientation_rad = rng.uniform(-0.8, 0.8);
  }
  return s;
}

/// In units of what a pixel sees of the wall (0.25 mm at least).
struct HitErrors {
  double along = 0.0;   ///< worst of x and the stripes' coordinate
  double across = 0.0;  ///< worst of y, and of the margin where a share of it is not smaller
  int above = 0;        ///< along: twice what the tiles' checks allow
  int compared = 0;
};

/// Of lit rays; the footprint is what the neighbours to the right and below see, at the picture's
/// end those on the other side.
HitErrors compare_hits(const CornerRays& rays, const WallHits& exact, const WallHits& sparse) {
  HitErrors errors;
  const auto width = static_cast<std::size_t>(rays.corners.width_px);
  const std::size_t count = rays.corners.weight.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (rays.corners.weight[i] == 0.0F || exact.margin_mm[i] == kNoHitMargin_mm) {
      continue;
    }
    const auto difference =
        [](const FloatArray& a, std::size_t p, const FloatArray& b, std::size_t q) {
          return std::abs(static_cast<double>(a[p]) - static_cast<double>(b[q]));
        };
    const std::size_t beside = i % width + 1 < width ? i + 1 : i - 1;
    const std::size_t below = i + width < count ? i + width : i - width;
    const auto error = [&](const FloatArray& a, const FloatArray& b) {
      const double footprint_mm =
          std::max({0.25, difference(a, i, a, beside), difference(a, i, a, below)});
      return difference(a, i, b, i) / footprint_mm;
    };
    constexpr double kAllowed = 0.01;
    const double along =
        std::max(error(exact.x_mm, sparse.x_mm), error(exact.stripes_mm(), sparse.stripes_mm()));
    errors.along = std::max(errors.along, along);
    errors.above += along > 2.0 * kAllowed ? 1 : 0;
    // Far from the rim only the margin's sign matters.
    constexpr double kOfMargin = 30.0;
    const double of_margin = kOfMargin * difference(exact.margin_mm, i, sparse.margin_mm, i) /
                             std::abs(static_cast<double>(exact.margin_mm[i]));
    const double margin = std::min(error(exact.margin_mm, sparse.margin_mm), of_margin);
    errors.across = std::max({errors.across, error(exact.y_mm, sparse.y_mm), margin});
    ++errors.compared;
  }
  return errors;
}

/// Pixels as fine as the tiles want them on so small a radius.
CameraSettings sparse_camera() {
  return {.width_px = 400, .height_px = 200, .object_pixel_mm = 0.12, .working_distance_mm = 300.0};
}

const test::FootprintBench& sparse_bench() {
  static const test::FootprintBench bench(test::bench_strip(), sparse_camera(), 0.6);
  return bench;
}

/// Compares the hits on random tunnels. @return the mean share of tiles that are met by their nodes
double compare_tunnels(const CornerRays& rays, int trials) {
  Rng rng(11, Stream::kTest, 0);
  std::int64_t above = 0;
  std::int64_t compared = 0;
  double known = 0.0;
  for (int trial = 0; trial < trials; ++trial) {
    const Tunnel tunnel(random_wall(rng));
    TileLimits limits;
    const WallHits sparse = intersect_sparse(rays.sparse, rays.corners, tunnel, limits);
    const HitErrors errors = compare_hits(rays, intersect_light(rays.corners, tunnel), sparse);
    EXPECT_GT(errors.compared, 10000);
    EXPECT_LT(errors.along, 0.08) << trial << " " << shape_name(tunnel.settings().shape);
    EXPECT_LT(errors.across, 0.3) << trial << " " << shape_name(tunnel.settings().shape);
    above += errors.above;
    compared += errors.compared;
    known += static_cast<double>(std::ranges::count(limits.kind, TileLimits::kKnown)) /
             static_cast<double>(limits.kind.size());
  }
  EXPECT_LT(static_cast<double>(above), 1e-3 * static_cast<double>(compared));
  return known / trials;
}

TEST(SparseRays, MeetTwoHundredTunnelsWhereAllRaysDo) {
  EXPECT_GT(compare_tunnels(sparse_bench().rays, 200), 0.4) << "most would be met ray by ray";
}

// 251 x 71 corners: the last tiles have 3 columns and 7 rows of rays.
TEST(SparseRays, MeetTheLastRowsAndColumnsOfAFullPicture) {
  const test::FootprintBench full(
      test::bench_strip(),
      {.width_px = 250, .height_px = 70, .object_pixel_mm = 0.12, .working_distance_mm = 300.0});
  const SparseRays& sparse = full.rays.sparse;
  ASSERT_EQ(sparse.columns, 32);
  ASSERT_EQ(sparse.rows, 9);
  EXPECT_TRUE(sparse.dark_stretches.empty());
  EXPECT_EQ(sparse.rest.count(), 0);
  EXPECT_GT(compare_tunnels(full.rays, 100), 0.5) << "most would be met ray by ray";
}

// Where nodes beyond the outline go on well enough, lit rays of the tiles that it crosses are met
// by nodes, too.
TEST(SparseRays, GoOnToThePartsOutline) {
  const test::FootprintBench flawless(test::bench_strip(), sparse_camera());
  const RayCache& corners = flawless.rays.corners;
  const SparseRays& sparse = flawless.rays.sparse;
  std::vector<int> lit(sparse.kind.size()), dark(sparse.kind.size());
  for (int y = 0; y < corners.height_px; ++y) {
    for (int x = 0; x < corners.width_px; ++x) {
      const auto tile = static_cast<std::size_t>(y / 8 * sparse.columns + x / 8);
      const auto ray = static_cast<std::size_t>(y * corners.width_px + x);
      ++(corners.weight[ray] > 0.0F ? lit : dark)[tile];
    }
  }
  int at_outline = 0;
  for (std::size_t i = 0; i < lit.size(); ++i) {
    at_outline += dark[i] > 0 ? lit[i] : 0;
    EXPECT_EQ(sparse.kind[i] == TileKind::kNone, lit[i] == 0);
  }
  TileLimits limits;
  intersect_sparse(sparse, corners, Tunnel(test::bench_tunnel()), limits);
  int smooth = 0, known = 0;
  for (std::size_t i = 0; i < lit.size(); ++i) {
    const bool is_smooth_at_outline = dark[i] > 0 && sparse.kind[i] == TileKind::kSmooth;
    smooth += is_smooth_at_outline ? 1 : 0;
    known += is_smooth_at_outline && limits.kind[i] == TileLimits::kKnown ? 1 : 0;
  }
  EXPECT_GT(smooth, 20);
  EXPECT_GT(known, 0.8 * smooth);
  EXPECT_GT(at_outline, 3000);
  EXPECT_LT(sparse.rest.count(), 0.85 * at_outline);
}

TEST(SparseRays, DarkRaysMeetNothing) {
  const CornerRays& rays = sparse_bench().rays;
  TileLimits limits;
  const WallHits hits =
      intersect_sparse(rays.sparse, rays.corners, Tunnel(test::bench_tunnel()), limits);
  int dark = 0;
  for (std::size_t i = 0; i < rays.corners.weight.size(); ++i) {
    if (rays.corners.weight[i] == 0.0F) {
      ASSERT_EQ(hits.margin_mm[i], kNoHitMargin_mm) << i;
      ++dark;
    }
  }
  EXPECT_GT(dark, 1000);
}

TEST(SparseRays, FindTheDentBent) {
  const auto bent = [](const CornerRays& rays) {
    return std::ranges::count(rays.sparse.kind, TileKind::kBent);
  };
  const test::FootprintBench flawless(test::bench_strip(), sparse_camera());
  EXPECT_GT(bent(sparse_bench().rays), bent(flawless.rays));
}

TEST(SparseRays, FindASingleRayOutOfLine) {
  const CornerRays& rays = sparse_bench().rays;
  const int tiles = rays.sparse.columns;
  const auto ray_of = [&](int tile) {
    return (tile / tiles * 8 + 5) * rays.corners.width_px + tile % tiles * 8 + 3;
  };
  const auto is_wanted = [&](int tile) {
    return rays.sparse.kind[static_cast<std::size_t>(tile)] == TileKind::kSmooth &&
           rays.corners.weight[static_cast<std::size_t>(ray_of(tile))] > 0.0F;
  };
  int tile = 0;
  while (!is_wanted(tile)) {
    ++tile;
  }
  const int ray = ray_of(tile);
  constexpr double kLargestError_rad = 2e-6;
  const auto kind_with = [&](float error) {
    RayCache bent = rays.corners;
    bent.direction_x[static_cast<std::size_t>(ray)] += error;
    return sparse_rays(bent, kLargestError_rad).kind[static_cast<std::size_t>(tile)];
  };
  EXPECT_EQ(kind_with(0.0F), TileKind::kSmooth);
  EXPECT_EQ(kind_with(5e-6F), TileKind::kBent);
}

TEST(SparseRays, KnowWhereTheHitsOfATileLie) {
  const CornerRays& rays = sparse_bench().rays;
  Rng rng(12, Stream::kTest, 0);
  int tiles = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const Tunnel tunnel(random_wall(rng));
    TileLimits limits;
    const WallHits hits = intersect_sparse(rays.sparse, rays.corners, tunnel, limits);
    for (int i = 0; i < limits.columns * limits.rows; ++i) {
      const auto tile = static_cast<std::size_t>(i);
      if (limits.kind[tile] != TileLimits::kKnown) {
        continue;
      }
      ++tiles;
      constexpr float kRounding = 1e-3F;
      for (int ray = 0; ray < 64; ++ray) {
        const int x = i % limits.columns * 8 + ray % 8;
        const int y = i / limits.columns * 8 + ray / 8;
        if (x >= rays.corners.width_px || y >= rays.corners.height_px) {
          continue;
        }
        const auto at =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(rays.corners.width_px) +
            static_cast<std::size_t>(x);
        if (rays.corners.weight[at] == 0.0F) {
          continue;
        }
        ASSERT_GE(hits.x_mm[at], limits.x_low_mm[tile] - kRounding);
        ASSERT_LE(hits.x_mm[at], limits.x_high_mm[tile] + kRounding);
        ASSERT_GE(hits.y_mm[at], limits.y_low_mm[tile] - kRounding);
        ASSERT_LE(hits.y_mm[at], limits.y_high_mm[tile] + kRounding);
        ASSERT_GE(hits.margin_mm[at], limits.margin_low_mm[tile] - kRounding);
        ASSERT_LE(hits.margin_mm[at], limits.margin_high_mm[tile] + kRounding);
      }
    }
  }
  EXPECT_GT(tiles, 5000);
}

TEST(SparseRays, LeaveThePixelsStatesAsTheyAre) {
  const CornerRays& rays = sparse_bench().rays;
  Rng rng(13, Stream::kTest, 0);
  std::size_t different = 0;
  for (int trial = 0; trial < 100; ++trial) {
    TunnelSettings wall = random_wall(rng);
    wall.length_mm = rng.uniform() < 0.5 ? rng.uniform(20.0, 200.0) : wall.length_mm;
    wall.period_mm = rng.uniform() < 0.5 ? rng.uniform(0.2, 2.0) : wall.period_mm;
    const Tunnel tunnel(wall);
    const Footprints tiled(rays, tunnel, ScanSettings{}, sparse_bench().camera_mm);
    const auto view = std::make_shared<WallView>(rays, tunnel, sparse_bench().camera_mm);
    view->limits = {};
    const Footprints plain(rays, tunnel, ScanSettings{}, view);
    for (std::size_t i = 0; i < tiled.state().size(); ++i) {
      different += tiled.state().values()[i] != plain.state().values()[i] ? 1U : 0U;
    }
  }
  EXPECT_EQ(different, 0U);
}

TEST(SparseRays, AreNoneForPicturesOfFewPixels) {
  RayCache few;
  few.width_px = 20;
  few.height_px = 20;
  few.samples = 1;
  EXPECT_TRUE(sparse_rays(few, 1e-6).is_empty());
}

TEST(NodeWeights, TakeQuinticsAsTheyAre) {
  // f(u) = u^5 - u^2 + 3 at u = -2 ... 3: -33, 1, 3, 3, 31, 237. At u = 5 / 8: 2.704742.
  const sparse_kernels::NodeWeights w = sparse_kernels::node_weights(5);
  const float value =
      w[0] * -33.0F + w[1] * 1.0F + w[2] * 3.0F + w[3] * 3.0F + w[4] * 31.0F + w[5] * 237.0F;
  EXPECT_NEAR(value, 2.704742F, 1e-5F);
}

}  // namespace
}  // namespace glint

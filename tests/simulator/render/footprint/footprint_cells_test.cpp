// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/footprint/footprint_cells.h"

#include <algorithm>
#include <map>

#include <gtest/gtest.h>

#include "simulator/render/footprint/cell_sum.h"
#include "tests/simulator/render/footprint/footprint_fixtures.h"

namespace glint {
namespace {

const test::FootprintBench& cells_bench() {
  static const test::FootprintBench bench(test::bench_strip(), test::bench_camera(), 0.4);
  return bench;
}

using Radiances = std::vector<double>;

/// Radiance of all refined pixels, cell by cell.
std::map<std::int32_t, Radiances> refined_one_by_one(const Footprints& footprints) {
  std::map<std::int32_t, Radiances> found;
  for (const RefinedGroup& group : footprints.rays().refined) {
    const WallHits hits = intersect_light(group.rays, footprints.tunnel());
    const float* weight = group.rays.weight.data();
    const auto n = static_cast<std::size_t>(group.cells_per_axis);
    const double share = 1.0 / static_cast<double>(n * n);
    CellSum sum(footprints.positions());
    for (std::size_t i = 0; i < group.pixels.size(); ++i) {
      sum.clear();
      for (std::size_t cell = 0; cell < n * n; ++cell) {
        const std::size_t a = i * (n + 1) * (n + 1) + cell / n * (n + 1) + cell % n;
        const CellCorners corners(hits, weight, {a, a + 1, a + n + 1, a + n + 2});
        if (group.is_smooth[i * n * n + cell] != 0) {
          sum.add_smooth(corners, share);
          continue;
        }
        for (std::size_t k = 0; k < 4; ++k) {
          sum.add_place(corners.x_mm[k],
                        corners.stripes_mm[k],
                        corners.y_mm[k],
                        corners.margin_mm[k],
                        0.25 * share * corners.gain[k]);
        }
      }
      found[group.pixels[i]] = sum.radiance();
    }
  }
  return found;
}

/// The same of a pixel that is not refined, by polygons.
Radiances by_polygons(const Footprints& footprints, std::int32_t pixel) {
  const CornerRays& rays = footprints.rays();
  const auto width = static_cast<std::size_t>(rays.width_px) + 1;
  const auto row = static_cast<std::size_t>(pixel / rays.width_px);
  const std::size_t at = row * width + static_cast<std::size_t>(pixel % rays.width_px);
  CellSum sum(footprints.positions());
  sum.clear();
  sum.add_smooth(
      CellCorners(
          footprints.hits(), rays.corners.weight.data(), {at, at + 1, at + width, at + width + 1}),
      1.0);
  return sum.radiance();
}

struct CellCounts {
  int refined = 0;
  int others = 0;
};

/// All pixels of a scan that are summed from cells, against the long way.
CellCounts check_cells(const TunnelSettings& settings) {
  const test::FootprintBench& bench = cells_bench();
  const Tunnel tunnel(settings);
  const Footprints footprints(bench.rays, tunnel, {.positions = 6}, bench.camera_mm);
  const Spans all = whole_image(bench.rays.width_px, bench.rays.height_px);
  const PixelCells cells = sum_cells(footprints, all);
  const auto refined = refined_one_by_one(footprints);
  CellCounts counts;
  for (std::size_t i = 0; i < cells.pixels.size(); ++i) {
    const auto by_cells = refined.find(cells.pixels[i]);
    const bool is_refined = by_cells != refined.end();
    const Radiances wanted =
        is_refined ? by_cells->second : by_polygons(footprints, cells.pixels[i]);
    for (std::size_t k = 0; k < wanted.size(); ++k) {
      // A narrow cell under even light may be a trapezoid in float on one side only.
      EXPECT_NEAR(static_cast<double>(cells.values[i * wanted.size() + k]), wanted[k], 1e-4)
          << shape_name(settings.shape) << ", pixel " << cells.pixels[i];
    }
    (is_refined ? counts.refined : counts.others) += 1;
  }
  return counts;
}

TEST(SumCells, IsWhatCellsOneByOneGive) {
  using Shape = TunnelSettings::Shape;
  for (const Shape shape : {Shape::kSemicylinder, Shape::kFlat, Shape::kSuperellipse}) {
    TunnelSettings settings = test::bench_tunnel();
    settings.shape = shape;
    settings.half_width_mm = settings.height_mm = 100.0;
    settings.distance_mm = 30.0;
    settings.panel_height_mm = 60.0;
    const CellCounts counts = check_cells(settings);
    EXPECT_GT(counts.refined, 500);
    EXPECT_GT(counts.others, 100);
  }
}

TEST(SumCells, IsThatUnderAnyLight) {
  TunnelSettings oblique = test::bench_tunnel();
  oblique.orientation_rad = 0.4;
  oblique.cosine_law = true;
  check_cells(oblique);
  TunnelSettings uneven = test::bench_tunnel();
  uneven.led_ripple = 0.1;
  uneven.end_falloff = 0.2;
  check_cells(uneven);
  TunnelSettings fine = test::bench_tunnel();
  fine.period_mm = 0.2;
  check_cells(fine);
  TunnelSettings ends = test::bench_tunnel();
  ends.length_mm = 70.0;
  EXPECT_GT(check_cells(ends).others, 100);
}

// Floors against all frames: one position of many times the frequency.
TEST(MeanOfCells, IsTheMeanOfAllPositions) {
  const test::FootprintBench& bench = cells_bench();
  TunnelSettings settings = test::bench_tunnel();
  settings.duty = 0.37;
  const Tunnel tunnel(settings);
  const Footprints footprints(bench.rays, tunnel, {.positions = 6}, bench.camera_mm);
  const Spans all = whole_image(bench.rays.width_px, bench.rays.height_px);
  const PixelCells cells = sum_cells(footprints, all);
  std::map<std::int32_t, double> means;
  for (std::size_t i = 0; i < cells.pixels.size(); ++i) {
    for (std::size_t k = 0; k < 6; ++k) {
      means[cells.pixels[i]] += static_cast<double>(cells.values[6 * i + k]) / 6.0;
    }
  }
  const PixelCells mean = mean_of_cells(footprints, all, all);
  ASSERT_EQ(mean.pixels.size(), means.size());
  for (std::size_t i = 0; i < mean.pixels.size(); ++i) {
    EXPECT_NEAR(static_cast<double>(mean.values[i]), means[mean.pixels[i]], 1e-4);
  }
  // Far from where the mean is wanted the outline may be its coverage times what it sees.
  const PixelCells far = mean_of_cells(footprints, all, {});
  ASSERT_EQ(far.pixels.size(), means.size());
  double error = 0.0;
  for (std::size_t i = 0; i < far.pixels.size(); ++i) {
    error += std::abs(static_cast<double>(far.values[i]) - means[far.pixels[i]]);
  }
  error /= static_cast<double>(far.pixels.size());
  EXPECT_GT(error, 1e-4);
  EXPECT_LT(error, 0.03);
}

}  // namespace
}  // namespace glint

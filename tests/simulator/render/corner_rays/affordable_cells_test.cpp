// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/corner_rays/affordable_cells.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "simulator/render/corner_rays/planned_rays.h"
#include "tests/simulator/render/corner_rays/corner_bench.h"

namespace glint {
namespace {

using test::CornerBench;
using test::dent_at;
using test::same_bytes;

constexpr CameraSettings kCamera = {
    .width_px = 100, .height_px = 80, .object_pixel_mm = 0.25, .working_distance_mm = 300.0};

/// A sheet with waves 0.1 mm high and 2.5 mm long, and facets of 0.5 mm: two pixels. Smoothed
/// normals turn by up to 14 degrees between waves, with a kink at every edge.
PartSettings bumpy_sheet() {
  constexpr int kSide = 60;
  constexpr double kStep_mm = 0.5;
  const auto file = std::filesystem::temp_directory_path() /
                    fmt::format("glint_bumpy_{}.obj", static_cast<int>(::getpid()));
  std::ofstream out(file);
  const double edge_mm = 0.5 * kSide * kStep_mm;
  for (int j = 0; j <= kSide; ++j) {
    for (int i = 0; i <= kSide; ++i) {
      const double x_mm = i * kStep_mm - edge_mm;
      const double y_mm = j * kStep_mm - edge_mm;
      out << fmt::format(
          "v {} {} {}\n", x_mm, y_mm, 0.1 * std::sin(2.5 * x_mm) * std::cos(2.5 * y_mm));
    }
  }
  const auto at = [](int i, int j) { return j * (kSide + 1) + i + 1; };
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      out << fmt::format("f {} {} {}\nf {} {} {}\n",
                         at(i, j),
                         at(i + 1, j),
                         at(i + 1, j + 1),
                         at(i, j),
                         at(i + 1, j + 1),
                         at(i, j + 1));
    }
  }
  return {.shape = PartSettings::Shape::kMesh, .file = file};
}

struct Bumpy {
  CornerBench bench;
  ThreadPool pool{2};

  Bumpy() : Bumpy(bumpy_sheet()) {}

  explicit Bumpy(const PartSettings& sheet) : bench(sheet, kCamera) {
    std::filesystem::remove(sheet.file);
  }

  PlacedCamera placed() const { return {bench.camera, bench.camera_from_world}; }

  int affordable(std::int64_t max_rays) {
    const RefinementNeed need(bench.camera, bench.camera_from_world, bench.part, {});
    return affordable_cells(bench.part, bench.bvh, placed(), need, bench.render, pool, max_rays);
  }

  CornerRays trace(int max_cells, const SurfaceDetail& detail = {}) {
    const TraceScene scene(bench.part, bench.bvh, detail, bench.render);
    const RefinementNeed need(bench.camera, bench.camera_from_world, bench.part, detail);
    return trace_planned(scene, placed(), need, UpdatePlan(), nullptr, max_cells, pool).rays;
  }
};

std::int64_t refined_rays(const CornerRays& rays) {
  std::int64_t count = 0;
  for (const RefinedGroup& group : rays.refined) {
    count += static_cast<std::int64_t>(group.rays.weight.size());
  }
  return count;
}

TEST(AffordableCells, AreSixteenWhereThePictureIsSmallOrThePartExact) {
  Bumpy bumpy;
  EXPECT_EQ(max_cells_of(bumpy.bench.rays), 16);
  EXPECT_EQ(bumpy.affordable(kMaxRefinedRays), 16);
  const CornerBench strip(test::small_strip(), kCamera);
  EXPECT_EQ(affordable_cells(strip.part,
                             strip.bvh,
                             {strip.camera, strip.camera_from_world},
                             {strip.camera, strip.camera_from_world, strip.part, {}},
                             strip.render,
                             bumpy.pool,
                             1000),
            16);
  EXPECT_EQ(max_cells_of(strip.rays), 16);
}

// The estimate from a few rows keeps within the limit to a tenth, and the next number of cells
// would not: one too small would cost accuracy for nothing.
TEST(AffordableCells, KeepTheRaysOfABumpyMeshWithinTheLimit) {
  Bumpy bumpy;
  const auto all = static_cast<double>(refined_rays(bumpy.bench.rays));
  ASSERT_GT(all, 1e6);
  const auto by_four = static_cast<double>(refined_rays(bumpy.trace(4)));
  const auto by_two = static_cast<double>(refined_rays(bumpy.trace(2)));
  EXPECT_EQ(bumpy.affordable(static_cast<std::int64_t>(1.1 * all)), 16);
  EXPECT_EQ(bumpy.affordable(static_cast<std::int64_t>(0.9 * all)), 4);
  EXPECT_EQ(bumpy.affordable(static_cast<std::int64_t>(1.1 * by_four)), 4);
  EXPECT_EQ(bumpy.affordable(static_cast<std::int64_t>(0.9 * by_four)), 2);
  EXPECT_LT(10.0 * by_four, all);
  EXPECT_LT(2.0 * by_two, by_four);
}

TEST(AffordableCells, LeaveThePixelsOfDefectsAsFineAsTheyWere) {
  Bumpy bumpy;
  const SurfaceDetail detail({dent_at(bumpy.bench.part, bumpy.bench.bvh, 3.0, 2.0, 0.2)});
  const CornerRays coarse = bumpy.trace(2, detail);
  const auto pixels_of = [](const CornerRays& rays, int cells) {
    const auto group = std::ranges::find(rays.refined, cells, &RefinedGroup::cells_per_axis);
    return group == rays.refined.end() ? std::size_t{0} : group->pixels.size();
  };
  EXPECT_EQ(pixels_of(bumpy.trace(2), 16), 0U);
  EXPECT_GT(pixels_of(coarse, 16), 20U);
}

// A dent must not change how the rest is cut.
TEST(AffordableCells, AreTheSameForRaysThatAreTracedAgain) {
  Bumpy bumpy;
  const SurfaceDetail detail({dent_at(bumpy.bench.part, bumpy.bench.bvh, 3.0, 2.0, 0.2)});
  const CornerRays without = bumpy.trace(4);
  EXPECT_EQ(max_cells_of(without), 4);
  const RetracedRays retraced = retrace_detail(without,
                                               bumpy.bench.part,
                                               bumpy.bench.bvh,
                                               detail,
                                               {bumpy.bench.camera, bumpy.bench.camera_from_world},
                                               bumpy.bench.render,
                                               bumpy.pool);
  EXPECT_EQ(max_cells_of(retraced.rays), 4);
  EXPECT_TRUE(same_bytes(bumpy.trace(4, detail), retraced.rays));
}

}  // namespace
}  // namespace glint

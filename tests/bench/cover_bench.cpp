// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `glint cover` takes for a ray from the surface to a camera, one thread, against Embree alone
// on the very same rays: all packets of twelve views are taken down and asked again by the same
// call. Both take turns; medians of CPU time. Rows: a gear of 169,000 triangles, and the sphere.
//
// of_embree is our time for a ray in units of Embree's; at most 3 is wanted. Cells that are turned
// away or beside the picture need no ray, but their time is in ours.
#include <algorithm>
#include <ctime>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/median.h"
#include "simulator/camera/viewpoint_set.h"
#include "studies/coverage/view_cells.h"
#include "tests/bench/embree_recorder.h"
#include "tests/bench/gear_scene.h"

namespace glint::bench {
namespace {

constexpr int kRounds = 9;
constexpr int kViews = 12;
constexpr int kCells = 200'000;

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

Part gear_part() {
  Part part;
  part.mesh = make_gear_mesh();
  smooth_normals(part.mesh, 30.0 * kRadPerDeg);
  return part;
}

Part sphere_part() {
  return build_part(
      {.shape = PartSettings::Shape::kSphereCap, .radius_mm = 36.0, .height_mm = 72.0});
}

/// A part, and cameras all around it.
class Subject {
 public:
  explicit Subject(Part part)
      : part_(std::move(part)), bvh_(part_.mesh), cells_(surface_cells(part_, kCells, 1)) {
    constexpr double kDistance_mm = 300.0;
    CameraSettings camera;
    camera.width_px = 2448;
    camera.height_px = 2048;
    camera.object_pixel_mm = 0.04;
    camera.working_distance_mm = kDistance_mm;
    ViewpointSettings around;
    around.count = kViews;
    around.polar_max_rad = kPi;
    for (const Viewpoint& viewpoint : sphere_viewpoints(around, kDistance_mm)) {
      views_.push_back(coverage_view(camera, {}, viewpoint));
    }
  }

  std::int64_t look(ThreadPool& pool) const {
    std::int64_t rays = 0;
    for (const CoverageView& view : views_) {
      benchmark::DoNotOptimize(view_cells(cells_, bvh_, view, {}, pool, rays).data());
    }
    return rays;
  }

 private:
  Part part_;
  Bvh bvh_;
  SurfaceCells cells_;
  std::vector<CoverageView> views_;
};

void cover(benchmark::State& state, const Subject& subject) {
  ThreadPool pool(1);
  EmbreeRecord record;
  std::int64_t rays = 0;
  {
    const EmbreeRecording recording(record);
    rays = subject.look(pool);
  }
  std::int64_t recorded = 0;
  for (const RecordedPacket& packet : record.packets) {
    recorded += packet.num_rays();
  }
  if (recorded != rays) {
    state.SkipWithError("other rays were recorded than counted");
    return;
  }
  std::vector<double> ours_s;
  std::vector<double> embree_s;
  for (int round = 0; round < kRounds; ++round) {
    double start_s = cpu_seconds();
    benchmark::DoNotOptimize(subject.look(pool));
    ours_s.push_back(cpu_seconds() - start_s);
    start_s = cpu_seconds();
    benchmark::DoNotOptimize(ask_again(record.scene, record.packets, Asking::kAsRecorded));
    embree_s.push_back(cpu_seconds() - start_s);
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(subject.look(pool));
  }
  state.counters["of_embree"] = median(ours_s) / median(embree_s);
  state.counters["Mrays_per_second"] = 1e-6 * static_cast<double>(rays) / median(ours_s);
  state.counters["embree_Mrays_per_second"] = 1e-6 * static_cast<double>(rays) / median(embree_s);
}

void cover_gear(benchmark::State& state) {
  static const Subject gear(gear_part());
  cover(state, gear);
}

void cover_sphere(benchmark::State& state) {
  static const Subject sphere(sphere_part());
  cover(state, sphere);
}

BENCHMARK(cover_gear)->Unit(benchmark::kMillisecond);
BENCHMARK(cover_sphere)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace glint::bench

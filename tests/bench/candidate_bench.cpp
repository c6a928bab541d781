// SPDX-License-Identifier: GPL-3.0-or-later
//
// What one candidate costs: the seed's scene, 1300 x 300 pixels, 4 rays a pixel, 24 frames, blur,
// gain and clipping, one thread. `in_passes` is the time in units of one read-only pass over the
// same ray cache, taken in the same run: a number that can be compared between machines.
#include <algorithm>
#include <chrono>

#include <benchmark/benchmark.h>

#include "studies/evaluation.h"

namespace glint {
namespace {

SceneSettings seed_scene(TunnelSettings::Shape shape) {
  SceneSettings scene;
  scene.part.length_mm = 190.0;
  scene.part.width_mm = 44.0;
  scene.part.radius_along_mm = 400.0;
  scene.part.radius_across_mm = 40.0;
  scene.sensor.gain = 1.5;
  scene.sensor.blur_px = 1.0;
  scene.tunnel.shape = shape;
  scene.tunnel.control_mm = {137.0, 110.0, 138.0, 250.0, 250.0};
  scene.tunnel.radius_mm = 200.0;
  scene.tunnel.half_width_mm = 120.0;
  scene.tunnel.height_mm = 200.0;
  scene.tunnel.distance_mm = 36.0;
  scene.tunnel.panel_height_mm = 410.0;
  scene.tunnel.length_mm = 1600.0;
  scene.tunnel.slot_mm = 32.0;
  scene.defects = {{"dent", {.x_mm = {-60.0, 5.0}, .y_mm = {-8.0, 10.0}, .height_mm = 4e-3}}};
  return scene;
}

struct Traced {
  ThreadPool pool{1};
  SceneStore store{pool};
};

Traced& traced() {
  static Traced instance;
  return instance;
}

/// Sum of all floats of the cache: the least that any evaluation must do.
float read_all(const RayCache& rays) {
  float sum = 0.0F;
  for (const auto* array : {&rays.origin_x,
                            &rays.origin_y,
                            &rays.origin_z,
                            &rays.direction_x,
                            &rays.direction_y,
                            &rays.direction_z}) {
    // Eight independent sums, so that additions do not wait for each other.
    std::array<float, 8> parts = {};
    for (std::size_t i = 0; i + 8 <= array->size(); i += 8) {
      for (std::size_t k = 0; k < 8; ++k) {
        parts[k] += (*array)[i + k];
      }
    }
    for (const float part : parts) {
      sum += part;
    }
  }
  return sum;
}

double seconds_per_pass(const RayCache& rays) {
  double best_s = 1e9;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    benchmark::DoNotOptimize(read_all(rays));
    best_s = std::min(
        best_s, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  return best_s;
}

void report_passes(benchmark::State& state, const RayCache& rays) {
  state.counters["in_passes"] =
      benchmark::Counter(static_cast<double>(state.iterations()) * seconds_per_pass(rays),
                         benchmark::Counter::kIsRate | benchmark::Counter::kInvert);
}

void read_pass(benchmark::State& state) {
  const auto scene = traced().store.trace(seed_scene(TunnelSettings::Shape::kSemicylinder));
  for (auto _ : state) {
    benchmark::DoNotOptimize(read_all(scene->rays));
  }
  report_passes(state, scene->rays);
}

/// 24 frames through the sensor into the aspect image, nothing scored.
void scan(benchmark::State& state) {
  const SceneSettings settings = seed_scene(static_cast<TunnelSettings::Shape>(state.range(0)));
  const auto scene = traced().store.trace(settings);
  const Tunnel tunnel(settings.tunnel);
  const Sensor sensor(settings.sensor, scene->rays.width_px, scene->rays.height_px);
  state.SetLabel(std::string(shape_name(settings.tunnel.shape)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        take_scan(scene->rays, tunnel, sensor, settings.scan, scene->camera_in_world_mm));
  }
  report_passes(state, scene->rays);
}

/// A whole candidate of a study: scan and all scores.
void candidate(benchmark::State& state) {
  const SceneSettings settings = seed_scene(static_cast<TunnelSettings::Shape>(state.range(0)));
  state.SetLabel(std::string(shape_name(settings.tunnel.shape)));
  evaluate(traced().store, settings);
  for (auto _ : state) {
    benchmark::DoNotOptimize(evaluate(traced().store, settings));
  }
  report_passes(state, traced().store.trace(settings)->rays);
}

void trace(benchmark::State& state) {
  const SceneSettings settings = seed_scene(TunnelSettings::Shape::kSemicylinder);
  const auto built = traced().store.build(settings);
  const PinholeCamera camera(intrinsics_of(settings.camera));
  ThreadPool pool(1);
  std::int64_t rays = 0;
  for (auto _ : state) {
    const RayCache cache = trace_rays(built->part,
                                      *built->bvh,
                                      {},
                                      camera,
                                      camera_from_world(settings.viewpoint),
                                      settings.render,
                                      pool);
    rays += cache.counts.camera;
  }
  state.SetItemsProcessed(rays);
}

BENCHMARK(read_pass)->Unit(benchmark::kMillisecond);
BENCHMARK(scan)->DenseRange(0, 4)->Unit(benchmark::kMillisecond);
BENCHMARK(candidate)->DenseRange(0, 4)->Unit(benchmark::kMillisecond);
BENCHMARK(trace)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace glint

BENCHMARK_MAIN();

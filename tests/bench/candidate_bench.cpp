// SPDX-License-Identifier: GPL-3.0-or-later
//
// What one candidate costs: the seed's scene, 1300 x 300 pixels, 24 frames, blur, gain and
// clipping, one thread. `in_passes` is the time in units of one read-only pass over the ray cache
// of the plain way (4 rays a pixel, 24 bytes a ray), taken in the same run: a number that can be
// compared between machines. `of_plain` is the time in units of the plain way's for the same
// result, from the same run.
#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include <benchmark/benchmark.h>

#include "core/wall_clock.h"
#include "metrics/aspect_image/homogeneity.h"
#include "simulator/render/footprint/footprint_frames.h"
#include "studies/definition/study.h"
#include "studies/evaluation/evaluation.h"

namespace glint {
namespace {

using Method = RenderSettings::Method;
using Shape = TunnelSettings::Shape;

SceneSettings seed_scene(Shape shape, Method method) {
  SceneSettings scene;
  scene.part.length_mm = 190.0;
  scene.part.width_mm = 44.0;
  scene.part.radius_along_mm = 400.0;
  scene.part.radius_across_mm = 40.0;
  scene.sensor.gain = 1.5;
  scene.sensor.blur_px = 1.0;
  scene.render.method = method;
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

/// Without clipping, and stripes that are no whole number of steps wide.
SceneSettings linear_scene(Shape shape, Method method) {
  SceneSettings scene = seed_scene(shape, method);
  scene.sensor.gain = 0.9;
  scene.tunnel.duty = 0.53;
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

/// The best of a few: what disturbs a machine only makes it slower.
template <class Work>
double best_seconds(int repeats, const Work& work) {
  double best_s = 1e9;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    const auto start = std::chrono::steady_clock::now();
    work();
    best_s = std::min(best_s, seconds_since(start));
  }
  return best_s;
}

const TracedScene& plain_rays() {
  static const std::shared_ptr<const TracedScene> scene =
      traced().store.trace(seed_scene(Shape::kSemicylinder, Method::kSampled));
  return *scene;
}

const TracedScene& corner_rays() {
  static const std::shared_ptr<const TracedScene> scene =
      traced().store.trace(seed_scene(Shape::kSemicylinder, Method::kAuto));
  return *scene;
}

double seconds_per_pass() {
  return best_seconds(5, [] { benchmark::DoNotOptimize(read_all(plain_rays().rays)); });
}

benchmark::Counter in_units(const benchmark::State& state, double seconds) {
  return {static_cast<double>(state.iterations()) * seconds,
          benchmark::Counter::kIsRate | benchmark::Counter::kInvert};
}

void report_passes(benchmark::State& state) {
  state.counters["in_passes"] = in_units(state, seconds_per_pass());
}

Shape shape_of(benchmark::State& state) {
  const auto shape = static_cast<Shape>(state.range(0));
  state.SetLabel(std::string(shape_name(shape)));
  return shape;
}

Homogeneity plain_homogeneity(const SceneSettings& settings) {
  const TracedScene& scene = plain_rays();
  const Tunnel tunnel(settings.tunnel);
  const Sensor sensor(settings.sensor, scene.rays.width_px, scene.rays.height_px);
  const ScanResult scan =
      take_scan(scene.rays, tunnel, sensor, settings.scan, scene.camera_in_world_mm);
  return homogeneity(
      scan.aspect, scan.sums.clipped_frames, scan.sums.frames, scene.region, settings.metrics);
}

Homogeneity closed_homogeneity(const SceneSettings& settings, ScanForm* form = nullptr) {
  const TracedScene& scene = corner_rays();
  const Tunnel tunnel(settings.tunnel);
  const Sensor sensor(settings.sensor, scene.corners.width_px, scene.corners.height_px);
  const Footprints footprints(scene.corners, tunnel, settings.scan, scene.camera_in_world_mm);
  const double reflectance = settings.render.reflectance;
  const ScanPlan plan = plan_scan(footprints, sensor, scene.region, {}, reflectance);
  static FramePicturePool pictures;
  const ClosedScan scan = scan_closed(footprints, sensor, plan, {}, &pictures);
  if (form != nullptr) {
    *form = scan.form;
  }
  constexpr bool kWantsPercentiles = false;
  return homogeneity(scan.aspect,
                     scan.clipped_frames,
                     settings.scan.positions,
                     scene.region,
                     settings.metrics,
                     kWantsPercentiles);
}

/// Share of the tiles with rays that are met by their nodes
/// (simulator/render/corner_rays/sparse_rays.h).
double tiles_by_nodes(const SceneSettings& settings) {
  const TracedScene& scene = corner_rays();
  const WallView view(scene.corners, Tunnel(settings.tunnel), scene.camera_in_world_mm);
  const auto known = std::ranges::count(view.limits.kind, TileLimits::kKnown);
  const auto others = std::ranges::count(view.limits.kind, TileLimits::kUnknown);
  return static_cast<double>(known) /
         static_cast<double>(std::max<std::ptrdiff_t>(known + others, 1));
}

void read_pass(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(read_all(plain_rays().rays));
  }
  report_passes(state);
}

/// Mean and homogeneity in closed form, everything from rays to scores.
void closed_form(benchmark::State& state, const SceneSettings& settings) {
  ScanForm form;
  closed_homogeneity(settings, &form);
  for (auto _ : state) {
    benchmark::DoNotOptimize(closed_homogeneity(settings));
  }
  report_passes(state);
  state.counters["of_plain"] = in_units(
      state, best_seconds(3, [&] { benchmark::DoNotOptimize(plain_homogeneity(settings)); }));
  state.counters["frame_pixels"] = form.frame_pixels;
  state.counters["tiles_by_nodes"] = tiles_by_nodes(settings);
}

void mean_by_floors(benchmark::State& state) {
  closed_form(state, linear_scene(shape_of(state), Method::kClosed));
}

void h_by_table(benchmark::State& state) {
  closed_form(state, seed_scene(shape_of(state), Method::kClosed));
}

/// 24 frames of radiance by point samples, without a sensor.
void render_binary(const SceneSettings& settings, std::vector<ImageF>& frames) {
  const TracedScene& scene = plain_rays();
  const Tunnel tunnel(settings.tunnel);
  const WallRays rays = intersect_wall(scene.rays, tunnel, scene.camera_in_world_mm);
  std::vector<StripePattern> patterns;
  const double step_mm = scan_step_mm(settings.scan, settings.tunnel);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    patterns.push_back(tunnel.pattern(static_cast<double>(k) * step_mm));
  }
  render_frames(scene.rays, rays, patterns, frames);
}

/// The same integrated over footprints, one ray a pixel.
void render_integrated(const SceneSettings& settings, std::vector<ImageF>& frames) {
  const TracedScene& scene = corner_rays();
  const Tunnel tunnel(settings.tunnel);
  const Footprints footprints(scene.corners, tunnel, settings.scan, scene.camera_in_world_mm);
  const Spans all = whole_image(scene.corners.width_px, scene.corners.height_px);
  FootprintFrames(footprints, all).render(0, frames);
}

std::vector<ImageF> empty_frames() {
  const VisibilityBuffer& seen = plain_rays().seen();
  return std::vector<ImageF>(24, ImageF(seen.width_px, seen.height_px));
}

void frames_binary(benchmark::State& state) {
  const SceneSettings settings = seed_scene(shape_of(state), Method::kSampled);
  std::vector<ImageF> frames = empty_frames();
  for (auto _ : state) {
    render_binary(settings, frames);
    benchmark::ClobberMemory();
  }
  report_passes(state);
}

void frames_integrated(benchmark::State& state) {
  const SceneSettings settings = seed_scene(shape_of(state), Method::kIntegrated);
  std::vector<ImageF> frames = empty_frames();
  for (auto _ : state) {
    render_integrated(settings, frames);
    benchmark::ClobberMemory();
  }
  report_passes(state);
  state.counters["of_plain"] =
      in_units(state, best_seconds(5, [&] { render_binary(settings, frames); }));
}

/// 24 frames through the sensor into the mean image, nothing scored.
void scan_sampled(benchmark::State& state) {
  const SceneSettings settings = seed_scene(shape_of(state), Method::kSampled);
  const TracedScene& scene = plain_rays();
  const Tunnel tunnel(settings.tunnel);
  const Sensor sensor(settings.sensor, scene.rays.width_px, scene.rays.height_px);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        take_scan(scene.rays, tunnel, sensor, settings.scan, scene.camera_in_world_mm));
  }
  report_passes(state);
}

/// What a search for homogeneity wants that keeps defects visible.
constexpr WantedScores kWanted = {.fringes = false, .defects = true, .robust = false};

/// Candidates of a search: every one has a wall of its own.
void evaluate_candidate(SceneSettings& settings, int index) {
  settings.tunnel.base_mm = -1e-3 * (index % 1000);
  benchmark::DoNotOptimize(evaluate(traced().store, settings, {}, kWanted));
}

/// A whole candidate of a study: scan and the scores of its objective and constraints.
void candidate(benchmark::State& state) {
  SceneSettings settings = seed_scene(shape_of(state), Method::kAuto);
  int index = 0;
  evaluate_candidate(settings, ++index);
  for (auto _ : state) {
    evaluate_candidate(settings, ++index);
  }
  report_passes(state);
  settings.render.method = Method::kSampled;
  state.counters["of_plain"] =
      in_units(state, best_seconds(2, [&] { evaluate_candidate(settings, ++index); }));
}

/// Candidates that differ in stripes alone: period and duty.
void candidate_same_wall(benchmark::State& state) {
  SceneSettings settings = seed_scene(shape_of(state), Method::kAuto);
  int index = 0;
  for (auto _ : state) {
    settings.tunnel.period_mm = 16.0 + 1e-3 * (++index % 1000);
    benchmark::DoNotOptimize(evaluate(traced().store, settings, {}, kWanted));
  }
  report_passes(state);
}

/// h by table with its derivative by eight keys: five control points, slot, period and duty.
void h_with_gradient(benchmark::State& state) {
  SceneSettings settings = seed_scene(Shape::kFree, Method::kClosed);
  WantedScores wanted = {.fringes = false, .defects = false, .robust = false, .slot = false};
  wanted.gradients.scores = {"homogeneity.h_rms"};
  for (const char* key : {"control_mm.0",
                          "control_mm.1",
                          "control_mm.2",
                          "control_mm.3",
                          "control_mm.4",
                          "slot_mm",
                          "period_mm",
                          "duty"}) {
    wanted.gradients.paths.push_back("lighting." + settings.tunnel_name + "." + key);
  }
  int index = 0;
  for (auto _ : state) {
    settings.tunnel.control_mm[4] = 249.0 + 1e-3 * (++index % 1000);
    benchmark::DoNotOptimize(evaluate(traced().store, settings, {}, wanted));
  }
  report_passes(state);
}

/// Two threads evaluate candidates of one store; `speedup` over one thread in the same run.
void candidate_jobs2(benchmark::State& state) {
  constexpr int kEach = 8;
  const auto work = [](int first) {
    SceneSettings settings = seed_scene(Shape::kSemicylinder, Method::kAuto);
    for (int i = 0; i < kEach; ++i) {
      evaluate_candidate(settings, first + i);
    }
  };
  work(0);
  double one_s = 0.0;
  double two_s = 0.0;
  for (auto _ : state) {
    const auto start = std::chrono::steady_clock::now();
    work(100);
    const auto middle = std::chrono::steady_clock::now();
    one_s += std::chrono::duration<double>(middle - start).count();
    std::jthread other(work, 200);
    work(300);
    other.join();
    two_s += seconds_since(middle);
  }
  state.counters["speedup"] = 2.0 * one_s / two_s;
}

/// The scene of a candidate with eight variables of the tunnel; `of_whole` is its time in units of
/// that for reading the whole scene.
void candidate_scene(benchmark::State& state) {
  Study study;
  study.scene = seed_scene(Shape::kFree, Method::kAuto);
  study.resolved = write_scene(study.scene);
  study.root = study.resolved;
  Overrides overrides;
  for (const char* key : {"control_mm.0",
                          "control_mm.1",
                          "control_mm.2",
                          "control_mm.3",
                          "control_mm.4",
                          "slot_mm",
                          "period_mm",
                          "duty"}) {
    const std::string path = "lighting." + study.scene.tunnel_name + "." + key;
    overrides.emplace_back(path, *study.resolved.at_path(path));
  }
  for (auto _ : state) {
    benchmark::DoNotOptimize(scene_with(study, overrides));
  }
  const double own_s = best_seconds(100, [&] { scene_with(study, overrides); });
  const double whole_s = best_seconds(100, [&] {
    std::vector<Problem> errors;
    const ConfigNode root = study.root;
    benchmark::DoNotOptimize(read_scene(root, errors));
  });
  state.counters["of_whole"] = own_s / whole_s;
}

void trace(benchmark::State& state) {
  const SceneSettings settings = seed_scene(Shape::kSemicylinder, Method::kSampled);
  const auto built = traced().store.build(settings);
  const PinholeCamera camera(intrinsics_of(settings.camera));
  ThreadPool pool(1);
  std::int64_t rays = 0;
  for (auto _ : state) {
    const RayCache cache = trace_rays(built->part,
                                      *built->bvh,
                                      {},
                                      camera,
                                      camera_from_world(settings.viewpoint()),
                                      settings.render,
                                      pool);
    rays += cache.counts.camera;
  }
  state.SetItemsProcessed(rays);
}

BENCHMARK(read_pass)->Unit(benchmark::kMillisecond);
BENCHMARK(mean_by_floors)->DenseRange(0, 4)->Unit(benchmark::kMillisecond);
BENCHMARK(h_by_table)->DenseRange(0, 4)->Unit(benchmark::kMillisecond);
BENCHMARK(h_with_gradient)->Unit(benchmark::kMillisecond);
BENCHMARK(frames_binary)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(frames_integrated)->Arg(1)->Unit(benchmark::kMillisecond);
BENCHMARK(scan_sampled)->DenseRange(0, 4)->Unit(benchmark::kMillisecond);
BENCHMARK(candidate)->DenseRange(0, 4)->Unit(benchmark::kMillisecond);
BENCHMARK(candidate_same_wall)->DenseRange(0, 4)->Unit(benchmark::kMillisecond);
BENCHMARK(candidate_jobs2)->UseRealTime()->Unit(benchmark::kMillisecond);
BENCHMARK(candidate_scene)->Unit(benchmark::kMicrosecond);
BENCHMARK(trace)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace glint

int main(int argc, char** argv) {
  // As the program does (cli/main.cpp): pictures of one candidate become those of the next.
  mallopt(M_MMAP_THRESHOLD, 1 << 28);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

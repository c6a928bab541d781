// SPDX-License-Identifier: GPL-3.0-or-later
//
// The path tracer on the gear under a ring light (gear_scene.h), one thread, against Embree alone
// on the very same rays: all packets of a pass of 4 samples are taken down and asked again, in the
// same order, by the same call, with the same flags. Pictures and packets take turns; medians.
//
// Row `whole`: of_embree is Embree's time for all rays of a picture over the CPU time of the
// picture. Rows of one kind of ray: of_embree is the throughput of the tracing of these rays alone
// in units of Embree's; of_best_embree in units of the quickest of Embree's ways to ask for them.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <ctime>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/error.h"
#include "core/median.h"
#include "core/wall_clock.h"
#include "tests/bench/embree_recorder.h"
#include "tests/bench/gear_scene.h"

namespace glint::bench {
namespace {

constexpr int kSamples = 16;
constexpr int kRecordedSamples = 4;  ///< all rays of more would fill the memory
constexpr int kRounds = 5;

enum Kind { kCamera, kShadow, kBounce, kKinds };

constexpr std::array<const char*, kKinds> kNames = {"camera", "shadow", "bounce"};
constexpr std::array<Asking, 5> kWays = {Asking::kAsRecorded,
                                         Asking::kCoherent,
                                         Asking::kIncoherent,
                                         Asking::kOccludedCoherent,
                                         Asking::kOccludedIncoherent};

double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

std::array<std::int64_t, kKinds> rays_of(const PathCounts& counts) {
  return {counts.camera, counts.shadow, counts.bounce};
}

/// A picture, and the CPU seconds of all of it and of the tracing of each kind of ray.
struct Picture {
  PathCounts counts;
  double cpu_s = 0.0;
  std::array<double, kKinds> traced_s = {};
};

/// The tracer counts wall time, in which other programs may run: its shares of the whole wall time
/// are taken of the CPU time.
Picture render(const GearScene& gear, int samples) {
  ThreadPool pool(1);
  const auto wall = std::chrono::steady_clock::now();
  const double start_s = cpu_seconds();
  const Film sums = render_paths(gear.scene(), gear.paths(samples), pool);
  Picture picture = {.counts = sums.counts, .cpu_s = cpu_seconds() - start_s};
  const double share = picture.cpu_s / seconds_since(wall);
  picture.traced_s = {
      share * sums.counts.camera_s, share * sums.counts.shadow_s, share * sums.counts.bounce_s};
  return picture;
}

/// The packets of a pass, by kind.
struct Packets {
  EmbreeScene scene = nullptr;
  std::array<std::vector<RecordedPacket>, kKinds> of;
  std::array<std::int64_t, kKinds> rays = {};
  std::string mismatch;  ///< empty when these are the rays that the tracer has counted
};

Kind kind_of(const RecordedPacket& packet, const Eigen::Vector3d& eye_mm) {
  const auto lane = static_cast<std::size_t>(
      std::ranges::find_if(packet.valid, [](std::int32_t v) { return v != 0; }) -
      packet.valid.begin());
  GLINT_CHECK(lane < packet.valid.size(), "a packet has a ray");
  const Eigen::Vector3d origin_mm =
      vector_of(packet.origin_x[lane], packet.origin_y[lane], packet.origin_z[lane]);
  if ((origin_mm - eye_mm).norm() < 1e-3) {
    return kCamera;
  }
  return std::isfinite(packet.far[lane]) ? kShadow : kBounce;
}

Packets record(const GearScene& gear) {
  EmbreeRecord all;
  PathCounts counts;
  {
    const EmbreeRecording recording(all);
    counts = render(gear, kRecordedSamples).counts;
  }
  Packets packets = {.scene = all.scene};
  const Eigen::Vector3d eye_mm = inverse(gear.camera_from_world).translation_mm;
  for (const RecordedPacket& packet : all.packets) {
    const Kind kind = kind_of(packet, eye_mm);
    packets.of[kind].push_back(packet);
    packets.rays[kind] += packet.num_rays();
  }
  for (std::size_t kind = 0; kind < kKinds; ++kind) {
    if (packets.rays[kind] != rays_of(counts)[kind]) {
      packets.mismatch += std::string(kNames.at(kind)) + ": " + std::to_string(packets.rays[kind]) +
                          " rays recorded, " + std::to_string(rays_of(counts)[kind]) + " counted ";
    }
  }
  return packets;
}

/// Everything measured, in turns.
struct Measured {
  Packets packets;
  Picture picture;                            ///< medians
  std::array<double, kKinds> embree_s = {};   ///< a ray, as recorded; medians
  std::array<double, kKinds> fastest_s = {};  ///< a ray, of the quickest way; medians
};

double seconds_a_ray(const Packets& packets, std::size_t kind, Asking asking) {
  const double start_s = cpu_seconds();
  benchmark::DoNotOptimize(ask_again(packets.scene, packets.of[kind], asking));
  return (cpu_seconds() - start_s) / static_cast<double>(packets.rays[kind]);
}

/// One round of all ways to ask for one kind of ray. Whether anything is met is all that a shadow
/// ray wants to know; the others want to know what.
void time_embree(const Packets& packets,
                 std::size_t kind,
                 std::array<std::vector<double>, kWays.size()>& times_s) {
  const std::size_t ways = kind == kShadow ? kWays.size() : 3;
  for (std::size_t way = 0; way < ways; ++way) {
    times_s[way].push_back(seconds_a_ray(packets, kind, kWays[way]));
  }
}

Measured measure(const GearScene& gear) {
  Measured result = {.packets = record(gear)};
  std::vector<double> cpu_s;
  std::array<std::vector<double>, kKinds> traced_s;
  std::array<std::array<std::vector<double>, kWays.size()>, kKinds> embree_s;
  for (int round = 0; round < kRounds; ++round) {
    const Picture picture = render(gear, kSamples);
    result.picture.counts = picture.counts;
    cpu_s.push_back(picture.cpu_s);
    for (std::size_t kind = 0; kind < kKinds; ++kind) {
      traced_s[kind].push_back(picture.traced_s[kind]);
      time_embree(result.packets, kind, embree_s[kind]);
    }
  }
  result.picture.cpu_s = median(cpu_s);
  for (std::size_t kind = 0; kind < kKinds; ++kind) {
    result.picture.traced_s[kind] = median(traced_s[kind]);
    result.embree_s[kind] = median(embree_s[kind][0]);
    result.fastest_s[kind] = result.embree_s[kind];
    for (const std::vector<double>& times_s : embree_s[kind]) {
      result.fastest_s[kind] = times_s.empty() ? result.fastest_s[kind]
                                               : std::min(result.fastest_s[kind], median(times_s));
    }
  }
  return result;
}

/// Seconds that rays of these kinds take at so much each.
double all_rays_s(const PathCounts& counts, const std::array<double, kKinds>& a_ray_s) {
  double sum_s = 0.0;
  for (std::size_t kind = 0; kind < kKinds; ++kind) {
    sum_s += static_cast<double>(rays_of(counts)[kind]) * a_ray_s[kind];
  }
  return sum_s;
}

void set_rates(benchmark::State& state, double rays, double ours_s, double raw_s, double best_s) {
  state.counters["of_embree"] = raw_s / ours_s;
  state.counters["of_best_embree"] = best_s / ours_s;
  state.counters["Mrays_per_second"] = 1e-6 * rays / ours_s;
  state.counters["embree_Mrays_per_second"] = 1e-6 * rays / raw_s;
  state.counters["best_embree_Mrays_per_second"] = 1e-6 * rays / best_s;
}

/// A picture, timed; the other figures of the row are medians of the rounds.
void whole(benchmark::State& state, const GearScene& gear, const Measured& measured) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(render(gear, kSamples));
  }
  const Picture& picture = measured.picture;
  const auto rays =
      static_cast<double>(picture.counts.camera + picture.counts.shadow + picture.counts.bounce);
  set_rates(state,
            rays,
            picture.cpu_s,
            all_rays_s(picture.counts, measured.embree_s),
            all_rays_s(picture.counts, measured.fastest_s));
  state.counters["share"] = 1.0;
  state.counters["rays_a_sample"] = rays / static_cast<double>(picture.counts.camera);
}

/// The recorded rays of one kind by Embree, timed; the other figures are medians of the rounds.
void one_kind(benchmark::State& state, std::size_t kind, const Measured& measured) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        ask_again(measured.packets.scene, measured.packets.of[kind], Asking::kAsRecorded));
  }
  const Picture& picture = measured.picture;
  const auto rays = static_cast<double>(rays_of(picture.counts)[kind]);
  set_rates(state,
            rays,
            picture.traced_s[kind],
            rays * measured.embree_s[kind],
            rays * measured.fastest_s[kind]);
  state.counters["share"] = picture.traced_s[kind] / picture.cpu_s;
  state.counters["rays_a_sample"] = rays / static_cast<double>(picture.counts.camera);
}

void paths(benchmark::State& state, std::size_t row) {
  static const GearScene gear;
  static const Measured measured = measure(gear);
  if (!measured.packets.mismatch.empty()) {
    state.SkipWithError(measured.packets.mismatch.c_str());
  } else if (row == kKinds) {
    whole(state, gear, measured);
  } else {
    one_kind(state, row, measured);
  }
}

/// The same with the light that goes on between microfacets: what a scene has by default.
void with_compensation(benchmark::State& state) {
  static const GearScene gear({.has_compensation = true});
  double rays = 0.0;
  const double start_s = cpu_seconds();
  for (auto _ : state) {
    const PathCounts counts = render(gear, kSamples).counts;
    rays += static_cast<double>(counts.camera + counts.shadow + counts.bounce);
  }
  state.counters["Mrays_per_second"] = 1e-6 * rays / (cpu_seconds() - start_s);
}

void once(benchmark::internal::Benchmark* row) {
  row->Unit(benchmark::kMillisecond)->Iterations(1);
}

BENCHMARK_CAPTURE(paths, whole, kKinds)->Name("paths/gear/whole")->Apply(once);
BENCHMARK_CAPTURE(paths, camera, kCamera)->Name("paths/gear/camera")->Apply(once);
BENCHMARK_CAPTURE(paths, shadow, kShadow)->Name("paths/gear/shadow")->Apply(once);
BENCHMARK_CAPTURE(paths, bounce, kBounce)->Name("paths/gear/bounce")->Apply(once);
BENCHMARK(with_compensation)->Name("paths/gear_regained/whole")->Apply(once);

}  // namespace
}  // namespace glint::bench

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What it costs to trace a ray cache, against Embree alone on the same rays: sixteen at a time,
// robust scene, coherent. The same rays are those whose fate the cache tells: one packet of camera
// rays for each sixteen pixels of the image, one of the rays they are reflected into, and one for
// each further reflection of rays that meet the part again. The two are alternated and medians
// taken, so that a noisy machine disturbs both alike.
//
// - `of_embree`: the throughput in units of Embree's for all these rays, also those that the tracer
//   need not ask for: packets beside the part's outline, and reflected rays that are known to meet
//   nothing (convex parts, EscapeCone). Second tries of rays that miss count against the tracer.
// - `of_asked`: in units of Embree's for only the packets that the tracer really asks for.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <ctime>
#include <limits>

#include <benchmark/benchmark.h>
#include <embree3/rtcore.h>
#include <malloc.h>

#include "core/median.h"
#include "simulator/camera/camera_settings.h"
#include "simulator/render/corner_rays/corner_rays.h"
#include "simulator/render/ray_cache/packet_tracer.h"
#include "tests/bench/embree_recorder.h"

namespace glint {
namespace {

constexpr int kRounds = 9;

/// One scene of the bench, 1300 x 300 pixels.
struct BenchScene {
  Part part;
  Bvh bvh;
  SurfaceDetail detail;
  CameraSettings camera_settings;
  PinholeCamera camera;
  RigidTransform camera_from_world;
  RenderSettings render = {.rays_per_axis = 1};

  BenchScene(const PartSettings& settings, double object_pixel_mm, bool has_dents)
      : part(build_part(settings)),
        bvh(part.mesh),
        detail(has_dents ? dents() : std::vector<HeightFeature>{}),
        camera_settings{.object_pixel_mm = object_pixel_mm},
        camera(intrinsics_of(camera_settings)),
        camera_from_world(glint::camera_from_world(default_viewpoint(camera_settings))) {}

  std::vector<HeightFeature> dents() const {
    std::vector<HeightFeature> features;
    for (const auto& [x_mm, y_mm] : {std::pair(-60.0, -8.0), std::pair(5.0, 10.0)}) {
      const auto place = place_on_surface(part, bvh, x_mm, y_mm);
      HeightFeature dent;
      dent.centre_mm = place->centre_mm;
      dent.u_axis = place->u_axis;
      dent.v_axis = place->v_axis;
      dent.normal = place->normal;
      dent.sigma_mm = 0.2;
      dent.height_mm = -4e-3;
      features.push_back(dent);
    }
    return features;
  }
};

/// The same part without its exact surfaces: everything from triangles.
Part without_patches(Part part) {
  part.mesh.patch.clear();
  part.patches.clear();
  return part;
}

const BenchScene& scene(int number) {
  static const BenchScene strip(
      {.length_mm = 190.0, .width_mm = 44.0, .radius_along_mm = 400.0, .radius_across_mm = 40.0},
      0.15,
      true);
  static const BenchScene gear({.shape = PartSettings::Shape::kSpurGear}, 0.06, false);
  static const BenchScene bowl(
      {.length_mm = 190.0, .width_mm = 44.0, .radius_along_mm = -400.0, .radius_across_mm = -60.0},
      0.15,
      true);
  static const BenchScene mesh = [] {
    BenchScene copy(
        {.length_mm = 190.0, .width_mm = 44.0, .radius_along_mm = 400.0, .radius_across_mm = 40.0},
        0.15,
        true);
    copy.part = without_patches(std::move(copy.part));
    return copy;
  }();
  const std::array<const BenchScene*, 4> all = {&strip, &bowl, &gear, &mesh};
  return *all[static_cast<std::size_t>(number)];
}

constexpr std::array<const char*, 4> kNames = {"strip", "bowl", "gear", "strip as mesh"};

/// Embree alone: packets made beforehand, traced by rtcIntersect16 and nothing else.
class RawEmbree {
 public:
  explicit RawEmbree(const BenchScene& bench) {
    device_ = rtcNewDevice("set_affinity=0");
    scene_ = rtcNewScene(device_);
    attach(bench.part.mesh);
    record(bench);
  }

  ~RawEmbree() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }

  RawEmbree(const RawEmbree&) = delete;
  RawEmbree& operator=(const RawEmbree&) = delete;

  std::int64_t num_camera_rays() const { return num_camera_rays_; }

  float trace() const {
    float sum = 0.0F;
    for (std::size_t i = 0; i < packets_.size(); ++i) {
      RTCRayHit16 packet = packets_[i];
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
      rtcIntersect16(valid_[i].data(), scene_, &context, &packet);
      sum += packet.hit.u[0];
    }
    return sum;
  }

 private:
  struct alignas(64) Valid : std::array<std::int32_t, kPacketSize> {};

  void attach(const TriangleMesh& mesh) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(rtcSetNewGeometryBuffer(geometry,
                                                                 RTC_BUFFER_TYPE_VERTEX,
                                                                 0,
                                                                 RTC_FORMAT_FLOAT3,
                                                                 3 * sizeof(float),
                                                                 mesh.vertices_mm.size()));
    auto* triangles = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(geometry,
                                                                          RTC_BUFFER_TYPE_INDEX,
                                                                          0,
                                                                          RTC_FORMAT_UINT3,
                                                                          3 * sizeof(std::uint32_t),
                                                                          mesh.num_triangles()));
    for (const Eigen::Vector3d& vertex : mesh.vertices_mm) {
      vertices = std::copy_n(vertex.cast<float>().eval().data(), 3, vertices);
    }
    for (const Triangle& triangle : mesh.triangles) {
      for (const std::int32_t i : triangle) {
        *triangles++ = static_cast<std::uint32_t>(i);
      }
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
    rtcCommitScene(scene_);
  }

  /// Keeps packets of the camera and of all reflections.
  void record(const BenchScene& bench) {
    const PinholeIntrinsics& in = bench.camera.intrinsics();
    const CameraRays camera(bench.camera, bench.camera_from_world);
    const TraceScene traced(bench.part, bench.bvh, bench.detail, bench.render);
    for (int y = 0; y < in.height_px; ++y) {
      for (int x = 0; x < in.width_px; x += kPacketSize) {
        const int count = std::min(kPacketSize, in.width_px - x);
        Lanes x_px;
        Lanes y_px;
        for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
          x_px[lane] = x + static_cast<double>(lane) + 0.5;
          y_px[lane] = y + 0.5;
        }
        CameraPacket rays;
        camera.through(x_px.data(), y_px.data(), count, rays);
        num_camera_rays_ += count;
        HitPacket hits;
        RayQuery query;
        ask_from_point16(rays.origin_mm.data(),
                         rays.direction_x.data(),
                         rays.direction_y.data(),
                         rays.direction_z.data(),
                         count,
                         query);
        record_packet(query);
        bench.bvh.trace16(query, Coherence::kCoherent);
        take_hits16(query, hits);
        record_reflections(traced, rays, hits);
      }
    }
  }

  void record_reflections(const TraceScene& traced, const CameraPacket& rays, HitPacket& hits) {
    IntersectionLanes lanes = {};
    intersect_part(traced, rays, hits, false, lanes);
    for (int bounce = 1;; ++bounce) {
      RayQuery query;
      ask_reflected16(lanes, hits.triangle.data(), query);
      record_packet(query);
      traced.bvh.trace16(query, Coherence::kCoherentOnce);
      if (!take_hits16(query, hits) || bounce >= traced.settings.max_bounces) {
        return;
      }
      IntersectionLanes next = {};
      intersect_again(traced, lanes, hits, next);
      lanes = next;
    }
  }

  void record_packet(const RayQuery& rays) {
    if (std::ranges::none_of(rays.valid, [](int valid) { return valid != 0; })) {
      return;
    }
    RTCRayHit16 packet = {};
    std::ranges::copy(rays.origin_x, packet.ray.org_x);
    std::ranges::copy(rays.origin_y, packet.ray.org_y);
    std::ranges::copy(rays.origin_z, packet.ray.org_z);
    std::ranges::copy(rays.direction_x, packet.ray.dir_x);
    std::ranges::copy(rays.direction_y, packet.ray.dir_y);
    std::ranges::copy(rays.direction_z, packet.ray.dir_z);
    std::ranges::fill(packet.ray.tfar, std::numeric_limits<float>::infinity());
    std::ranges::fill(packet.ray.mask, ~0U);
    std::ranges::fill(packet.hit.geomID, RTC_INVALID_GEOMETRY_ID);
    std::ranges::fill(packet.hit.instID[0], RTC_INVALID_GEOMETRY_ID);
    packets_.push_back(packet);
    Valid valid;
    std::ranges::copy(rays.valid, valid.begin());
    valid_.push_back(valid);
  }

  RTCDevice device_ = nullptr;
  RTCScene scene_ = nullptr;
  std::vector<RTCRayHit16> packets_;
  std::vector<Valid> valid_;
  std::int64_t num_camera_rays_ = 0;
};

/// Of the processor, on all threads: other programs on the machine do not count.
template <class Function>
double cpu_seconds(const Function& function) {
  const std::clock_t start = std::clock();
  function();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
}

template <class Function>
double wall_seconds(const Function& function) {
  const auto start = std::chrono::steady_clock::now();
  function();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

RayCache trace(const BenchScene& bench, ThreadPool& pool) {
  return trace_rays(bench.part,
                    bench.bvh,
                    bench.detail,
                    bench.camera,
                    bench.camera_from_world,
                    bench.render,
                    pool);
}

CornerRays trace_corners(const BenchScene& bench, ThreadPool& pool) {
  return trace_corner_rays(bench.part,
                           bench.bvh,
                           bench.detail,
                           bench.camera,
                           bench.camera_from_world,
                           bench.render,
                           pool);
}

/// Keeps freed memory with the program, as a study that traces again and again wants it: pages that
/// are new to the program cost about half as much as tracing itself.
void keep_memory() {
  constexpr int kAll = 1 << 30;
  mallopt(M_MMAP_THRESHOLD, kAll);
  mallopt(M_TRIM_THRESHOLD, kAll);
}

/// What trace_rays() really asks of Embree.
::glint::bench::EmbreeRecord asked_of_embree(const BenchScene& bench, ThreadPool& pool) {
  ::glint::bench::EmbreeRecord record;
  const ::glint::bench::EmbreeRecording recording(record);
  benchmark::DoNotOptimize(trace(bench, pool));
  return record;
}

/// trace_rays() on one thread against Embree alone.
void cache_build(benchmark::State& state) {
  const BenchScene& bench = scene(static_cast<int>(state.range(0)));
  const RawEmbree raw(bench);
  ThreadPool pool(1);
  std::vector<double> ours_s;
  std::vector<double> embree_s;
  std::vector<double> asked_s;
  keep_memory();
  const ::glint::bench::EmbreeRecord asked = asked_of_embree(bench, pool);
  for (auto _ : state) {
    for (int round = 0; round < kRounds; ++round) {
      ours_s.push_back(cpu_seconds([&] { benchmark::DoNotOptimize(trace(bench, pool)); }));
      embree_s.push_back(cpu_seconds([&] { benchmark::DoNotOptimize(raw.trace()); }));
      asked_s.push_back(cpu_seconds([&] {
        benchmark::DoNotOptimize(::glint::bench::ask_again(
            asked.scene, asked.packets, ::glint::bench::Asking::kAsRecorded));
      }));
    }
  }
  const auto rays = static_cast<double>(raw.num_camera_rays());
  state.SetLabel(kNames[static_cast<std::size_t>(state.range(0))]);
  state.counters["of_embree"] = median(embree_s) / median(ours_s);
  state.counters["of_asked"] = median(asked_s) / median(ours_s);
  state.counters["Mrays_per_s"] = rays * 1e-6 / median(ours_s);
  state.counters["embree_Mrays_per_s"] = rays * 1e-6 / median(embree_s);
}

/// trace_corner_rays() on one thread, in kept rays, against Embree alone on one ray a pixel.
void corner_build(benchmark::State& state) {
  const BenchScene& bench = scene(static_cast<int>(state.range(0)));
  const RawEmbree raw(bench);
  ThreadPool pool(1);
  std::vector<double> ours_s;
  std::vector<double> embree_s;
  std::int64_t rays = 0;
  keep_memory();
  for (auto _ : state) {
    for (int round = 0; round < kRounds; ++round) {
      ours_s.push_back(cpu_seconds([&] { rays = trace_corners(bench, pool).counts.camera; }));
      embree_s.push_back(cpu_seconds([&] { benchmark::DoNotOptimize(raw.trace()); }));
    }
  }
  const double ours_per_ray_s = median(ours_s) / static_cast<double>(rays);
  const double embree_per_ray_s = median(embree_s) / static_cast<double>(raw.num_camera_rays());
  state.SetLabel(kNames[static_cast<std::size_t>(state.range(0))]);
  state.counters["of_embree"] = embree_per_ray_s / ours_per_ray_s;
  state.counters["Mrays_per_s"] = 1e-6 / ours_per_ray_s;
}

/// Two threads against one.
void two_threads(benchmark::State& state) {
  const BenchScene& bench = scene(static_cast<int>(state.range(0)));
  ThreadPool one(1);
  ThreadPool two(2);
  keep_memory();
  std::vector<double> one_s;
  std::vector<double> two_s;
  for (auto _ : state) {
    for (int round = 0; round < kRounds; ++round) {
      one_s.push_back(wall_seconds([&] { benchmark::DoNotOptimize(trace(bench, one)); }));
      two_s.push_back(wall_seconds([&] { benchmark::DoNotOptimize(trace(bench, two)); }));
    }
  }
  state.SetLabel(kNames[static_cast<std::size_t>(state.range(0))]);
  state.counters["times_one"] = median(one_s) / median(two_s);
}

BENCHMARK(cache_build)->DenseRange(0, 3)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK(corner_build)->DenseRange(0, 3)->Unit(benchmark::kMillisecond)->Iterations(1);
BENCHMARK(two_threads)->Arg(0)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace glint

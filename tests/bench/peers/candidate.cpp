// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/peers/candidate.h"
#include "core/median.h"

#include <algorithm>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "simulator/render/corner_rays/corner_rays.h"
#include "simulator/render/footprint/footprint_frames.h"
#include "simulator/render/footprint/footprints.h"
#include "simulator/render/scan/scan.h"
#include "tests/bench/peers/process.h"

namespace glint::peers {
namespace {

/// Rows of the reference that are traced at once: its rays would fill the memory.
constexpr int kReferenceRows = 20;
/// Pixels this near to a partly lit one do not count as away from edges of the light.
constexpr int kEdgeReach_px = 2;

Eigen::Vector3d camera_position_mm(const SceneSettings& scene) {
  return inverse(camera_from_world(scene.viewpoint())).translation_mm;
}

/// All frames of one candidate lighting, along rays that are traced already: point samples.
void render_candidate(const RayCache& rays,
                      const SceneSettings& scene,
                      std::vector<ImageF>& frames) {
  const Tunnel tunnel(scene.tunnel);
  const WallRays wall = intersect_wall(rays, tunnel, camera_position_mm(scene));
  const double step_mm = scan_step_mm(scene.scan, scene.tunnel);
  for (int k = 0; k < scene.scan.positions; ++k) {
    render_frame(rays, wall, tunnel.pattern(k * step_mm), frames[static_cast<std::size_t>(k)]);
  }
}

/// The same by footprints integrated in closed form.
void render_candidate(const CornerRays& rays,
                      const SceneSettings& scene,
                      std::vector<ImageF>& frames) {
  const Tunnel tunnel(scene.tunnel);
  const Footprints footprints(rays, tunnel, scene.scan, camera_position_mm(scene));
  const Spans everywhere = whole_image(rays.width_px, rays.height_px);
  FootprintFrames(footprints, everywhere).render(0, frames);
}

double best(const std::vector<double>& samples) {
  return *std::ranges::min_element(samples);
}

/// CPU seconds of each call.
template <class Work>
std::vector<double> time_repeats(int repeats, const Work& work) {
  std::vector<double> samples;
  for (int repeat = 0; repeat < repeats; ++repeat) {
    const double start_s = cpu_seconds();
    work();
    samples.push_back(cpu_seconds() - start_s);
  }
  return samples;
}

/// Times a candidate, cold and warm. @param trace gives a cache of rays from a BVH
template <class Trace>
Result measure(const SceneSettings& scene, const Part& part, int repeats, const Trace& trace) {
  const PinholeIntrinsics image = intrinsics_of(scene.camera);
  const std::vector<ImageF> dark(static_cast<std::size_t>(scene.scan.positions),
                                 ImageF(image.width_px, image.height_px));
  std::vector<ImageF> frames = dark;
  const auto cold_s = time_repeats(std::max(3, repeats / 5), [&] {
    std::vector<ImageF> fresh = dark;
    const Bvh bvh(part.mesh);
    render_candidate(trace(bvh), scene, fresh);
  });
  const Bvh bvh(part.mesh);
  const auto rays = trace(bvh);
  const auto warm_s = time_repeats(repeats, [&] { render_candidate(rays, scene, frames); });
  Result result;
  result.tool = "Glint";
  result.warm_s = best(warm_s);
  result.cold_s = best(cold_s);
  result.frame_s = result.warm_s / scene.scan.positions;
  result.frame = frames.front();
  result.samples_s = warm_s;
  result.notes = fmt::format(
      "all {} frames measured, best of {} (median {:.3g} s); cold: BVH, rays and frames, best of "
      "{} (median {:.3g} s), the mesh read before",
      scene.scan.positions,
      warm_s.size(),
      median(warm_s),
      cold_s.size(),
      median(cold_s));
  return result;
}

/// 1 where no pixel within reach has a value strictly between 0 and 1.
Mask away_from_edges(const ImageF& lit) {
  Mask inside(lit.width(), lit.height(), 1);
  for (int y = 0; y < lit.height(); ++y) {
    for (int x = 0; x < lit.width(); ++x) {
      if (lit(x, y) < 1e-6F || lit(x, y) > 1.0F - 1e-6F) {
        continue;
      }
      for (int v = std::max(0, y - kEdgeReach_px);
           v <= std::min(lit.height() - 1, y + kEdgeReach_px);
           ++v) {
        for (int u = std::max(0, x - kEdgeReach_px);
             u <= std::min(lit.width() - 1, x + kEdgeReach_px);
             ++u) {
          inside(u, v) = 0;
        }
      }
    }
  }
  return inside;
}

}  // namespace

std::vector<Result> measure_glint(const SceneSettings& scene, const Part& part, int repeats) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  ThreadPool pool(1);
  const PinholeCamera camera(intrinsics_of(scene.camera));
  const RigidTransform pose = camera_from_world(scene.viewpoint());
  const auto trace_corners = [&](const Bvh& bvh) {
    return trace_corner_rays(part, bvh, {}, camera, pose, scene.render, pool);
  };
  const auto trace_samples = [&](const Bvh& bvh) {
    return trace_rays(part, bvh, {}, camera, pose, scene.render, pool);
  };
  Result integrated = measure(scene, part, repeats, trace_corners);
  integrated.setting = "integrated, 1 ray/px";
  integrated.settings = {"1 thread; no sensor; all frames kept in memory as float"};
  Result sampled = measure(scene, part, repeats, trace_samples);
  sampled.setting =
      fmt::format("sampled, {} rays/px", scene.render.rays_per_axis * scene.render.rays_per_axis);
  sampled.settings = integrated.settings;
  return {integrated, sampled};
}

Reference render_reference(const SceneSettings& scene, const Part& part, int rays_per_axis) {
  ThreadPool pool(hardware_threads());
  const Bvh bvh(part.mesh);
  const Tunnel tunnel(scene.tunnel);
  StripePattern even = tunnel.pattern(0.0);
  even.duty = 2.0F;
  SceneSettings fine = scene;
  fine.render.rays_per_axis = rays_per_axis;
  const RigidTransform pose = camera_from_world(scene.viewpoint());
  const PinholeIntrinsics whole = intrinsics_of(scene.camera);
  Reference reference;
  reference.rays_per_pixel = rays_per_axis * rays_per_axis;
  reference.frame = ImageF(whole.width_px, whole.height_px);
  ImageF lit(whole.width_px, whole.height_px);
  for (int top = 0; top < whole.height_px; top += kReferenceRows) {
    PinholeIntrinsics window = whole;
    window.height_px = std::min(kReferenceRows, whole.height_px - top);
    window.center_px.y() -= top;
    const RayCache rays = trace_rays(part, bvh, {}, PinholeCamera(window), pose, fine.render, pool);
    const WallRays wall = intersect_wall(rays, tunnel, camera_position_mm(scene));
    ImageF rows;
    render_frame(rays, wall, tunnel.pattern(0.0), rows);
    std::ranges::copy(rows.values(), reference.frame.row(top));
    render_frame(rays, wall, even, rows);
    std::ranges::copy(rows.values(), lit.row(top));
  }
  reference.inside = away_from_edges(lit);
  return reference;
}

}  // namespace glint::peers

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/banded_scan.h"

#include <algorithm>

#include "core/cpu_clock.h"
#include "metrics/aspect_image/homogeneity.h"
#include "simulator/render/scan/scan.h"

namespace glint {
namespace {

using Eigen::Vector2d;

/// Does not touch contrast, only the contrast-to-noise ratio, which is not asked for here.
constexpr double kSigmaFloor = 1e-4;

/// The camera that sees some of the picture, pixel by pixel the same.
PinholeIntrinsics part_of(
    PinholeIntrinsics camera, int left_px, int top_px, int width_px, int height_px) {
  camera.width_px = width_px;
  camera.height_px = height_px;
  camera.center_px -= Vector2d(left_px, top_px);
  return camera;
}

void copy_rows(const ImageF& band, int top_px, ImageF& image) {
  std::copy(band.values().begin(), band.values().end(), image.row(top_px));
}

BandedScan empty_scan(const PinholeIntrinsics& camera, int positions) {
  BandedScan scan;
  scan.seen.width_px = camera.width_px;
  scan.seen.height_px = camera.height_px;
  const ImageF black(camera.width_px, camera.height_px);
  for (ImageF* image :
       {&scan.seen.coverage, &scan.seen.seen_x, &scan.seen.seen_y, &scan.seen.seen_z}) {
    *image = black;
  }
  scan.radiance.assign(static_cast<std::size_t>(positions), black);
  scan.lit = Mask(camera.width_px, camera.height_px);
  return scan;
}

/// Traces a band. A band that the part does not reach stays without rays; that the part is
/// in the picture at all, and the rays fit into memory, is known before.
RayCache trace_band(const BuiltPart& built,
                    const SurfaceDetail& detail,
                    const PinholeIntrinsics& camera,
                    const SceneSettings& scene,
                    ThreadPool& pool) {
  try {
    return trace_rays(built.part,
                      *built.bvh,
                      detail,
                      PinholeCamera(camera),
                      camera_from_world(scene.viewpoint()),
                      scene.render,
                      pool);
  } catch (const ConfigError&) {
    return {};
  }
}

/// All frames of a band, put into their rows of the picture.
void render_band(const RayCache& rays,
                 const SceneSettings& scene,
                 const Tunnel& tunnel,
                 int top_px,
                 BandedScan& scan) {
  const Eigen::Vector3d camera_mm = inverse(camera_from_world(scene.viewpoint())).translation_mm;
  const double step_mm = scan_step_mm(scene.scan, scene.tunnel);
  const WallRays wall = intersect_wall(rays, tunnel, camera_mm);
  ImageF band;
  for (std::size_t k = 0; k < scan.radiance.size(); ++k) {
    render_frame(rays, wall, tunnel.pattern(static_cast<double>(k) * step_mm), band);
    copy_rows(band, top_px, scan.radiance[k]);
  }
}

/// Finds the pixels of a band without an edge of the light in them, at any position.
void mark_lit(
    const RayCache& rays, const SceneSettings& scene, const Tunnel& tunnel, int top_px, Mask& lit) {
  const Eigen::Vector3d camera_mm = inverse(camera_from_world(scene.viewpoint())).translation_mm;
  const WallRays wall = intersect_wall(rays, tunnel, camera_mm);
  const double travel_mm = (scene.scan.positions - 1) * scan_step_mm(scene.scan, scene.tunnel);
  const double half_mm = 0.5 * scene.tunnel.length_mm;
  const auto pixels = static_cast<std::size_t>(rays.num_pixels());
  unsigned char* const first = lit.row(top_px);
  std::fill_n(first, pixels, static_cast<unsigned char>(1));
  for (std::size_t i = 0; i < wall.gain.size(); ++i) {
    const auto x_mm = static_cast<double>(wall.x_mm[i]);
    if (!(wall.gain[i] > 0.0F && x_mm > travel_mm - half_mm && x_mm < half_mm)) {
      first[i % pixels] = 0;
    }
  }
}

void keep_seen(const RayCache& rays, int top_px, RayCache& seen) {
  copy_rows(rays.coverage, top_px, seen.coverage);
  copy_rows(rays.seen_x, top_px, seen.seen_x);
  copy_rows(rays.seen_y, top_px, seen.seen_y);
  copy_rows(rays.seen_z, top_px, seen.seen_z);
  seen.counts.camera += rays.counts.camera;
  seen.counts.part += rays.counts.part;
  seen.counts.followed += rays.counts.followed;
  seen.counts.blocked += rays.counts.blocked;
  seen.counts.grazing += rays.counts.grazing;
}

/// What the pixels of each defect would show without it, frame by frame.
using FlawlessFrames = std::vector<std::vector<std::vector<float>>>;

class BandedEvaluation {
 public:
  BandedEvaluation(const BuiltDefects& part,
                   const SceneSettings& scene,
                   ThreadPool& pool,
                   const BandedSettings& settings)
      : part_(part), scene_(scene), pool_(pool), settings_(settings) {
    const PinholeIntrinsics camera = intrinsics_of(scene);
    result_.scan = scan_in_bands(*part.built, part.detail, camera, scene, pool, settings);
    const RayCache& seen = result_.scan.seen;
    views_ = view_defects(part.made.outlines,
                          seen,
                          PinholeCamera(camera),
                          camera_from_world(scene.viewpoint()),
                          scene.metrics.ring_outer_radii);
    defects_ = defect_pixels(views_, whole_pixels(seen.coverage), scene.metrics);
    result_.region = region_of_interest(seen.coverage, views_, scene.metrics);
    add_flawless(camera);
    result_.cpu_s = result_.scan.render_cpu_s + flawless_cpu_s_ +
                    min_cpu_s(settings.repeats, 0.0, [&] { score(); });
    result_.cold_cpu_s = result_.cpu_s + result_.scan.trace_cpu_s + flawless_trace_cpu_s_;
  }

  ScoredScan result() { return std::move(result_); }

 private:
  void add_flawless(const PinholeIntrinsics& camera) {
    BandedSettings quietly = settings_;
    quietly.on_band = nullptr;
    flawless_.resize(result_.scan.radiance.size());
    for (std::size_t k = 0; k < views_.size(); ++k) {
      const DefectView& view = views_[k];
      const PinholeIntrinsics window =
          part_of(camera, view.left_px, view.top_px, view.distance.width(), view.distance.height());
      const BandedScan scan =
          scan_in_bands(*part_.clean, SurfaceDetail(), window, scene_, pool_, quietly);
      flawless_cpu_s_ += scan.render_cpu_s;
      flawless_trace_cpu_s_ += scan.trace_cpu_s;
      const Sensor sensor(scene_.sensor, window.width_px, window.height_px);
      ImageF grey;
      for (std::size_t i = 0; i < flawless_.size(); ++i) {
        sensor.expose(scan.radiance[i], static_cast<int>(i), grey);
        std::vector<float>& values = flawless_[i].emplace_back();
        for (const std::size_t pixel : defects_[k].inside) {
          const auto at = static_cast<int>(pixel);
          values.push_back(
              grey(at % camera.width_px - view.left_px, at / camera.width_px - view.top_px));
        }
      }
    }
  }

  void score() {
    const PinholeIntrinsics camera = intrinsics_of(scene_);
    const Sensor sensor(scene_.sensor, camera.width_px, camera.height_px);
    ScanSums sums(camera.width_px, camera.height_px);
    BestFrames best(defects_);
    ImageF grey;
    for (std::size_t i = 0; i < result_.scan.radiance.size(); ++i) {
      sensor.accumulate(result_.scan.radiance[i], static_cast<int>(i), sums, &grey);
      best.add(grey, flawless_[i]);
    }
    const ImageF aspect = sums.aspect();
    const Homogeneity even =
        homogeneity(aspect, sums.clipped_frames, sums.frames, result_.region, scene_.metrics);
    result_.h_rms = even.h_rms;
    result_.defects = defect_scores(aspect, defects_, kSigmaFloor, scene_.metrics);
    for (std::size_t i = 0; i < result_.defects.size(); ++i) {
      result_.defects[i].best_frame = best.best()[i].difference;
      result_.defects[i].change = best.best()[i].change;
    }
    add_scores(result_.scores, even);
    add_scores(result_.scores, std::span<const DefectScores>(result_.defects));
  }

  const BuiltDefects& part_;
  const SceneSettings& scene_;
  ThreadPool& pool_;
  const BandedSettings& settings_;
  std::vector<DefectView> views_;
  std::vector<DefectPixels> defects_;
  FlawlessFrames flawless_;
  double flawless_cpu_s_ = 0.0;
  double flawless_trace_cpu_s_ = 0.0;
  ScoredScan result_;
};

}  // namespace

BandedScan scan_in_bands(const BuiltPart& built,
                         const SurfaceDetail& detail,
                         const PinholeIntrinsics& camera,
                         const SceneSettings& scene,
                         ThreadPool& pool,
                         const BandedSettings& settings) {
  const Tunnel tunnel(scene.tunnel);
  BandedScan scan = empty_scan(camera, scene.scan.positions);
  const std::int64_t per_row =
      std::int64_t{camera.width_px} * scene.render.rays_per_axis * scene.render.rays_per_axis;
  const int rows = static_cast<int>(std::max<std::int64_t>(1, settings.max_rays / per_row));
  for (int top = 0; top < camera.height_px; top += rows) {
    const int height = std::min(rows, camera.height_px - top);
    const double start = process_cpu_s();
    const RayCache rays =
        trace_band(built, detail, part_of(camera, 0, top, camera.width_px, height), scene, pool);
    scan.trace_cpu_s += process_cpu_s() - start;
    if (rays.samples > 0) {
      keep_seen(rays, top, scan.seen);
      scan.render_cpu_s +=
          min_cpu_s(settings.repeats, 0.0, [&] { render_band(rays, scene, tunnel, top, scan); });
      mark_lit(rays, scene, tunnel, top, scan.lit);
    } else {
      scan.seen.counts.camera += per_row * height;
    }
    if (settings.on_band) {
      settings.on_band(top + height);
    }
  }
  return scan;
}

ScoredScan evaluate_in_bands(const BuiltDefects& part,
                             const SceneSettings& scene,
                             ThreadPool& pool,
                             const BandedSettings& settings) {
  return BandedEvaluation(part, scene, pool, settings).result();
}

}  // namespace glint

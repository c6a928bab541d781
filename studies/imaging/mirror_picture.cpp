// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/mirror_picture.h"

#include <algorithm>
#include <utility>

#include "simulator/render/scan/closed_scan.h"
#include "simulator/render/scan/scan.h"
#include "simulator/sensor/sensor.h"
#include "studies/imaging/blurred/kept_ray_scan.h"

namespace glint {
namespace {

using Method = RenderSettings::Method;

MeanImage mean_of(ScanResult result, int frames) {
  MeanImage mean = {.aspect = std::move(result.aspect),
                    .clipped_frames = std::move(result.sums.clipped_frames),
                    .frames = frames,
                    .hidden_share = result.hidden_share};
  mean.form.frame_pixels = static_cast<int>(mean.aspect.size());
  return mean;
}

class MirrorPicture : public ScenePicture {
 public:
  MirrorPicture(SceneStore& store, const SceneSettings& scene, bool has_flawless)
      : ScenePicture(scene, store.trace(scene)), store_(store), kept_rays_(scene, store.pool()) {
    if (has_flawless) {
      render_flawless();
    }
  }

  bool has_whole_frames(bool is_consumed, bool wants_fringes) const override {
    const Method method = scene().render.method;
    return traced()->is_sampled() || is_consumed || method == Method::kIntegrated ||
           (wants_fringes && method != Method::kClosed);
  }

  MeanImage mean(const MeanRequest& request) const override {
    const VisibilityBuffer& seen = traced()->seen();
    auto sensor = std::make_unique<const Sensor>(scene().sensor, seen.width_px, seen.height_px);
    const int positions = scene().scan.positions;
    if (traced()->is_sampled()) {
      const Eigen::Vector3d& camera_mm = traced()->camera_in_world_mm;
      return mean_of(kept_rays_.scan(traced()->rays, *sensor, camera_mm, request.watch), positions);
    }
    auto footprints = std::make_unique<const Footprints>(footprints_of(traced()->corners));
    if (request.has_whole_frames) {
      return mean_of(scan_integrated(*footprints, *sensor, request.watch), positions);
    }
    return closed_mean(std::move(footprints), std::move(sensor), request);
  }

  DefectValues flawless(int frame, std::optional<std::size_t> /*without*/) const override {
    return flawless_.empty() ? DefectValues() : flawless_[static_cast<std::size_t>(frame)];
  }

  const RayCounts* ray_counts() const override { return &traced()->counts(); }

  /// Bounds of what was scored, not of a twin.
  SceneSettings repeated(bool has_whole_frames) const override {
    SceneSettings same_form = scene();
    if (has_whole_frames && !traced()->is_sampled()) {
      same_form.render.method = Method::kIntegrated;
    }
    return same_form;
  }

 private:
  Footprints footprints_of(const CornerRays& rays) const {
    const Tunnel& tunnel = kept_rays_.tunnel();
    return {rays, tunnel, scene().scan, store_.intersect(traced(), rays, tunnel)};
  }

  MeanImage closed_mean(std::unique_ptr<const Footprints> footprints,
                        std::unique_ptr<const Sensor> sensor,
                        const MeanRequest& request) const {
    const Mask none;
    ScanPlan plan = plan_scan(*footprints,
                              *sensor,
                              traced()->region,
                              request.watch ? traced()->watched : none,
                              scene().render.reflectance);
    ClosedScan closed =
        scan_closed(*footprints, *sensor, plan, request.watch, &store_.frame_pictures());
    MeanImage mean = {.aspect = std::move(closed.aspect),
                      .deviation = std::move(closed.deviation),
                      .clipped_frames = std::move(closed.clipped_frames),
                      .frames = scene().scan.positions,
                      .form = closed.form,
                      .hidden_share = footprints->hidden_share()};
    if (request.keeps_closed_form) {
      mean.closed = std::make_unique<ClosedForm>(ClosedForm{.footprints = std::move(footprints),
                                                            .sensor = std::move(sensor),
                                                            .plan = std::move(plan),
                                                            .cells = std::move(closed.cells)});
    }
    return mean;
  }

  void render_flawless() {
    flawless_.resize(static_cast<std::size_t>(scene().scan.positions));
    const double dark = dark_grey(scene().sensor);
    for (std::size_t k = 0; k < traced()->defects.size(); ++k) {
      const DefectView& view = traced()->views[k];
      const auto keep = [&](int index, const ImageF& grey) {
        std::vector<float>& values = flawless_[static_cast<std::size_t>(index)].emplace_back();
        for (const std::size_t pixel : traced()->defects[k].inside) {
          const auto at = static_cast<int>(pixel);
          const int width = traced()->seen().width_px;
          const float value = grey(at % width - view.left_px, at / width - view.top_px);
          values.push_back(std::min(1.0F, value + static_cast<float>(dark)));
        }
      };
      scan_flawless(k, keep);
    }
  }

  /// A defect's own pixels in its window.
  Spans inside_of(std::size_t defect) const {
    const DefectView& view = traced()->views[defect];
    Mask inside(view.distance.width(), view.distance.height());
    for (const std::size_t pixel : traced()->defects[defect].inside) {
      const auto at = static_cast<int>(pixel);
      const int width = traced()->seen().width_px;
      inside(at % width - view.left_px, at / width - view.top_px) = 1;
    }
    return spans_of(inside);
  }

  void scan_flawless(std::size_t defect, const FrameConsumer& keep) const {
    const SensorSettings quiet = without_noise(scene().sensor);
    if (traced()->is_sampled()) {
      const RayCache& rays = traced()->flawless[defect];
      const Sensor sensor(quiet, rays.width_px, rays.height_px);
      kept_rays_.scan(rays, sensor, traced()->camera_in_world_mm, keep);
    } else {
      const CornerRays& rays = traced()->flawless_corners[defect];
      const Sensor sensor(quiet, rays.width_px, rays.height_px);
      watch_integrated(footprints_of(rays), sensor, inside_of(defect), keep);
    }
  }

  SceneStore& store_;
  KeptRayScan kept_rays_;               ///< and of footprints the tunnel
  std::vector<DefectValues> flawless_;  ///< frame by frame; empty: not asked for
};

}  // namespace

std::unique_ptr<ScenePicture> mirror_picture(SceneStore& store,
                                             const SceneSettings& scene,
                                             const PictureRequest& request) {
  check_part_in_tunnel(store, scene);
  return std::make_unique<MirrorPicture>(store, scene, request.has_flawless);
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/mirror_line.h"

#include <utility>

#include "core/image/spans.h"
#include "core/rng.h"
#include "simulator/render/corner_rays/changed_pixels.h"
#include "simulator/render/scan/closed_scan.h"
#include "simulator/render/scan/expected_scan.h"
#include "simulator/sensor/sensor_kernels.h"
#include "studies/imaging/blurred/kept_ray_scan.h"
#include "studies/imaging/blurred/kept_rays.h"

namespace glint {
namespace {

using Method = RenderSettings::Method;

/// Adds a normal number times the deviation to each pixel: what closed forms leave out.
void noise_variance(const ImageF& deviation, int seed, ImageF& aspect) {
  namespace kernels = sensor_kernels;
  const int width = aspect.width();
  const int blocks = (width + 3) / 4;
  std::vector<std::uint32_t> words(4 * static_cast<std::size_t>(blocks));
  std::vector<float> normals(words.size());
  for (int y = 0; y < aspect.height(); ++y) {
    const kernels::NoiseAddress address = {
        .key = {static_cast<std::uint32_t>(seed), 0},
        .stream = static_cast<std::uint32_t>(Stream::kAspectNoise),
        .frame = static_cast<std::uint32_t>(y)};
    kernels::philox_words(address, 0, blocks, words.data());
    kernels::normal_quantiles(words.data(), width, normals.data());
    const float* sigma = deviation.row(y);
    float* row = aspect.row(y);
    for (int x = 0; x < width; ++x) {
      row[x] += sigma[x] * normals[static_cast<std::size_t>(x)];
    }
  }
}

/// What the camera's rays meet, however they are traced.
struct SeenSurface {
  std::shared_ptr<const RayCache> sampled;
  std::shared_ptr<const CornerRays> corners;

  const VisibilityBuffer& seen() const {
    return sampled ? static_cast<const VisibilityBuffer&>(*sampled) : *corners;
  }
};

class MirrorLine : public LineCamera {
 public:
  MirrorLine(const SceneSettings& scene,
             std::shared_ptr<const TracedScene> traced,
             SceneStore& store)
      : scene_(scene),
        kept_rays_(scene, store.pool()),
        camera_(intrinsics_of(scene)),
        traced_(std::move(traced)),
        store_(store) {
    clean_ = traced_->is_sampled()
                 ? SeenSurface{.sampled = {traced_, &traced_->rays}, .corners = {}}
                 : SeenSurface{.sampled = {}, .corners = {traced_, &traced_->corners}};
    clean_footprints_ = footprints_of(clean_);
    if (clean_footprints_) {
      expected_ = expected_scan(*clean_footprints_, scene_.sensor);
    }
  }

  ExpectedLine expected() const override {
    ExpectedLine line;
    line.quiet = scan_frames(clean_, clean_footprints_.get(), without_noise(scene_.sensor));
    line.aspect = clean_footprints_ ? expected_.aspect : line.quiet.aspect;
    return line;
  }

  LineScan flawless(const SensorSettings& sensor) const override {
    return scan(clean_, clean_footprints_.get(), sensor);
  }

  LineScan part(const BuiltDefects& part, const SensorSettings& sensor) const override {
    const SeenSurface surface = see(part);
    const auto footprints = footprints_of(surface);
    return scan(surface, footprints.get(), sensor);
  }

 private:
  SeenSurface see(const BuiltDefects& part) const {
    const RigidTransform& pose = traced_->camera_from_world;
    const BuiltPart& built = *part.built;
    SeenSurface surface;
    if (traced_->is_sampled()) {
      surface.sampled = std::make_shared<const RayCache>(trace_kept_rays(
          scene_, built.part, *built.bvh, part.detail, camera_, pose, store_.pool()));
    } else if (part.built == part.clean) {
      surface.corners = std::make_shared<const CornerRays>(retrace_detail(traced_->corners,
                                                                          built.part,
                                                                          *built.bvh,
                                                                          part.detail,
                                                                          {camera_, pose},
                                                                          scene_.render,
                                                                          store_.pool())
                                                               .rays);
    } else {
      surface.corners = std::make_shared<const CornerRays>(trace_corner_rays(
          built.part, *built.bvh, part.detail, camera_, pose, scene_.render, store_.pool()));
    }
    return surface;
  }

  std::shared_ptr<const Footprints> footprints_of(const SeenSurface& surface) const {
    return surface.sampled ? nullptr
                           : std::make_shared<const Footprints>(*surface.corners,
                                                                kept_rays_.tunnel(),
                                                                scene_.scan,
                                                                traced_->camera_in_world_mm);
  }

  bool has_phases() const { return scene_.inspection.filter == InspectionSettings::Filter::kPhase; }

  /// All frames of one scan.
  LineScan scan_frames(const SeenSurface& surface,
                       const Footprints* footprints,
                       const SensorSettings& settings) const {
    const VisibilityBuffer& seen = surface.seen();
    const Sensor sensor(settings, seen.width_px, seen.height_px);
    LineScan scan;
    const auto keep = [&](int, const ImageF& grey) { scan.frames.push_back(grey); };
    const FrameConsumer consume = has_phases() ? FrameConsumer(keep) : FrameConsumer();
    if (footprints == nullptr) {
      const Eigen::Vector3d& camera_mm = traced_->camera_in_world_mm;
      scan.aspect = kept_rays_.scan(*surface.sampled, sensor, camera_mm, consume).aspect;
    } else {
      scan.aspect = scan_integrated(*footprints, sensor, consume).aspect;
    }
    return scan;
  }

  /// The flawless part's expected scan with the noise of one, and frames rendered only where the
  /// part differs from it.
  LineScan scan_changes(const SeenSurface& surface,
                        const Footprints& footprints,
                        const SensorSettings& settings) const {
    LineScan scan;
    scan.aspect = expected_.aspect;
    if (settings.full_well_e > 0.0) {
      noise_variance(expected_.deviation, settings.seed, scan.aspect);
    }
    if (surface.corners != clean_.corners) {
      const Sensor sensor(settings, scan.aspect.width(), scan.aspect.height());
      ScanPlan plan;
      plan.by_frames =
          dilated(changed_pixels(*clean_.corners, *surface.corners), sensor.blur_radius_px());
      const ClosedScan changed =
          scan_closed(footprints, sensor, plan, {}, &store_.frame_pictures());
      for (std::size_t i = 0; i < changed.aspect.size(); ++i) {
        if (plan.by_frames.values()[i] != 0) {
          scan.aspect.values()[i] = changed.aspect.values()[i];
        }
      }
    }
    return scan;
  }

  LineScan scan(const SeenSurface& surface,
                const Footprints* footprints,
                const SensorSettings& settings) const {
    const bool is_whole =
        surface.sampled != nullptr || has_phases() || scene_.render.method == Method::kIntegrated;
    LineScan scan = is_whole ? scan_frames(surface, footprints, settings)
                             : scan_changes(surface, *footprints, settings);
    if (surface.sampled) {
      scan.seen = surface.sampled;
    } else {
      scan.seen = surface.corners;
    }
    return scan;
  }

  SceneSettings scene_;
  KeptRayScan kept_rays_;  ///< and of footprints the tunnel
  PinholeCamera camera_;
  std::shared_ptr<const TracedScene> traced_;  ///< of the flawless part
  SceneStore& store_;
  SeenSurface clean_;
  std::shared_ptr<const Footprints> clean_footprints_;
  ExpectedScan expected_;  ///< of the flawless part; empty: sampled
};

}  // namespace

std::unique_ptr<LineCamera> mirror_line(const SceneSettings& scene,
                                        std::shared_ptr<const TracedScene> traced,
                                        SceneStore& store) {
  return std::make_unique<MirrorLine>(scene, std::move(traced), store);
}

}  // namespace glint

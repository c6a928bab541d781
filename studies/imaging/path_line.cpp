// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/path_line.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "core/error.h"
#include "simulator/render/path_tracing/film.h"
#include "simulator/render/path_tracing/path_settings.h"
#include "simulator/render/path_tracing/smooth_picture.h"
#include "studies/imaging/defect_windows.h"
#include "studies/imaging/direct/direct_film.h"
#include "studies/imaging/frame_exposure.h"
#include "studies/imaging/line_store.h"
#include "studies/imaging/path_changes.h"
#include "studies/imaging/path_lights.h"
#include "studies/imaging/path_picture.h"

namespace glint {
namespace {

/// The two halves of all samples; both seeds differ from those of other pictures of the scene.
PathSettings half_of(PathSettings settings, int half) {
  constexpr std::uint32_t kSeedStep = 0x51ed270;
  constexpr std::uint32_t kPositive = 0x7fffffff;
  const std::uint32_t seed = static_cast<std::uint32_t>(settings.seed) ^ kSeedStep;
  settings.samples = (settings.samples + 1) / 2;
  settings.seed = static_cast<int>((seed + static_cast<std::uint32_t>(half)) & kPositive);
  settings.relative_error = 0.0;  // the same samples with and without defects
  return settings;
}

/// The factors of one channel of a frame in the order of groups and channels; 0 for the others.
std::vector<float> weights_of(const FrameFactors& factors, int channel, int channels) {
  std::vector<float> weights;
  for (const Colour& factor : factors) {
    for (int c = 0; c < channels; ++c) {
      weights.push_back(c == channel ? static_cast<float>(factor[c]) : 0.0F);
    }
  }
  return weights;
}

ImageF radiance_of(const PathBatch& batch, const std::vector<float>& weights) {
  ImageF image(batch.samples.width(), batch.samples.height());
  std::size_t next = 0;
  for (const GroupSums& group : batch.groups) {
    for (const ImageF& channel : group.channels) {
      const float weight = weights[next++];
      for (std::size_t i = 0; i < image.size() && weight != 0.0F; ++i) {
        image.values()[i] += weight * channel.values()[i];
      }
    }
  }
  for (std::size_t i = 0; i < image.size(); ++i) {
    image.values()[i] /= static_cast<float>(std::max(1, batch.samples.values()[i]));
  }
  return image;
}

class PathLine : public LineCamera {
 public:
  PathLine(const SceneSettings& scene, std::shared_ptr<const TracedScene> traced, SceneStore& store)
      : scene_(scene),
        traced_(std::move(traced)),
        store_(store),
        view_(scene, traced_->part, scene.viewpoint(), false),
        key_(flawless_key(scene)) {
    scene_.paths = path_settings(scene);
    rendering_ = store_.lines().flawless.get(key_, [this] { return render_flawless(); });
    learn();
  }

  ExpectedLine expected() const override { return expected_; }

  LineScan flawless(const SensorSettings& sensor) const override {
    return expose(radiance_, {}, sensor);
  }

  LineScan part(const BuiltDefects& part, const SensorSettings& sensor) const override {
    if (part.built != part.clean) {  // meshes are too large for keys
      return expose(radiance_, changes_of(render_changes(part)), sensor);
    }
    const std::string key = key_ + digest_of(part.detail);
    const auto changes = store_.lines().changes.get(key, [&] { return render_changes(part); });
    return expose(radiance_, changes_of(*changes), sensor);
  }

 private:
  struct Rendered {
    Film sums;
    PathBatch batch;
  };

  const PinholeIntrinsics& picture() const { return view_.physical().camera.intrinsics(); }

  std::size_t num_channels() const { return static_cast<std::size_t>(scene_.paths.channels); }

  /// Light without noise: both halves are the same, and nothing is told of them.
  bool is_summed() const { return view_.direct().has_value(); }

  bool has_phases() const { return scene_.inspection.filter == InspectionSettings::Filter::kPhase; }

  /// The scene with another part. @param windows  empty: the whole picture
  Rendered render(const BuiltDefects& part, std::span<const PixelWindow> windows, int half) const {
    const PhysicalScene& flawless = view_.physical();
    const PhysicalScene physical = {.part = part.built->part,
                                    .bvh = *part.built->bvh,
                                    .detail = part.detail,
                                    .material = flawless.material,
                                    .lights = flawless.lights,
                                    .camera = flawless.camera,
                                    .camera_from_world = flawless.camera_from_world,
                                    .lens = flawless.lens};
    PathSettings settings = half_of(scene_.paths, half);
    settings.windows.assign(windows.begin(), windows.end());
    Rendered rendered;
    rendered.sums = is_summed() ? direct_film(physical, settings, *view_.direct(), store_.pool())
                                : render_paths(physical, settings, store_.pool());
    rendered.batch = {.samples = std::move(rendered.sums.samples),
                      .groups = std::move(rendered.sums.groups)};
    return rendered;
  }

  /// How far a point's light spreads on the picture because it is out of focus, in pixels.
  double blur_px() const {
    const ThinLens& lens = view_.physical().lens;
    if (lens.aperture_mm <= 0.0) {
      return 0.0;
    }
    const double distance_mm = traced_->camera_in_world_mm.norm();
    return 0.5 * circle_of_confusion_mm(
                     lens.aperture_mm, lens.focus_mm, picture().focal_px.maxCoeff(), distance_mm);
  }

  RenderedChanges render_changes(const BuiltDefects& part) const {
    const std::vector<PixelWindow> windows =
        defect_windows(part, *traced_, view_.physical().camera, blur_px());
    if (windows.empty()) {
      return {};
    }
    const PathBatch half = render(part, windows, 0).batch;
    return changes_between(rendering_->halves,
                           {half, is_summed() ? half : render(part, windows, 1).batch});
  }

  FrameChanges changes_of(const RenderedChanges& rendered) const {
    FrameChanges changes =
        frame_changes(rendered, weights_, picture().width_px, picture().height_px);
    if (is_summed()) {
      std::ranges::fill(changes.gains, 1.0F);
    }
    return changes;
  }

  static std::string flawless_key(SceneSettings scene) {
    scene.defects.clear();
    scene.imprint = {};
    return picture_key(scene, scene.viewpoint());
  }

  static std::vector<ImageF> changed_frame(std::span<const ImageF> shown,
                                           const FrameChanges& changes,
                                           std::size_t frame) {
    std::vector<ImageF> changed(shown.begin(), shown.end());
    for (std::size_t c = 0; c < changed.size(); ++c) {
      add_changes(changes, frame * changed.size() + c, changed[c]);
    }
    return changed;
  }

  /// One scan of a part. @param radiance  of each channel of each frame without the changes
  LineScan expose(const std::vector<ImageF>& radiance,
                  const FrameChanges& changes,
                  const SensorSettings& settings) const {
    const Sensor sensor(settings, picture().width_px, picture().height_px);
    ScanSums sums(picture().width_px, picture().height_px);
    LineScan scan;
    scan.seen = {traced_, &traced_->seen()};
    const std::size_t channels = num_channels();
    std::vector<ImageF> changed;
    ImageF grey;
    for (std::size_t k = 0; k < view_.frames().size(); ++k) {
      std::span<const ImageF> shown = std::span(radiance).subspan(k * channels, channels);
      if (!changes.pixels.empty()) {
        changed = changed_frame(shown, changes, k);
        shown = changed;
      }
      accumulate_channels(sensor, shown, static_cast<int>(k), sums, has_phases() ? &grey : nullptr);
      if (has_phases()) {
        scan.frames.push_back(grey);
      }
    }
    scan.aspect = sums.aspect();
    if (!is_summed()) {
      scan.changes = mean_changes(changes, picture().width_px, picture().height_px);
    }
    return scan;
  }

  FlawlessRendering render_flawless() const {
    Rendered first = render(*traced_->part, {}, 0);
    FlawlessRendering rendering;
    rendering.halves = {first.batch,
                        is_summed() ? first.batch : render(*traced_->part, {}, 1).batch};
    first.sums.samples = rendering.halves[0].samples;
    rendering.surface = surface_images(first.sums);
    rendering.coverage = coverage_images(first.sums);
    return rendering;
  }

  /// What is expected of all frames.
  void learn() {
    for (const FrameFactors& factors : view_.frames()) {
      for (int c = 0; c < scene_.paths.channels; ++c) {
        weights_.push_back(weights_of(factors, c, scene_.paths.channels));
      }
    }
    std::vector<RenderedTwice> frames;
    for (const std::vector<float>& weights : weights_) {
      frames.push_back({radiance_of(rendering_->halves[0], weights),
                        radiance_of(rendering_->halves[1], weights)});
    }
    if (!is_summed()) {
      smooth(rendering_->surface, rendering_->coverage, frames, store_.pool());
    }
    std::array<std::vector<ImageF>, 2> halves;
    for (RenderedTwice& frame : frames) {
      ImageF mean(picture().width_px, picture().height_px);
      for (std::size_t i = 0; i < mean.size(); ++i) {
        for (ImageF& half : frame) {
          half.values()[i] = std::max(0.0F, half.values()[i]);
        }
        mean.values()[i] = 0.5F * (frame[0].values()[i] + frame[1].values()[i]);
      }
      radiance_.push_back(std::move(mean));
      halves[0].push_back(std::move(frame[0]));
      halves[1].push_back(std::move(frame[1]));
    }
    expose_expected(halves);
  }

  void expose_expected(const std::array<std::vector<ImageF>, 2>& halves) {
    SensorSettings quiet = without_noise(scene_.sensor);
    const bool has_noise = scene_.sensor.full_well_e > 0.0;
    quiet.bits = has_noise ? 0 : quiet.bits;  // rounding is lost in the noise
    expected_.quiet = expose(radiance_, {}, quiet);
    expected_.aspect = expected_.quiet.aspect;
    if (has_noise) {
      const double dark = dark_grey(scene_.sensor);
      for (float& value : expected_.aspect.values()) {
        value = std::min(1.0F, value + static_cast<float>(dark));
      }
    }
    if (is_summed()) {
      return;
    }
    for (const std::vector<ImageF>& half : halves) {
      expected_.renderings.push_back(expose(half, {}, quiet));
    }
  }

  SceneSettings scene_;
  std::shared_ptr<const TracedScene> traced_;  ///< of the flawless part
  SceneStore& store_;
  PathView view_;    ///< of the flawless part
  std::string key_;  ///< of the flawless part's rendering
  std::shared_ptr<const FlawlessRendering> rendering_;
  std::vector<std::vector<float>> weights_;  ///< of each channel of each frame: weights_of()
  std::vector<ImageF> radiance_;             ///< of the same on the flawless part, smoothed
  ExpectedLine expected_;
};

}  // namespace

std::unique_ptr<LineCamera> path_line(const SceneSettings& scene,
                                      std::shared_ptr<const TracedScene> traced,
                                      SceneStore& store) {
  return std::make_unique<PathLine>(scene, std::move(traced), store);
}

}  // namespace glint

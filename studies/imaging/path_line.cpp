// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/path_line.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "core/error.h"
#include "simulator/render/path_tracing/path_settings.h"
#include "simulator/render/path_tracing/path_sums.h"
#include "simulator/render/path_tracing/smooth_picture.h"
#include "studies/imaging/frame_exposure.h"
#include "studies/imaging/line_store.h"
#include "studies/imaging/path_lights.h"
#include "studies/imaging/path_picture.h"

namespace glint {
namespace {

using Halves = std::array<PathBatch, 2>;

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

/// A box that grows.
struct PixelBox {
  double left = 1e9;
  double top = 1e9;
  double right = -1e9;
  double bottom = -1e9;

  void add(double x, double y) {
    left = std::min(left, x);
    top = std::min(top, y);
    right = std::max(right, x);
    bottom = std::max(bottom, y);
  }
};

/// Whole pixels of a picture, with a margin; without area where the box is empty.
PixelWindow window_of(const PixelBox& box, double margin_px, int width_px, int height_px) {
  const auto bound = [](double value, int most) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(most)));
  };
  const int left = bound(std::floor(box.left - margin_px), width_px);
  const int top = bound(std::floor(box.top - margin_px), height_px);
  const int right = bound(std::ceil(box.right + margin_px), width_px);
  const int bottom = bound(std::ceil(box.bottom + margin_px), height_px);
  return {.left_px = left, .top_px = top, .width_px = right - left, .height_px = bottom - top};
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

/// Whether two pictures differ in a pixel that both were rendered in.
bool differs(const PathBatch& a, const PathBatch& b, std::size_t pixel) {
  for (std::size_t g = 0; g < a.groups.size(); ++g) {
    for (std::size_t c = 0; c < a.groups[g].channels.size(); ++c) {
      if (a.groups[g].channels[c].values()[pixel] != b.groups[g].channels[c].values()[pixel]) {
        return true;
      }
    }
  }
  return false;
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
    PathSums sums;
    PathBatch batch;
  };

  /// What defects add to the channels of the frames, in the pixels that were rendered.
  struct Changes {
    std::vector<std::size_t> pixels;
    std::vector<std::array<float, 2>> values;  ///< channel by channel, of both halves
    std::vector<float> gains;                  ///< of each pixel: see gains_of()
  };

  const PinholeIntrinsics& picture() const { return view_.physical().camera.intrinsics(); }

  std::size_t num_channels() const { return static_cast<std::size_t>(scene_.paths.channels); }

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
    Rendered rendered = {.sums = render_paths(physical, settings, store_.pool()), .batch = {}};
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

  /// Where the camera sees the defects: light that they send elsewhere on the part is left out.
  std::vector<PixelWindow> windows_of(const BuiltDefects& part) const {
    std::map<std::int32_t, PixelBox> boxes;
    std::int32_t next = -1;  // ids of imprinted defects are positive
    for (const HeightFeature& outline : part.made.outlines) {
      add_outline(outline, boxes[next--]);
    }
    const TriangleMesh& mesh = part.built->part.mesh;
    for (std::size_t t = 0; t < part.made.labels.size(); ++t) {
      if (part.made.labels[t] > 0) {
        add_triangle(mesh, t, boxes[part.made.labels[t]]);
      }
    }
    std::vector<PixelWindow> windows;
    for (const auto& [id, box] : boxes) {
      const PixelWindow window =
          window_of(box, 1.0 + blur_px(), picture().width_px, picture().height_px);
      if (window.width_px > 0 && window.height_px > 0) {
        windows.push_back(window);
      }
    }
    return windows;
  }

  void add_outline(const HeightFeature& outline, PixelBox& box) const {
    DefectView view;
    try {
      view = view_defects({&outline, 1},
                          traced_->seen(),
                          view_.physical().camera,
                          traced_->camera_from_world,
                          SurfaceDetail::kReachRadii)
                 .front();
    } catch (const ConfigError&) {
      return;  // outside the picture
    }
    for (int y = 0; y < view.distance.height(); ++y) {
      for (int x = 0; x < view.distance.width(); ++x) {
        if (static_cast<double>(view.distance(x, y)) <= SurfaceDetail::kReachRadii) {
          box.add(x + view.left_px, y + view.top_px);
          box.add(x + view.left_px + 1, y + view.top_px + 1);
        }
      }
    }
  }

  void add_triangle(const TriangleMesh& mesh, std::size_t triangle, PixelBox& box) const {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto seen = view_.physical().camera.project(traced_->camera_from_world *
                                                        mesh.vertex(triangle, corner));
      if (seen) {
        box.add(seen->x(), seen->y());
      }
    }
  }

  static std::string flawless_key(SceneSettings scene) {
    scene.defects.clear();
    scene.imprint = {};
    return picture_key(scene, scene.viewpoint());
  }

  RenderedChanges render_changes(const BuiltDefects& part) const {
    RenderedChanges changes;
    const std::vector<PixelWindow> windows = windows_of(part);
    if (windows.empty()) {
      return changes;
    }
    const Halves with = {render(part, windows, 0).batch, render(part, windows, 1).batch};
    const Halves& without = rendering_->halves;
    for (std::size_t i = 0; i < with[0].samples.size(); ++i) {
      if (with[0].samples.values()[i] > 0 &&
          (differs(with[0], without[0], i) || differs(with[1], without[1], i))) {
        changes.pixels.push_back(i);
      }
    }
    for (std::size_t half = 0; half < 2; ++half) {
      for (std::size_t g = 0; g < with[half].groups.size(); ++g) {
        for (std::size_t c = 0; c < with[half].groups[g].channels.size(); ++c) {
          for (const std::size_t i : changes.pixels) {
            changes.values[half].push_back((with[half].groups[g].channels[c].values()[i] -
                                            without[half].groups[g].channels[c].values()[i]) /
                                           static_cast<float>(with[half].samples.values()[i]));
          }
        }
      }
    }
    return changes;
  }

  Changes changes_of(const RenderedChanges& rendered) const {
    Changes changes;
    changes.pixels = rendered.pixels;
    const std::size_t count = rendered.pixels.size();
    for (const std::vector<float>& weights : weights_) {
      for (std::size_t i = 0; i < count; ++i) {
        std::array<float, 2> sums = {};
        for (std::size_t s = 0; s < weights.size(); ++s) {
          sums[0] += weights[s] * rendered.values[0][s * count + i];
          sums[1] += weights[s] * rendered.values[1][s * count + i];
        }
        changes.values.push_back(sums);
      }
    }
    changes.gains = gains_of(changes);
    return changes;
  }

  /// What two halves tell about the changes around a pixel.
  struct Agreement {
    double product = 0.0;
    double square = 0.0;
    double count = 0.0;

    void add(const Agreement& other) {
      product += other.product;
      square += other.square;
      count += other.count;
    }
  };

  /// Root of the share of squared change around each pixel that both halves agree on: with it as a
  /// factor, noise of the rendering adds nothing to the squared change on average.
  std::vector<float> gains_of(const Changes& changes) const {
    constexpr int kAround = 4;
    Image<Agreement> at(picture().width_px, picture().height_px);
    for (std::size_t i = 0; i < changes.values.size(); ++i) {
      const auto a = static_cast<double>(changes.values[i][0]);
      const auto b = static_cast<double>(changes.values[i][1]);
      at.values()[changes.pixels[i % changes.pixels.size()]].add(
          {.product = a * b,
           .square = 0.25 * (a + b) * (a + b),
           .count = a != 0.0 || b != 0.0 ? 1.0 : 0.0});
    }
    std::vector<float> gains;
    for (const std::size_t pixel : changes.pixels) {
      const int x = static_cast<int>(pixel % static_cast<std::size_t>(at.width()));
      const int y = static_cast<int>(pixel / static_cast<std::size_t>(at.width()));
      Agreement all;
      for (int v = std::max(0, y - kAround); v <= std::min(at.height() - 1, y + kAround); ++v) {
        for (int u = std::max(0, x - kAround); u <= std::min(at.width() - 1, x + kAround); ++u) {
          all.add(at(u, v));
        }
      }
      gains.push_back(
          static_cast<float>(std::sqrt(agreed_share(all.product, all.square, all.count))));
    }
    return gains;
  }

  /// One scan of a part. @param radiance  of each channel of each frame without the changes
  LineScan expose(const std::vector<ImageF>& radiance,
                  const Changes& changes,
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
        changed.assign(shown.begin(), shown.end());
        for (std::size_t c = 0; c < channels; ++c) {
          add_changes(changes, k * channels + c, changed[c]);
        }
        shown = changed;
      }
      accumulate_channels(sensor, shown, static_cast<int>(k), sums, has_phases() ? &grey : nullptr);
      if (has_phases()) {
        scan.frames.push_back(grey);
      }
    }
    scan.aspect = sums.aspect();
    scan.changes = mean_changes(changes);
    return scan;
  }

  /// @param index  of the channel among those of all frames
  static void add_changes(const Changes& changes, std::size_t index, ImageF& radiance) {
    const std::size_t first = index * changes.pixels.size();
    for (std::size_t i = 0; i < changes.pixels.size(); ++i) {
      float& value = radiance.values()[changes.pixels[i]];
      const std::array<float, 2>& halves = changes.values[first + i];
      value = std::max(0.0F, value + 0.5F * changes.gains[i] * (halves[0] + halves[1]));
    }
  }

  std::vector<ImageF> mean_changes(const Changes& changes) const {
    std::vector<ImageF> means;
    const std::size_t count = changes.pixels.size();
    for (std::size_t half = 0; half < 2 && count > 0; ++half) {
      ImageF mean(picture().width_px, picture().height_px);
      for (std::size_t i = 0; i < changes.values.size(); ++i) {
        mean.values()[changes.pixels[i % count]] +=
            changes.values[i][half] / static_cast<float>(weights_.size());
      }
      means.push_back(std::move(mean));
    }
    return means;
  }

  FlawlessRendering render_flawless() const {
    Rendered first = render(*traced_->part, {}, 0);
    FlawlessRendering rendering;
    rendering.halves = {std::move(first.batch), render(*traced_->part, {}, 1).batch};
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
    smooth(rendering_->surface, rendering_->coverage, frames, store_.pool());
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

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/path_scene_picture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include "core/error.h"
#include "core/image/spans.h"
#include "metrics/statistics/estimate.h"
#include "simulator/render/footprint/visible_part.h"
#include "simulator/render/wall/occluded_pixels.h"
#include "simulator/sensor/sensor.h"
#include "studies/definition/render_methods.h"
#include "studies/imaging/frame_exposure.h"
#include "studies/imaging/path_lights.h"
#include "studies/imaging/path_picture.h"

namespace glint {
namespace {

/// What can be told of a scene by path tracing.
void check_scene(const SceneSettings& scene, const PictureRequest& request) {
  if (!is_lit(scene)) {
    throw ConfigError("lighting", "holds no light, scores need one");
  }
  if (!scene.paths.has_light) {
    throw ConfigError("render.paths.light", "is false, scores need light");
  }
  if (request.has_derivatives) {
    throw ConfigError("search.algorithm",
                      "needs derivatives, which path-traced scenes do not have; allowed are "
                      "algorithms without");
  }
}

/// The box around some pixels of the picture, and so much around it.
PixelWindow window_around(const std::vector<std::size_t>& pixels,
                          int margin_px,
                          const VisibilityBuffer& seen) {
  int left = seen.width_px;
  int top = seen.height_px;
  int right = 0;
  int bottom = 0;
  for (const std::size_t pixel : pixels) {
    const int x = static_cast<int>(pixel) % seen.width_px;
    const int y = static_cast<int>(pixel) / seen.width_px;
    left = std::min(left, x);
    right = std::max(right, x + 1);
    top = std::min(top, y);
    bottom = std::max(bottom, y + 1);
  }
  left = std::max(0, left - margin_px);
  top = std::max(0, top - margin_px);
  right = std::min(seen.width_px, right + margin_px);
  bottom = std::min(seen.height_px, bottom + margin_px);
  return {.left_px = left, .top_px = top, .width_px = right - left, .height_px = bottom - top};
}

/// The flawless picture around the defects, as a sensor without noise sees it.
class FlawlessWindows {
 public:
  FlawlessWindows(SceneStore& store, const SceneSettings& scene, const TracedScene& traced)
      : defects_(traced.defects),
        sensor_(without_noise(scene.sensor), traced.seen().width_px, traced.seen().height_px),
        dark_(static_cast<float>(dark_grey(scene.sensor))) {
    Mask inside(traced.seen().width_px, traced.seen().height_px);
    std::vector<PixelWindow> windows;
    for (const DefectPixels& defect : defects_) {
      windows.push_back(window_around(defect.inside, sensor_.blur_radius_px(), traced.seen()));
      for (const std::size_t pixel : defect.inside) {
        inside.values()[pixel] = 1;
      }
    }
    seen_ = spans_of(inside);
    lit_ = spans_of(dilated(inside, sensor_.blur_radius_px()));
    picture_ = store.flawless_picture(scene, windows);
  }

  const PathPicture& picture() const { return *picture_; }

  /// For each defect the values of its own pixels.
  DefectValues values(int frame,
                      const FrameFactors& factors,
                      std::optional<std::size_t> without) const {
    const std::vector<ImageF> radiance = channel_radiances(*picture_, factors, without, lit_);
    const ImageF grey = mean_of_channels(expose_channels(sensor_, radiance, frame, seen_));
    DefectValues values;
    for (const DefectPixels& defect : defects_) {
      std::vector<float>& of_defect = values.emplace_back();
      for (const std::size_t pixel : defect.inside) {
        of_defect.push_back(std::min(1.0F, grey.values()[pixel] + dark_));
      }
    }
    return values;
  }

 private:
  std::span<const DefectPixels> defects_;
  Sensor sensor_;
  float dark_ = 0.0F;
  Spans seen_;  ///< pixels of the defects
  Spans lit_;   ///< and those that are blurred into them
  std::shared_ptr<const PathPicture> picture_;
};

/// A fifth of the grey values that light of a sum may be off by where it is interpolated: what
/// changes by less than five times that need be no defect.
double interpolation_noise(const SceneSettings& scene, std::span<const FrameFactors> frames) {
  constexpr double kSigmas = 5.0;
  double brightest = 0.0;
  for (const FrameFactors& factors : frames) {
    for (const Colour& factor : factors) {
      brightest = std::max(brightest, factor.maxCoeff());
    }
  }
  const int octave = brightness_octave(scene.sensor, frames);
  return direct_settings(scene.render, octave).interpolated * scene.sensor.exposure *
         scene.sensor.gain * brightest / kSigmas;
}

SceneSettings with_sensor(SceneSettings scene, const SensorSettings* sensor) {
  scene.sensor = sensor != nullptr ? *sensor : scene.sensor;
  return scene;
}

constexpr int kTile_px = 16;

/// Every third of the tiles along both axes; not the first ones, which see the picture's corner.
bool is_in_third_tile(int x, int y) {
  return x / kTile_px % 3 == 1 && y / kTile_px % 3 == 1;
}

std::vector<PixelWindow> third_tiles(const CameraSettings& camera) {
  std::vector<PixelWindow> windows;
  for (int y = kTile_px; y < camera.height_px; y += 3 * kTile_px) {
    for (int x = kTile_px; x < camera.width_px; x += 3 * kTile_px) {
      windows.push_back({.left_px = x, .top_px = y, .width_px = kTile_px, .height_px = kTile_px});
    }
  }
  return windows;
}

class PathScenePicture : public ScenePicture {
 public:
  PathScenePicture(SceneStore& store,
                   const SceneSettings& scene,
                   bool has_flawless,
                   const SensorSettings* film_sensor)
      : ScenePicture(scene, store.trace(scene)),
        sensor_(scene.sensor, traced()->seen().width_px, traced()->seen().height_px),
        picture_(store.picture(with_sensor(scene, film_sensor))),
        frames_(frame_factors(scene, picture_->unit_power_w)) {
    if (has_flawless && !traced()->defects.empty()) {
      flawless_.emplace(store, scene, *traced());
    }
  }

  bool has_whole_frames(bool /*is_consumed*/, bool /*wants_fringes*/) const override {
    return true;
  }

  MeanImage mean(const MeanRequest& request) const override {
    ScanSums sums;
    ImageF grey;
    for (std::size_t k = 0; k < frames_.size(); ++k) {
      const int index = static_cast<int>(k);
      accumulate_channels(sensor_,
                          channel_radiances(*picture_, frames_[k], request.without),
                          index,
                          sums,
                          request.watch ? &grey : nullptr);
      if (request.watch) {
        request.watch(index, grey);
      }
    }
    MeanImage mean = {.aspect = sums.aspect(), .frames = sums.frames};
    mean.clipped_frames = std::move(sums.clipped_frames);
    mean.form.frame_pixels = static_cast<int>(mean.aspect.size());
    if (scene().has_tunnel && !request.without) {
      const VisibilityBuffer& seen = traced()->seen();
      mean.hidden_share =
          hidden_share(occluded_pixels(seen, Tunnel(scene().tunnel), traced()->camera_in_world_mm),
                       scene().tunnel,
                       seen);
    }
    return mean;
  }

  DefectValues flawless(int frame, std::optional<std::size_t> without) const override {
    return flawless_ ? flawless_->values(frame, frames_[static_cast<std::size_t>(frame)], without)
                     : DefectValues();
  }

  std::size_t batches() const override { return picture_->batches.size(); }

  /// Root of the mean square over all of the defects' pixels; before the blur, which only makes it
  /// smaller.
  double change_noise() const override {
    if (flawless_ && !picture_->has_noise) {
      return interpolation_noise(scene(), frames_);
    }
    if (!flawless_ || batches() < 2) {
      return 0.0;
    }
    double squares = 0.0;
    std::int64_t count = 0;
    std::vector<double> without_one(batches());
    for (const FrameFactors& factors : frames_) {
      for (const DefectPixels& defect : traced()->defects) {
        for (const std::size_t pixel : defect.inside) {
          for (std::size_t b = 0; b < batches(); ++b) {
            without_one[b] = radiance_change(pixel, factors, b);
          }
          const double error = jackknife_error(without_one);
          squares += error * error;
          ++count;
        }
      }
    }
    return scene().sensor.exposure * scene().sensor.gain *
           std::sqrt(squares / static_cast<double>(std::max<std::int64_t>(1, count)));
  }

 private:
  double radiance_change(std::size_t pixel,
                         const FrameFactors& factors,
                         std::size_t without) const {
    return pixel_radiance(*picture_, factors, pixel, without) -
           pixel_radiance(flawless_->picture(), factors, pixel, without);
  }

  Sensor sensor_;
  std::shared_ptr<const PathPicture> picture_;
  std::vector<FrameFactors> frames_;
  std::optional<FlawlessWindows> flawless_;
};

}  // namespace

std::unique_ptr<ScenePicture> path_scene_picture(SceneStore& store,
                                                 const SceneSettings& scene,
                                                 const PictureRequest& request,
                                                 const SensorSettings* film_sensor) {
  check_scene(scene, request);
  check_part_in_tunnel(store, scene);
  return std::make_unique<PathScenePicture>(store, scene, request.has_flawless, film_sensor);
}

std::vector<float> coarse_radiance(SceneStore& store, const SceneSettings& scene) {
  std::vector<float> values;
  const std::vector<PixelWindow> windows = third_tiles(scene.camera);
  if (!is_direct(scene) || !is_lit(scene) || !scene.paths.has_light || windows.empty()) {
    return values;
  }
  SceneSettings coarse = scene;
  coarse.render.rays_per_axis = 1;
  const PathView view(coarse, store.build_defects(coarse), coarse.viewpoint());
  const PathPicture picture = render_view(view, path_settings(coarse), store.pool(), windows);
  const Mask& region = store.trace(scene)->region.mask;
  for (const FrameFactors& factors : view.frames()) {
    const ImageF radiance = frame_radiance(picture, factors);
    for (int y = 0; y < static_cast<int>(region.height()); ++y) {
      for (int x = 0; x < static_cast<int>(region.width()); ++x) {
        if (region(x, y) != 0 && is_in_third_tile(x, y)) {
          values.push_back(radiance(x, y));
        }
      }
    }
  }
  return values;
}

}  // namespace glint

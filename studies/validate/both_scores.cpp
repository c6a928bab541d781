// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/both_scores.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "metrics/appearance/grey_sums.h"
#include "metrics/aspect_image/defect_scores.h"
#include "simulator/sensor/rounding.h"
#include "studies/imaging/scene_picture.h"

namespace glint {
namespace {

/// A photograph in the place of a simulated picture.
class RealPicture : public ScenePicture {
 public:
  RealPicture(const ScenePicture& simulated, const ImageF& simulated_grey, const ImageF& real)
      : ScenePicture(simulated.scene(), simulated.traced()), simulated_(simulated), real_(real) {
    for (const DefectPixels& defect : traced()->defects) {
      const double there = mean_of(simulated_grey, defect.ring);
      ratios_.push_back(there > 0.0 ? mean_of(real, defect.ring) / there : 1.0);
    }
  }

  bool has_whole_frames(bool /*is_consumed*/, bool /*wants_fringes*/) const override {
    return true;
  }

  MeanImage mean(const MeanRequest& request) const override {
    if (request.watch) {
      request.watch(0, real_);
    }
    MeanImage mean = {.aspect = real_, .frames = 1};
    mean.clipped_frames = Image<std::uint16_t>(real_.width(), real_.height());
    std::ranges::transform(real_.values(), mean.clipped_frames.values().begin(), [](float grey) {
      return static_cast<std::uint16_t>(grey >= 1.0F ? 1 : 0);
    });
    mean.form.frame_pixels = static_cast<int>(real_.size());
    return mean;
  }

  DefectValues flawless(int /*frame*/, std::optional<std::size_t> without) const override {
    DefectValues values = simulated_.flawless(0, without);
    for (std::size_t i = 0; i < values.size() && i < ratios_.size(); ++i) {
      for (float& value : values[i]) {
        value = static_cast<float>(static_cast<double>(value) * ratios_[i]);
      }
    }
    return values;
  }

 private:
  const ScenePicture& simulated_;
  const ImageF& real_;
  std::vector<double> ratios_;
};

constexpr std::size_t kMaxExposureViews = 3;
constexpr double kMinCompared = 200.0;  ///< pixels
constexpr double kUnclipped = 0.98;
constexpr double kAlikePixels = 9.0;  ///< neighbours whose differences count as one

/// Standard error of real over simulated grey by what that exposure leaves.
double exposure_sigma(const GreySums& sums) {
  const double e = sums.real / sums.simulated;
  const double left = sums.real_squares - 2.0 * e * sums.products + e * e * sums.simulated_squares;
  return std::sqrt(kAlikePixels * std::max(0.0, left)) / sums.simulated;
}

void add_compared(SceneStore& store, const GreyView& view, GreySums& sums) {
  const auto picture = picture_of(store, view.scene, {.has_flawless = false});
  const MeanImage simulated = picture->mean({});
  const Mask& region = picture->traced()->region.mask;
  for (std::size_t i = 0; i < region.size(); ++i) {
    const auto real = static_cast<double>(view.real.values()[i]);
    const bool is_clipped = simulated.clipped_frames.values()[i] != 0 || real >= kUnclipped;
    if (region.values()[i] != 0 && !is_clipped) {
      sums.add(static_cast<double>(simulated.aspect.values()[i]), real);
    }
  }
}

/// A camera that shows nothing is not infinitely far off.
constexpr double kMinFoundExposure = 1e-6;

}  // namespace

BothScores scores_of_both(SceneStore& store,
                          const SceneSettings& scene,
                          const ImageF& real,
                          WantedScores wanted) {
  wanted.trials.clear();
  wanted.coverage = false;
  wanted.reference = false;
  wanted.picture = true;
  const auto picture = picture_of(store, scene, {.has_flawless = wanted.defects});
  BothScores scores;
  Evaluation simulated = evaluate(*picture, store.pool(), {}, wanted);
  scores.simulated = std::move(simulated.scores);
  wanted.errors = false;
  const RealPicture photograph(*picture, simulated.aspect, real);
  scores.real = evaluate(photograph, store.pool(), {}, wanted).scores;
  return scores;
}

GreyFit fit_exposure(SceneStore& store, const GreyDesign& design) {
  GreyFit fit = {.is_exposure_only = true};
  GreySums sums;
  double step = 0.0;  // of the camera's grey values, the largest
  const std::size_t count = std::min(design.views.size(), kMaxExposureViews);
  for (std::size_t i = 0; i < count; ++i) {
    const GreyView& view = design.views[i * design.views.size() / count];
    add_compared(store, view, sums);
    step = std::max(step, view.step);
    ++fit.renders;
  }
  if (sums.pixels < kMinCompared || sums.simulated <= 0.0) {
    return fit;
  }
  const double grey = sums.simulated / sums.pixels;
  const SensorSettings& sensor = design.views.front().scene.sensor;
  fit.is_known = true;
  fit.faults = {GreyFault::kExposure};
  fit.change.exposure = std::max(sums.real / sums.simulated, kMinFoundExposure);
  fit.values = {
      {.fault = GreyFault::kExposure, .value = fit.change.exposure, .sigma = exposure_sigma(sums)}};
  fit.before = std::abs(1.0 - 1.0 / fit.change.exposure);
  fit.rounding = largest_rounding_bias(grey_noise(sensor, grey), step) / grey;
  return fit;
}

}  // namespace glint

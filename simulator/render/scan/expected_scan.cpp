// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mean image of a scan averaged over all noise, and how far a single scan deviates from it.
// Each frame is rendered once through a sensor that only blurs; its radiances are then looked up in
// a table of the real sensor's expected grey value and variance, clipping and rounding included.
// Noise is independent from frame to frame, so variances add. docs/theory/sensor.md. Cost: one
// scan, however many times the part is to be scanned, and a table of 16,385 radiances.
#include "simulator/render/scan/expected_scan.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "simulator/render/scan/clipped_mean.h"
#include "simulator/render/scan/closed_scan.h"
#include "simulator/sensor/rounding.h"

namespace glint {
namespace {

/// Radiance is read off a sensor that does not clip below this.
constexpr double kMaxRadiance = 4.0;

/// grey_response() with rounding.
GreyResponse rounded_response(const SensorSettings& settings, double radiance) {
  constexpr double kCoarse = 2.0;  // from this many steps on, rounding adds step^2 / 12
  GreyResponse grey = grey_response(settings, radiance);
  if (settings.bits == 0) {
    return grey;
  }
  const double step = 1.0 / (std::exp2(settings.bits) - 1.0);
  const double per_electron = settings.gain / settings.full_well_e;
  const double electrons = settings.exposure * settings.full_well_e * radiance + settings.dark_e;
  const double deviation =
      per_electron * std::sqrt(electrons + settings.read_noise_e * settings.read_noise_e);
  if (deviation <= 0.0) {
    grey.mean = std::round(grey.mean / step) * step;
  } else if (deviation < kCoarse * step) {
    const RoundedGrey rounded = rounded_normal(per_electron * electrons, deviation, step);
    grey = {.mean = rounded.mean, .variance = rounded.variance};
  } else if (per_electron * electrons - 6.0 * deviation < 1.0) {
    grey.variance += step * step / 12.0;
  }
  return grey;
}

/// rounded_response() at equal steps of radiance, straight between them.
class RoundedResponses {
 public:
  explicit RoundedResponses(const SensorSettings& settings) {
    for (int i = 0; i <= kSteps; ++i) {
      const GreyResponse grey = rounded_response(settings, kMaxRadiance * i / kSteps);
      mean_.push_back(static_cast<float>(grey.mean));
      variance_.push_back(static_cast<float>(grey.variance));
    }
  }

  void add(const ImageF& radiance, ImageF& mean, ImageF& variance) const {
    for (std::size_t i = 0; i < radiance.size(); ++i) {
      const float place = radiance.values()[i] * static_cast<float>(kSteps);
      const auto below = std::min(static_cast<std::size_t>(place), kSteps - std::size_t{1});
      const float part = place - static_cast<float>(below);
      mean.values()[i] += mean_[below] + part * (mean_[below + 1] - mean_[below]);
      variance.values()[i] += variance_[below] + part * (variance_[below + 1] - variance_[below]);
    }
  }

 private:
  static constexpr int kSteps = 1 << 14;

  std::vector<float> mean_;
  std::vector<float> variance_;
};

/// A sensor that shows radiance / kMaxRadiance after the blur.
SensorSettings radiance_meter(const SensorSettings& settings) {
  return {.exposure = 1.0 / kMaxRadiance, .gain = 1.0, .blur_px = settings.blur_px, .bits = 0};
}

}  // namespace

ExpectedScan expected_scan(const Footprints& footprints, const SensorSettings& settings) {
  const int width = footprints.rays().width_px;
  const int height = footprints.rays().height_px;
  if (settings.full_well_e <= 0.0) {
    return {.aspect = scan_integrated(footprints, Sensor(settings, width, height)).aspect,
            .deviation = ImageF(width, height)};
  }
  const RoundedResponses table(settings);
  ExpectedScan scan = {.aspect = ImageF(width, height), .deviation = ImageF(width, height)};
  scan_integrated(footprints,
                  Sensor(radiance_meter(settings), width, height),
                  [&](int, const ImageF& frame) { table.add(frame, scan.aspect, scan.deviation); });
  const auto frames = static_cast<float>(footprints.positions().frames());
  for (std::size_t i = 0; i < scan.aspect.size(); ++i) {
    scan.aspect.values()[i] /= frames;
    scan.deviation.values()[i] = std::sqrt(scan.deviation.values()[i]) / frames;
  }
  return scan;
}

}  // namespace glint

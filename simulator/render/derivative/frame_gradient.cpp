// SPDX-License-Identifier: GPL-3.0-or-later
//
// The reverse mode through rendered frames: from the derivatives by the mean image to those by each
// frame's grey values (0 where a frame is clipped), through the adjoint blur to its radiances, and
// from there to the hits of the rays (plain_gradient.h, cell_gradient.h). Frames are rendered
// again, four at a time. docs/theory/derivatives.md, "Frames". Cost: once more the frames of the
// pixels that count, an adjoint blur and one pass over footprints for each; the number of keys does
// not matter. Memory: images of four frames.
#include "simulator/render/derivative/frame_gradient.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/image/spans.h"
#include "simulator/render/derivative/adjoint_blur.h"
#include "simulator/render/derivative/blur_derivative.h"
#include "simulator/render/derivative/cell_pixel_gradient.h"
#include "simulator/render/derivative/gradient_kernels.h"
#include "simulator/render/derivative/plain_gradient.h"
#include "simulator/render/footprint/footprint_frames.h"

namespace glint {
namespace {

/// Frames that are rendered together: footprints are read once for all of them.
constexpr int kFramesAtOnce = 4;

/// The sensor up to its gain: blur only.
SensorSettings blur_only(double blur_px) {
  return {.exposure = 1.0, .gain = 1.0, .blur_px = blur_px, .bits = 0};
}

/// Derivative of the expected grey value by the blurred radiance, as a share of the gain: 1 until
/// it clips. Of pixels that do not clip all weigh the same to the last bit; the gain would round,
/// and pixels that weigh the same would err by the same: their sum cancels against others'.
class ResponseDerivative {
 public:
  explicit ResponseDerivative(const SensorSettings& sensor)
      : linear_(sensor.gain * sensor.exposure), has_noise_(sensor.full_well_e > 0.0) {
    constexpr double kStep = 0.5 / kSteps;
    for (int i = 0; has_noise_ && i <= kSteps; ++i) {
      const double radiance = static_cast<double>(i) / kSteps;
      const double high = grey_response(sensor, radiance + kStep).mean;
      const double low = grey_response(sensor, std::max(0.0, radiance - kStep)).mean;
      gradient_.push_back(static_cast<float>(
          (high - low) / (radiance + kStep - std::max(0.0, radiance - kStep)) / linear_));
    }
  }

  /// @param gradient  as many as radiances
  void at(const float* radiance, int count, float* gradient) const {
    if (!has_noise_) {
      gradient_kernels::mark_unclipped(radiance, count, static_cast<float>(linear_), gradient);
      return;
    }
    std::transform(radiance, radiance + count, gradient, [this](float r) { return noisy_at(r); });
  }

 private:
  float noisy_at(float radiance) const {
    const float place = std::clamp(radiance, 0.0F, 1.0F) * kSteps;
    const auto i = std::min<std::size_t>(kSteps - 1, static_cast<std::size_t>(place));
    const float s = place - static_cast<float>(i);
    return (1.0F - s) * gradient_[i] + s * gradient_[i + 1];
  }

  static constexpr int kSteps = 1024;
  double linear_;
  bool has_noise_;
  std::vector<float> gradient_;
};

/// Where the blur is cut off at 0 nothing changes.
void clear_where_dark(const float* blurred, int count, float* derivative) {
  for (int i = 0; i < count; ++i) {
    derivative[i] = blurred[i] > 0.0F ? derivative[i] : 0.0F;
  }
}

/// The pixels that see light.
Spans lit_pixels(const Footprints& footprints, const Spans& pixels) {
  constexpr int kGapTolerance_px = 8;  // gaps that are not worth another start
  Spans result;
  for (const RowSpan& span : pixels) {
    const Footprints::State* state = footprints.state().row(span.y);
    const std::size_t first = result.size();
    for (int x = span.begin; x < span.end; ++x) {
      if (state[x] == Footprints::State::kDark) {
        continue;
      }
      if (result.size() > first && x - result.back().end <= kGapTolerance_px) {
        result.back().end = x + 1;
      } else {
        result.push_back({.y = span.y, .begin = x, .end = x + 1});
      }
    }
  }
  return result;
}

/// From blurred radiances to derivatives by them, frame by frame.
class AdjointOfTheSensor {
 public:
  AdjointOfTheSensor(const Sensor& sensor,
                     const Spans& wanted,
                     const Spans& around,
                     const ImageF& by_aspect,
                     int frames,
                     const WantedDerivatives& wants,
                     ScanGradient& gradient)
      : settings_(sensor.settings()),
        wanted_(wanted),
        by_aspect_(by_aspect),
        per_weight_(settings_.gain * settings_.exposure / frames),
        gradient_(gradient),
        response_(settings_),
        has_gain_(wants.gain || wants.exposure),
        has_blur_(wants.blur && settings_.blur_px > 0.0),
        blur_(blur_only(settings_.blur_px), by_aspect.width(), by_aspect.height()),
        change_(blur_, wanted, around),
        blurred_(ImageF::uninitialized(by_aspect.width(), by_aspect.height())),
        by_blurred_(zero_in(
            grown_spans(around, blur_.blur_radius_px(), 0, by_aspect.width(), by_aspect.height()),
            by_aspect.width(),
            by_aspect.height())) {}

  /// What the derivatives by radiances are in units of.
  double per_weight() const { return per_weight_; }

  /// @return derivatives by the blurred radiances, 0 elsewhere within the blur of pixels around
  const ImageF& apply(int index, const ImageF& radiance) {
    blur_.expose(radiance, index, wanted_, blurred_);
    for (const RowSpan& span : wanted_) {
      const float* grey = blurred_.row(span.y) + span.begin;
      float* by = by_blurred_.row(span.y) + span.begin;
      response_.at(grey, span.size(), by);
      if (blur_.blur_is_cut_off()) {
        clear_where_dark(grey, span.size(), by);
      }
      gradient_kernels::multiply_by(by_aspect_.row(span.y) + span.begin, span.size(), by);
      if (has_gain_) {
        const auto count = static_cast<std::size_t>(span.size());
        const double by_grey = per_weight_ * gradient_kernels::exact_dot(by, grey, count);
        gradient_.gain += by_grey / settings_.gain;
        gradient_.exposure += by_grey / settings_.exposure;
      }
    }
    if (has_blur_) {
      gradient_.blur_px += per_weight_ * change_.derivative(radiance, by_blurred_);
    }
    return by_blurred_;
  }

 private:
  const SensorSettings& settings_;
  const Spans& wanted_;
  const ImageF& by_aspect_;
  double per_weight_;
  ScanGradient& gradient_;
  ResponseDerivative response_;
  bool has_gain_, has_blur_;
  Sensor blur_;
  BlurDerivative change_;
  ImageF blurred_, by_blurred_;
};

std::size_t count_of(const Spans& spans) {
  std::size_t count = 0;
  for (const RowSpan& span : spans) {
    count += static_cast<std::size_t>(span.size());
  }
  return count;
}

}  // namespace

void add_frame_gradient(const Footprints& footprints,
                        const Sensor& sensor,
                        const Spans& wanted,
                        const ImageF& by_aspect,
                        const WantedDerivatives& wants,
                        std::shared_ptr<const PixelCells> cells,
                        ScanGradient& gradient) {
  if (wanted.empty()) {
    return;
  }
  const int width = by_aspect.width();
  const int height = by_aspect.height();
  const Spans around = grown_spans(wanted, sensor.blur_radius_px(), 0, width, height);
  const Spans lit = lit_pixels(footprints, around);
  const FootprintFrames frames(footprints, lit, std::move(cells));
  const int total = footprints.positions().frames();
  AdjointOfTheSensor through_sensor(sensor, wanted, around, by_aspect, total, wants, gradient);
  AdjointBlur through_blur(sensor, width, height);
  PlainGradient plain(footprints, lit);
  CellPixelGradient summed(footprints, lit, through_sensor.per_weight(), gradient);
  // The blur of the pixels around reads so far, and does not use it.
  const Spans beside = grown_spans(around, sensor.blur_radius_px(), 0, width, height);
  std::vector<ImageF> radiance;
  for (int k = 0; k < std::min(kFramesAtOnce, total); ++k) {
    radiance.push_back(zero_in(beside, width, height));
  }
  std::vector<std::vector<float>> by_radiance(radiance.size(), std::vector<float>(count_of(lit)));
  for (int first = 0; first < total; first += kFramesAtOnce) {
    radiance.resize(static_cast<std::size_t>(std::min(kFramesAtOnce, total - first)));
    by_radiance.resize(radiance.size());
    frames.render(first, radiance);
    for (std::size_t k = 0; k < radiance.size(); ++k) {
      const int index = first + static_cast<int>(k);
      const ImageF& by_blurred = through_sensor.apply(index, radiance[k]);
      float* out = by_radiance[k].data();
      for (const RowSpan& span : lit) {
        through_blur.apply(by_blurred, span, out);
        out += span.size();
      }
      summed.add_frame(index, by_radiance[k]);
    }
    plain.add_frames(first, by_radiance);
  }
  plain.finish(through_sensor.per_weight(), gradient);
  summed.finish();
}

}  // namespace glint

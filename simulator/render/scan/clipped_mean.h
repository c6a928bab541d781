// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mean over a scan of what a clipping sensor records, as a function of one number a pixel.
//
// A pixel of a smooth mirror sees stripes of a phase that is linear over the blur: a square wave
// blurred by w periods, w^2 = (sigma^2 + 1/12) (gx^2 + gy^2) for a Gaussian blur of sigma pixels, a
// box pixel and phase differences gx, gy a pixel. Moving the stripes by whole periods adds a
// constant to the phase, so the mean over the scan is
//
//     T(w) = mean over phases of c(S(phase; w)),
//
// with S the blurred wave and c the expected grey value of a radiance: gain, noise, clipping.
// Where it holds: docs/theory/clipped_mean.md. Own derivation.
#pragma once

#include <vector>

#include "simulator/render/scan/width_kernels.h"
#include "simulator/sensor/sensor.h"

namespace glint {

/// Grey values that a sensor makes of a constant radiance.
struct GreyResponse {
  double mean = 0.0;
  double variance = 0.0;  ///< of one frame by noise; rounding left out
};

/// @param radiance  >= 0, after the blur
GreyResponse grey_response(const SensorSettings& sensor, double radiance);

/// Stripes as a pixel sees them.
struct StripeSettings {
  double duty = 0.5;
  double dark = 0.0;  ///< radiance of dark stripes, bright ones have 1
  double gain = 1.0;  ///< of the way from the stripes to the sensor
  int frames = 24;    ///< evenly over whole periods
  int phases = 0;     ///< how many of them differ; 0: all

  int num_phases() const { return phases > 0 ? phases : frames; }
};

/// The square wave of period 1, `duty` of it 1 from phase 0 on, blurred by a Gaussian of w periods.
double blurred_stripe(double phase, double duty, double w);

/// T(w), tabulated with cubic pieces of continuous slope.
class ClippedMean {
 public:
  static constexpr int kIntervals = 128;
  static constexpr double kWidest = 0.8;  ///< beyond, the stripes have blurred to their mean

  struct Place {
    std::size_t interval = 0;
    double s = 0.0;  ///< how far into it, in [0, 1]
  };

  /// Where a width lies among the intervals.
  static Place place_of(double w);

  ClippedMean(const SensorSettings& sensor, const StripeSettings& stripes);

  double mean(double w) const;
  double slope(double w) const;  ///< of mean()

  /// Standard deviation of a pixel's mean over the frames by noise. What few frames add is in
  /// scan_ripple.h.
  double deviation(double w) const;

  /// No frame is ever below full scale.
  bool is_saturated(double w) const { return w >= saturated_from_; }

  double dark_level() const { return dark_level_; }  ///< grey value where there is no light

  double dark_deviation() const { return dark_deviation_; }

  /// Four coefficients an interval, in powers of the place in it.
  const std::vector<float>& coefficients() const { return coefficients_; }

  /// T at the nodes.
  const std::vector<double>& nodes() const { return nodes_; }

  /// nodes() alone: without noise much less work than the whole table.
  static std::vector<double> nodes_of(const SensorSettings& sensor, const StripeSettings& stripes);

  /// The coefficients of cubic pieces through any such values.
  static std::vector<float> pieces_through(const std::vector<double>& nodes);

  const std::vector<float>& deviations() const { return deviations_; }  ///< at the nodes

  /// mean() and deviation() for a row of pixels; as long as this table lives.
  footprint_kernels::PieceTables piece_tables() const {
    return {.coefficients = coefficients_.data(),
            .nodes = deviations_.data(),
            .pieces = kIntervals,
            .per_unit = static_cast<float>(kIntervals / kWidest)};
  }

  double saturated_from() const { return saturated_from_; }

 private:
  std::vector<double> nodes_;
  std::vector<float> coefficients_;
  std::vector<float> deviations_;
  double saturated_from_ = 0.0;
  double dark_level_ = 0.0;
  double dark_deviation_ = 0.0;
};

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The table T(w): the mean grey value over a scan as a function of the width w by which the stripes
// are blurred. Each of its 129 nodes averages the sensor's expected response over about 96 phases.
// The mean itself comes from the exact integral of clipped_stripe.h, as a sum over phases would
// miss the kink where the sensor starts to clip; the phases add what noise changes, and how far the
// scans of few frames scatter. Own derivation: docs/theory/clipped_mean.md. Cost: one table per
// sensor, duty, dark radiance and reflectance, then one look-up per pixel. Memory: a few kB.
#include "simulator/render/scan/clipped_mean.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/units.h"
#include "simulator/render/scan/clipped_stripe.h"
#include "simulator/render/scan/width_kernels.h"

namespace glint {
namespace {

double normal_density(double x) {
  return std::exp(-0.5 * x * x) / std::sqrt(2.0 * kPi);
}

double normal_share(double x) {
  return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

/// Mean and variance of a normal number cut to [0, 1].
GreyResponse clipped_normal(double mean, double deviation) {
  const double low = -mean / deviation;
  const double high = (1.0 - mean) / deviation;
  const double inside = normal_share(high) - normal_share(low);
  const double above = normal_share(-high);
  const double at_low = normal_density(low);
  const double at_high = normal_density(high);
  const double first = mean * inside + deviation * (at_low - at_high) + above;
  const double second = (mean * mean + deviation * deviation) * inside +
                        deviation * (mean * at_low - (mean + 1.0) * at_high) + above;
  return {.mean = first, .variance = std::max(0.0, second - first * first)};
}

/// The response over radiances [0, largest], looked up: the table needs it ten thousand times.
class ResponseTable {
 public:
  /// @param is_used  an unused table stays empty
  ResponseTable(const SensorSettings& sensor, double largest, bool is_used)
      : scale_(kSteps / largest) {
    for (int i = 0; is_used && i <= kSteps; ++i) {
      values_.push_back(grey_response(sensor, i / scale_));
    }
  }

  GreyResponse at(double radiance) const {
    const double place = std::clamp(radiance * scale_, 0.0, static_cast<double>(kSteps));
    const auto i = std::min<std::size_t>(kSteps - 1, static_cast<std::size_t>(place));
    const double s = place - static_cast<double>(i);
    return {.mean = (1.0 - s) * values_[i].mean + s * values_[i + 1].mean,
            .variance = (1.0 - s) * values_[i].variance + s * values_[i + 1].variance};
  }

 private:
  static constexpr int kSteps = 1024;
  double scale_;
  std::vector<GreyResponse> values_;
};

/// Stripes blurred by more than this are a short Fourier series, those blurred by less have few
/// edges nearby.
constexpr double kSeriesFrom = 0.03;

/// What a series leaves out: it has up to 35 terms.
constexpr double kSmallestTerm = 1e-9;

/// The blurred wave as the sum of its edges.
double by_edges(double f, double duty, double w) {
  constexpr double kReach = 6.0;  // sigmas; beyond, an edge is over to 1e-9
  double share = 0.0;
  const auto add_edge = [&](double distance, double sign) {
    if (distance > -kReach * w) {
      share += distance < kReach * w ? sign * normal_share(distance / w) : sign;
    }
  };
  for (int m = -1; m <= 1; ++m) {
    add_edge(f - m, 1.0);
    add_edge(f - m - duty, -1.0);
  }
  return share;
}

struct Node {
  double bias = 0.0;      ///< of the mean, by noise that is clipped
  double by_noise = 0.0;  ///< standard deviation of the mean over the frames
};

/// Grey value of a radiance before noise and clipping.
struct LinearResponse {
  double slope = 1.0;
  double offset = 0.0;

  explicit LinearResponse(const SensorSettings& sensor)
      : slope(sensor.gain * sensor.exposure),
        offset(sensor.full_well_e > 0.0 ? sensor.gain * sensor.dark_e / sensor.full_well_e : 0.0) {}

  double at(double radiance) const { return offset + slope * radiance; }
};

constexpr int kPhases = 96;

/// The phases at which a table looks at noisy stripes: evenly over a period.
class Phases {
 public:
  explicit Phases(double duty) : duty_(duty) {
    for (int i = 0; i < kPhases; ++i) {
      const double phase = (i + 0.5) / kPhases;
      phases_.push_back(phase);
      cosines_.push_back(std::cos(2.0 * kPi * (phase - 0.5 * duty)));
    }
    shares.resize(phases_.size());
  }

  /// Fills `shares` with the stripes blurred by w.
  void blur(double w) {
    if (w < kSeriesFrom) {
      for (std::size_t i = 0; i < shares.size(); ++i) {
        shares[i] = blurred_stripe(phases_[i], duty_, w);
      }
      return;
    }
    const StripeSeries series({.duty = duty_, .w = w}, kSmallestTerm);
    footprint_kernels::cosine_series(
        series.terms(), series.size(), duty_, cosines_.data(), kPhases, shares.data());
  }

  std::vector<double> shares;

 private:
  double duty_;
  std::vector<double> phases_;
  std::vector<double> cosines_;
};

Node noisy_node(const Phases& phases,
                const StripeSettings& stripes,
                const LinearResponse& linear,
                const ResponseTable& response) {
  Node node;
  double noise = 0.0;
  for (const double share : phases.shares) {
    const double radiance = stripes.gain * (stripes.dark + (1.0 - stripes.dark) * share);
    const GreyResponse grey = response.at(radiance);
    node.bias += grey.mean - std::min(1.0, linear.at(radiance));
    noise += grey.variance;
  }
  node.bias /= kPhases;
  node.by_noise = std::sqrt(noise / kPhases / stripes.frames);
  return node;
}

/// The smallest radiance of stripes blurred by w: in the middle of the dark one.
double darkest_of(const StripeSettings& stripes, double w) {
  const double middle = 0.5 * (stripes.duty + 1.0);
  const double share = stripes.duty < 1.0 ? blurred_stripe(middle, stripes.duty, w) : 1.0;
  return stripes.gain * (stripes.dark + (1.0 - stripes.dark) * share);
}

}  // namespace

GreyResponse grey_response(const SensorSettings& sensor, double radiance) {
  const double linear = sensor.gain * sensor.exposure * radiance;
  GreyResponse grey = {.mean = std::min(1.0, linear)};
  if (sensor.full_well_e > 0.0) {
    const double per_electron = sensor.gain / sensor.full_well_e;
    const double electrons = sensor.exposure * sensor.full_well_e * radiance + sensor.dark_e;
    const double deviation =
        per_electron * std::sqrt(electrons + sensor.read_noise_e * sensor.read_noise_e);
    grey = deviation > 0.0 ? clipped_normal(per_electron * electrons, deviation)
                           : GreyResponse{.mean = std::min(1.0, per_electron * electrons)};
  }
  return grey;
}

namespace {

/// Mean of the rounded grey values of a radiance; where noise is less than a step, rounding does
/// not average out.
double rounded_mean(const SensorSettings& sensor, double radiance, const GreyResponse& grey) {
  if (sensor.bits == 0 || grey.variance <= 0.0) {
    return grey.mean;
  }
  const int levels = (1 << sensor.bits) - 1;
  const double per_electron = sensor.gain / sensor.full_well_e;
  const double electrons = sensor.exposure * sensor.full_well_e * radiance + sensor.dark_e;
  const double deviation =
      per_electron * std::sqrt(electrons + sensor.read_noise_e * sensor.read_noise_e);
  constexpr double kReach = 6.0;
  const double middle = levels * per_electron * electrons;
  const int first = std::max(1, static_cast<int>(middle - kReach * deviation * levels));
  double steps = std::min(levels, first - 1);
  for (int k = first; k <= levels && k - 0.5 < middle + kReach * deviation * levels; ++k) {
    steps += normal_share((middle - (k - 0.5)) / (deviation * levels));
  }
  return steps / levels;
}

}  // namespace

double blurred_stripe(double phase, double duty, double w) {
  const double f = phase - std::floor(phase);
  if (w <= 0.0) {
    return f < duty ? 1.0 : 0.0;
  }
  return w < kSeriesFrom ? by_edges(f, duty, w)
                         : StripeSeries({.duty = duty, .w = w}, kSmallestTerm).at(f).value;
}

namespace {

/// Exact but for the noise: sums over phases would miss the bend where the sensor clips.
double exact_mean(const StripeSettings& stripes, const LinearResponse& linear, double w) {
  return clipped_mean_of({.duty = stripes.duty, .w = w},
                         linear.slope * stripes.gain * (1.0 - stripes.dark),
                         linear.at(stripes.gain * stripes.dark));
}

}  // namespace

std::vector<double> ClippedMean::nodes_of(const SensorSettings& sensor,
                                          const StripeSettings& stripes) {
  if (sensor.full_well_e > 0.0) {
    return ClippedMean(sensor, stripes).nodes();
  }
  const LinearResponse linear(sensor);
  std::vector<double> nodes;
  for (int i = 0; i <= kIntervals; ++i) {
    nodes.push_back(exact_mean(stripes, linear, kWidest * i / kIntervals));
  }
  return nodes;
}

ClippedMean::ClippedMean(const SensorSettings& sensor, const StripeSettings& stripes) {
  saturated_from_ = std::numeric_limits<double>::infinity();
  const double step = sensor.bits > 0 ? 1.0 / ((1 << sensor.bits) - 1) : 0.0;
  const double largest = stripes.gain * std::max(1.0, stripes.dark);
  const bool has_noise = sensor.full_well_e > 0.0;
  const ResponseTable table(sensor, has_noise && largest > 0.0 ? largest : 1.0, has_noise);
  const LinearResponse linear(sensor);
  Phases phases(stripes.duty);
  for (int i = 0; i <= kIntervals; ++i) {
    const double w = kWidest * i / kIntervals;
    Node node;
    if (has_noise) {
      phases.blur(w);
      node = noisy_node(phases, stripes, linear, table);
    }
    nodes_.push_back(exact_mean(stripes, linear, w) + node.bias);
    deviations_.push_back(static_cast<float>(node.by_noise));
    const double darkest = darkest_of(stripes, w);
    const bool is_saturated = sensor.gain * sensor.exposure * darkest >= 1.0 - 0.5 * step;
    if (is_saturated && w < saturated_from_) {
      saturated_from_ = w;
    }
  }
  coefficients_ = pieces_through(nodes_);
  const GreyResponse dark = grey_response(sensor, 0.0);
  dark_level_ = rounded_mean(sensor, 0.0, dark);
  dark_deviation_ = std::sqrt(dark.variance / stripes.frames);
}

/// Cubic pieces through the nodes with derivatives by central differences.
std::vector<float> ClippedMean::pieces_through(const std::vector<double>& nodes) {
  const std::vector<double>& f = nodes;
  std::vector<float> coefficients;
  const auto slope = [&](std::size_t i) {
    if (i == 0) {
      return 2.0 * f[1] - 1.5 * f[0] - 0.5 * f[2];
    }
    return i + 1 < f.size() ? 0.5 * (f[i + 1] - f[i - 1]) : 0.0;
  };
  for (std::size_t i = 0; i + 1 < f.size(); ++i) {
    const double rise = f[i + 1] - f[i];
    const double a = slope(i);
    const double b = slope(i + 1);
    for (const double c : {f[i], a, 3.0 * rise - 2.0 * a - b, a + b - 2.0 * rise}) {
      coefficients.push_back(static_cast<float>(c));
    }
  }
  return coefficients;
}

ClippedMean::Place ClippedMean::place_of(double w) {
  const double at = std::clamp(w / kWidest, 0.0, 1.0) * kIntervals;
  const auto i = std::min<std::size_t>(kIntervals - 1, static_cast<std::size_t>(at));
  return {.interval = i, .s = at - static_cast<double>(i)};
}

double ClippedMean::mean(double w) const {
  const Place at = place_of(w);
  const float* c = coefficients_.data() + 4 * at.interval;
  const auto term = [&](int i) { return static_cast<double>(c[i]); };
  return term(0) + at.s * (term(1) + at.s * (term(2) + at.s * term(3)));
}

double ClippedMean::slope(double w) const {
  if (w >= kWidest) {
    return 0.0;
  }
  const Place at = place_of(w);
  const float* c = coefficients_.data() + 4 * at.interval;
  const auto term = [&](int i) { return static_cast<double>(c[i]); };
  return (term(1) + at.s * (2.0 * term(2) + at.s * 3.0 * term(3))) * kIntervals / kWidest;
}

double ClippedMean::deviation(double w) const {
  const Place at = place_of(w);
  return (1.0 - at.s) * static_cast<double>(deviations_[at.interval]) +
         at.s * static_cast<double>(deviations_[at.interval + 1]);
}

}  // namespace glint

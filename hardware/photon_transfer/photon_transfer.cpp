// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/photon_transfer/photon_transfer.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/error.h"
#include "core/text.h"

namespace glint {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();
constexpr double kFittedShare = 0.7;  ///< of saturation, EMVA 1288
/// DN^2; rounding hides a smaller variance in the dark, which EMVA 1288 then takes to be this one.
constexpr double kMinDarkVariance = 0.24;
/// Of the dark pictures' pixels; with more of them at code 0 their noise is cut off, EMVA 1288.
constexpr double kMaxZeroShare = 0.005;

/// Points of a line, with weights and the standard deviation of each y.
struct Points {
  std::vector<double> x;
  std::vector<double> y;
  std::vector<double> weight;
  std::vector<double> sigma;

  void add(double at, double value, double its_weight, double its_sigma) {
    x.push_back(at);
    y.push_back(value);
    weight.push_back(its_weight);
    sigma.push_back(its_sigma);
  }

  LineFit line() const { return fitted_line(x, y, weight, sigma); }
};

double mean_over(std::span<const LevelStatistics> levels,
                 bool is_dark,
                 double LevelStatistics::*value) {
  double sum = 0.0;
  int count = 0;
  for (const LevelStatistics& level : levels) {
    if (level.is_dark == is_dark) {
      sum += level.*value;
      ++count;
    }
  }
  return count > 0 ? sum / count : 0.0;
}

/// The dark mean of an exposure: of the dark level nearest to it.
double dark_at(std::span<const LevelStatistics> levels, double exposure) {
  double best = 0.0;
  double distance = kInfinite;
  for (const LevelStatistics& level : levels) {
    if (level.is_dark && std::abs(level.exposure - exposure) < distance) {
      distance = std::abs(level.exposure - exposure);
      best = level.mean_dn;
    }
  }
  return best;
}

/// The noise is largest just below saturation; where it is largest at the brightest level, none
/// saturates.
void find_saturation(std::span<const LevelStatistics> levels, PhotonTransfer& result) {
  const LevelStatistics* noisiest = nullptr;
  double brightest_dn = 0.0;
  for (const LevelStatistics& level : levels) {
    if (!level.is_dark) {
      brightest_dn = std::max(brightest_dn, level.mean_dn);
      if (noisiest == nullptr || level.temporal_variance_dn2 > noisiest->temporal_variance_dn2) {
        noisiest = &level;
      }
    }
  }
  result.has_saturated = noisiest != nullptr && noisiest->mean_dn < brightest_dn;
  result.saturation_dn = result.has_saturated ? noisiest->mean_dn : result.full_scale_dn;
}

Points fitted_points(std::span<const LevelStatistics> levels, const PhotonTransfer& result) {
  Points points;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (result.is_fitted[i]) {
      const double variance = std::max(levels[i].temporal_variance_dn2, kRoundingVariance);
      points.add(levels[i].mean_dn,
                 levels[i].temporal_variance_dn2,
                 1.0 / variance,
                 std::max(levels[i].variance_error_dn2, 1e-9));
    }
  }
  return points;
}

/// Copies of one picture: each pixel's code is the same in all, though pixels differ by more than
/// rounding, so that noise was there.
void check_has_noise(std::span<const LevelStatistics> levels) {
  constexpr double kNone = 1e-9;  // DN^2: what sums of equal numbers leave
  for (const LevelStatistics& level : levels) {
    const bool is_clipped = level.clipped_share >= 0.5;  // beside them pixels that are dead at most
    if (!level.is_dark && !is_clipped && level.temporal_variance_dn2 < kNone &&
        level.spatial_variance_dn2 > kRoundingVariance) {
      throw ConfigError(fmt::format(
          "the pictures of the bright level of exposure {} (mean {:.4g} DN) are all "
          "alike: they are copies of one, or were processed; noise needs different ones",
          shortest(level.exposure),
          level.mean_dn));
    }
  }
}

/// Whether a dark level lies on the line: rounding and code 0 take noise away from one without a
/// black level.
bool shows_dark_noise(const LevelStatistics& level) {
  return level.temporal_variance_dn2 >= kMinDarkVariance && level.zero_share < kMaxZeroShare;
}

/// Levels weigh by the inverse of their variance. Its statistical error, which is in proportion to
/// it, would let the lowest levels decide alone, where a real sensor's deviations from a line are
/// as large in proportion.
void fit_gain(std::span<const LevelStatistics> levels, PhotonTransfer& result) {
  const double limit =
      result.dark_mean_dn + kFittedShare * (result.saturation_dn - result.dark_mean_dn);
  int bright = 0;
  for (const LevelStatistics& level : levels) {
    const bool is_fitted = level.is_dark ? shows_dark_noise(level)
                                         : level.mean_dn <= limit && level.clipped_share < 1e-4;
    result.is_fitted.push_back(is_fitted);
    bright += is_fitted && !level.is_dark ? 1 : 0;
  }
  if (bright < 3) {
    throw ConfigError(
        fmt::format("{} bright levels are below 70 % of saturation ({:.6g} DN), "
                    "photon transfer needs 3 or more",
                    bright,
                    result.saturation_dn));
  }
  result.fit = fitted_points(levels, result).line();
  if (!(result.fit.slope > 0.0)) {
    throw ConfigError(
        "the noise does not grow with the mean: these are no pictures of a sensor with "
        "shot noise, or they were processed");
  }
}

/// What dark pictures show of the noise in the dark.
enum class DarkNoise { kWhole, kBelowRounding, kCutOff };

DarkNoise dark_noise_seen(std::span<const LevelStatistics> levels, double variance_dn2) {
  const double zero_share = mean_over(levels, true, &LevelStatistics::zero_share);
  // Below that, nearly all codes are alike: rounding and not the cut limits what is seen.
  if (zero_share >= kMaxZeroShare && variance_dn2 > kRoundingVariance) {
    return DarkNoise::kCutOff;
  }
  return variance_dn2 < kMinDarkVariance ? DarkNoise::kBelowRounding : DarkNoise::kWhole;
}

/// @param read_dn2  what is left of the dark variance for the read noise
void warn_of_dark(DarkNoise seen, double read_dn2, PhotonTransfer& result) {
  constexpr double kHalfStep = 0.5;
  if (seen == DarkNoise::kCutOff) {
    result.warnings.emplace_back(
        "the dark pictures' noise is cut off at code 0: read_noise_e and dark_noise_e come out too "
        "small; raise the camera's black level");
  } else if (read_dn2 < 0.0 && result.dark_mean_dn > kHalfStep) {
    result.warnings.push_back(
        fmt::format("the dark pictures' mean of {:.4g} DN is more than their noise allows for "
                    "electrons: the camera "
                    "adds a black level, which the simulated sensor has not; its dark noise comes "
                    "out too large",
                    result.dark_mean_dn));
  }
  if (seen == DarkNoise::kBelowRounding) {
    result.warnings.push_back(
        fmt::format("the dark noise is below half a step of rounding: {} only an upper bound",
                    read_dn2 > 0.0 ? "read_noise_e is" : "dark_noise_e is"));
  }
}

void take_electrons(std::span<const LevelStatistics> levels, PhotonTransfer& result) {
  const double gain = result.fit.slope;
  result.full_scale_e = result.full_scale_dn / gain;
  result.saturation_e = (result.saturation_dn - result.dark_mean_dn) / gain;
  result.dark_e = std::max(0.0, result.dark_mean_dn) / gain;
  const DarkNoise seen = dark_noise_seen(levels, result.dark_variance_dn2);
  const double variance =
      seen == DarkNoise::kBelowRounding ? kMinDarkVariance : result.dark_variance_dn2;
  result.dark_noise_e = std::sqrt(std::max(0.0, variance - kRoundingVariance)) / gain;
  const double read = variance - kRoundingVariance - gain * result.dark_mean_dn;
  result.read_noise_e = std::sqrt(std::max(0.0, read)) / gain;
  warn_of_dark(seen, read, result);
  result.largest_snr = std::sqrt(result.saturation_e);
  // The signal that equals its noise (EMVA 1288, absolute sensitivity threshold in electrons).
  const double least = std::sqrt(variance) / gain + 0.5;
  result.dynamic_range = result.saturation_e / least;
}

/// Mean of light over exposure, 5 to 70 % of saturation; 0 where there is no such level.
double mean_rate(std::span<const LevelStatistics> levels, const PhotonTransfer& result) {
  const double span = result.saturation_dn - result.dark_mean_dn;
  double sum = 0.0;
  int count = 0;
  for (const LevelStatistics& level : levels) {
    const double signal = level.mean_dn - dark_at(levels, level.exposure);
    if (!level.is_dark && level.exposure > 0.0 && signal >= 0.05 * span &&
        signal <= kFittedShare * span) {
      sum += signal / level.exposure;
      ++count;
    }
  }
  return count > 0 ? sum / count : 0.0;
}

/// Mean of the points' deviations from the line, in proportion.
double mean_deviation(const Points& points, const LineFit& line) {
  double sum = 0.0;
  for (std::size_t i = 0; i < points.x.size(); ++i) {
    const double expected = line.offset + line.slope * points.x[i];
    sum += std::abs(points.y[i] / expected - 1.0) / static_cast<double>(points.x.size());
  }
  return sum;
}

void fit_response(std::span<const LevelStatistics> levels, PhotonTransfer& result) {
  Points points;
  double photons = 0.0;
  double photons_dn = 0.0;
  const double span = result.saturation_dn - result.dark_mean_dn;
  for (const LevelStatistics& level : levels) {
    const double signal = level.mean_dn - dark_at(levels, level.exposure);
    if (level.is_dark || signal < 0.05 * span || signal > 0.95 * span) {
      continue;
    }
    points.add(level.exposure, signal, 1.0 / (signal * signal), signal);
    photons += level.photons > 0.0 ? 1.0 : 0.0;
    photons_dn += level.photons > 0.0 ? signal / level.photons : 0.0;
  }
  if (photons > 0.0) {
    result.responsivity_dn = photons_dn / photons;
    result.quantum_efficiency = result.responsivity_dn / result.fit.slope;
  }
  if (points.x.empty()) {
    throw ConfigError(
        fmt::format("no bright level lies between 5 and 95 % of saturation ({:.6g} DN): take "
                    "pictures up to saturation; or the codes have fewer bits than that",
                    result.saturation_dn));
  }
  const auto [low, high] = std::ranges::minmax(points.x);
  if (!(high > low)) {
    result.warnings.emplace_back("the levels do not differ in exposure: linearity is not known");
    return;
  }
  result.rate_dn = mean_rate(levels, result);
  if (points.x.size() < 3) {
    result.warnings.emplace_back(
        "fewer than 3 levels lie between 5 and 95 % of saturation: linearity is not known");
    return;
  }
  result.response = points.line();
  result.linearity_error = mean_deviation(points, result.response);
}

void take_nonuniformity(std::span<const LevelStatistics> levels, PhotonTransfer& result) {
  const double dark =
      std::max(0.0, mean_over(levels, true, &LevelStatistics::spatial_variance_dn2));
  result.dark_nonuniformity_e = std::sqrt(dark) / result.fit.slope;
  const LevelStatistics* half = nullptr;
  const double goal = 0.5 * (result.saturation_dn + result.dark_mean_dn);
  for (const LevelStatistics& level : levels) {
    if (!level.is_dark &&
        (half == nullptr || std::abs(level.mean_dn - goal) < std::abs(half->mean_dn - goal))) {
      half = &level;
    }
  }
  const double light = half->mean_dn - result.dark_mean_dn;
  result.photo_response_nonuniformity =
      std::sqrt(std::max(0.0, half->spatial_variance_dn2 - dark)) / light;
}

void fit_dark(std::span<const LevelStatistics> levels, PhotonTransfer& result) {
  Points points;
  for (const LevelStatistics& level : levels) {
    if (level.is_dark) {
      points.add(level.exposure, level.mean_dn, 1.0, 1.0);
    }
  }
  if (points.x.empty()) {
    throw ConfigError("there is no dark level: take pictures with the lens covered, too");
  }
  result.dark_mean_dn = mean_over(levels, true, &LevelStatistics::mean_dn);
  result.dark_variance_dn2 = mean_over(levels, true, &LevelStatistics::temporal_variance_dn2);
  const auto [low, high] = std::ranges::minmax(points.x);
  if (high > low) {
    result.dark_rate_dn = points.line().slope;
  }
}

}  // namespace

LineFit fitted_line(std::span<const double> x,
                    std::span<const double> y,
                    std::span<const double> weight,
                    std::span<const double> sigma) {
  double sum = 0.0;
  double mean_x = 0.0;
  double mean_y = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += weight[i];
    mean_x += weight[i] * x[i];
    mean_y += weight[i] * y[i];
  }
  mean_x /= sum;
  mean_y /= sum;
  double xx = 0.0;
  double xy = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xx += weight[i] * (x[i] - mean_x) * (x[i] - mean_x);
    xy += weight[i] * (x[i] - mean_x) * (y[i] - mean_y);
  }
  LineFit fit{.slope = xy / xx, .points = static_cast<int>(x.size())};
  fit.offset = mean_y - fit.slope * mean_x;
  double chi_square = 0.0;
  double variance = 0.0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    chi_square += std::pow((y[i] - fit.offset - fit.slope * x[i]) / sigma[i], 2);
    variance += std::pow(weight[i] * (x[i] - mean_x) / xx * sigma[i], 2);
  }
  const double scatter = x.size() > 2 ? chi_square / static_cast<double>(x.size() - 2) : 0.0;
  fit.slope_sigma = std::sqrt(std::max(1.0, scatter) * variance);
  return fit;
}

PhotonTransfer photon_transfer(std::span<const LevelStatistics> levels, double full_scale_dn) {
  PhotonTransfer result{.full_scale_dn = full_scale_dn};
  check_has_noise(levels);
  fit_dark(levels, result);
  find_saturation(levels, result);
  fit_gain(levels, result);
  take_electrons(levels, result);
  fit_response(levels, result);
  take_nonuniformity(levels, result);
  if (!result.has_saturated) {
    result.warnings.emplace_back("no level saturates: the largest code was taken for saturation");
  } else if (result.saturation_dn < 0.8 * full_scale_dn) {
    result.warnings.push_back(
        fmt::format("the sensor saturates at {:.5g} DN, well below its largest code {:.6g}: the "
                    "simulated sensor "
                    "goes on to that code",
                    result.saturation_dn,
                    full_scale_dn));
  }
  return result;
}

}  // namespace glint

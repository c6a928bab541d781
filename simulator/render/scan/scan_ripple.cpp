// SPDX-License-Identifier: GPL-3.0-or-later
//
// The wave that a pixel sees is summed from its harmonics at the phases of a few scans that begin
// at different places, clipped, and averaged scan by scan. Pictures have few different gradients of
// the phase, so sizes are kept by gradient, rounded to cells of length and direction.
// docs/theory/clipped_mean.md. Cost: some microseconds per cell. Memory: a few kB.
#include "simulator/render/scan/scan_ripple.h"

#include <algorithm>
#include <cmath>

#include "core/units.h"
#include "simulator/render/scan/clipped_stripe.h"
#include "simulator/render/scan/width_kernels.h"

namespace glint {
namespace {

/// Scans that begin at different phases. With their mirror images about the middle of a stripe,
/// which give the same means, they tell the ripple and two overtones.
constexpr int kScans = 4;

/// Cells for each period that the ripple moves by from pixel to pixel, up to one; then for each
/// factor e.
constexpr double kCellsPerTurn = 16.0;

/// Between the directions of cells, from the nearer axis on.
constexpr double kDirectionStep_rad = 10.0 * kRadPerDeg;
constexpr int kMostDirections = 8;

/// Where the ripple moves by fewer periods from pixel to pixel no harmonic near it is aliased.
constexpr double kAliasedTurns = 0.35;

/// Harmonics of so many periods a pixel are aliased and little: beyond, they count where clipping
/// mixes them into the ripple, near the number of frames.
constexpr double kMostPeriods_per_px = 1.5;
constexpr double kMostTurns = 1.25;
constexpr int kHarmonicsBeyond = 8;

constexpr int kMostHarmonics = 1024;

/// The ripple counts as the same at the next pixel when it moves by less than this many turns.
constexpr double kCoherent = 0.02;

/// Which cell has so many turns a pixel.
int cell_of(double turns) {
  return static_cast<int>(
      std::lround(kCellsPerTurn * (turns < 1.0 ? turns : 1.0 + std::log(turns))));
}

double turns_of(int cell) {
  const double place = cell / kCellsPerTurn;
  return place < 1.0 ? place : std::exp(place - 1.0);
}

double distance_to_whole(double x) {
  return std::abs(x - std::round(x));
}

}  // namespace

ScanRipple::ScanRipple(const Sensor& sensor, const StripeSettings& stripes)
    : stripes_(stripes),
      variance_px2_(sensor.blur_variance_px2() + 1.0 / 12.0),
      weights_(sensor.blur_weights().begin(), sensor.blur_weights().end()) {
  std::for_each(weights_.begin() + 1, weights_.end(), [](double& weight) { weight *= 2.0; });
  const SensorSettings& settings = sensor.settings();
  const double linear = settings.gain * settings.exposure * stripes.gain;
  slope_ = linear * (1.0 - stripes.dark);
  offset_ = dark_grey(settings) + linear * stripes.dark;
  floor_ = sensor.blur_is_cut_off() ? dark_grey(settings) : -1.0;
  const int phases = stripes.num_phases();
  for (int scan = 0; scan < kScans; ++scan) {
    for (int k = 0; k < phases; ++k) {
      const double from_middle = (k + (scan + 0.5) / (2 * kScans)) / phases;
      cosines_.push_back(std::cos(2.0 * kPi * from_middle));
    }
  }
  shares_.resize(cosines_.size());
}

bool ScanRipple::is_coherent(double gx, double gy) const {
  const auto is_still = [&](double turns) {
    return distance_to_whole(turns * gx) < kCoherent && distance_to_whole(turns * gy) < kCoherent;
  };
  return is_still(stripes_.num_phases()) || is_still(2.0 * stripes_.num_phases());
}

ScanRipple::Size ScanRipple::at(double gx, double gy) {
  const double x = std::max(std::abs(gx), std::abs(gy));
  const double y = std::min(std::abs(gx), std::abs(gy));
  const double turns = stripes_.num_phases() * std::sqrt(x * x + y * y);
  // Where nothing is aliased the direction does not matter.
  const double angle = turns > kAliasedTurns ? std::atan2(y, x) : 0.0;
  const int cell = cell_of(turns);
  const auto direction = static_cast<int>(std::lround(angle / kDirectionStep_rad));
  const auto [found, is_new] = sizes_.try_emplace(cell * kMostDirections + direction);
  if (is_new) {
    const double length = turns_of(cell) / stripes_.num_phases();
    found->second = size_at(length * std::cos(direction * kDirectionStep_rad),
                            length * std::sin(direction * kDirectionStep_rad));
  }
  return found->second;
}

/// Multiplies the harmonics j from 1 on by B(j g); sines by rotation, the blur from cos(2 pi j g).
void ScanRipple::transfer(double g, std::vector<double>& terms) {
  if (g < 1e-9) {
    return;
  }
  const auto count = static_cast<int>(terms.size());
  cosines_of_g_.resize(terms.size());
  blur_.resize(terms.size());
  const double cosine = std::cos(kPi * g);
  const double sine = std::sin(kPi * g);
  double c = cosine;
  double s = sine;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    cosines_of_g_[i] = 1.0 - 2.0 * s * s;
    terms[i] *= s / (kPi * g * static_cast<double>(i + 1));
    const double turned = c * cosine - s * sine;
    s = s * cosine + c * sine;
    c = turned;
  }
  footprint_kernels::cosine_series(weights_.data() + 1,
                                   static_cast<int>(weights_.size()) - 1,
                                   weights_.front(),
                                   cosines_of_g_.data(),
                                   count,
                                   blur_.data());
  for (std::size_t i = 0; i < terms.size(); ++i) {
    terms[i] *= blur_[i];
  }
}

/// Fills the first harmonics of the stripes as they are.
void ScanRipple::start(int count, std::vector<double>& terms) {
  while (harmonics_.size() < static_cast<std::size_t>(count)) {
    const double turn = kPi * static_cast<double>(harmonics_.size() + 1);
    harmonics_.push_back(2.0 / turn * std::sin(turn * stripes_.duty));
  }
  terms.assign(harmonics_.begin(), harmonics_.begin() + count);
}

ScanRipple::Size ScanRipple::size_at(double gx, double gy) {
  const int phases = stripes_.num_phases();
  const double w = std::sqrt(variance_px2_) * std::hypot(gx, gy);
  const double steepest = std::max({gx, gy, kMostPeriods_per_px / kMostHarmonics});
  const int count = std::max(static_cast<int>(kMostPeriods_per_px / steepest),
                             static_cast<int>(kMostTurns * phases) + kHarmonicsBeyond);
  start(count, terms_);
  transfer(gx, terms_);
  transfer(gy, terms_);
  footprint_kernels::cosine_series(terms_.data(),
                                   count,
                                   stripes_.duty,
                                   cosines_.data(),
                                   static_cast<int>(cosines_.size()),
                                   shares_.data());
  double sum = 0.0;
  double squares = 0.0;
  const double* share = shares_.data();
  for (int scan = 0; scan < kScans; ++scan) {
    double total = 0.0;
    for (int k = 0; k < phases; ++k, ++share) {
      total += std::clamp(offset_ + slope_ * *share, floor_, 1.0);
    }
    const double mean = total / phases;
    sum += mean;
    squares += mean * mean;
  }
  const double mean = sum / kScans;
  if (mean <= 0.0) {
    return {};
  }
  const double table = clipped_mean_of({.duty = stripes_.duty, .w = w}, slope_, offset_);
  return {.deviation = std::sqrt(std::max(0.0, squares / kScans - mean * mean)) / mean,
          .bias = std::abs(mean - table) / mean};
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The wave that a pixel sees is summed from its harmonics at the phases of a few scans that begin
// at different places, clipped, and averaged scan by scan. Pictures have few different gradients of
// the phase, so sizes are kept by gradient, rounded to cells of length and direction.
// docs/theory/clipped_mean.md. Cost: some microseconds per cell. Memory: a few kB.
#include "simulator/render/scan/scan_ripple.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/units.h"
#include "simulator/render/scan/clipped_stripe.h"
#include "simulator/render/scan/width_kernels.h"

namespace glint {
namespace {

/// Scans that begin at different phases, so many at least, and so many phases in all. With their
/// mirror images about the middle of a stripe, which give the same means, four tell the ripple and
/// two overtones.
constexpr int kFewestScans = 4;
constexpr int kFewestPhases = 40;

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

/// Between which cells so many turns a pixel lie.
double place_of(double turns, double per_turn) {
  return per_turn * (turns < 1.0 ? turns : 1.0 + std::log(turns));
}

double turns_of(int cell, double per_turn) {
  const double place = cell / per_turn;
  return place < 1.0 ? place : std::exp(place - 1.0);
}

/// What four neighbours at -1, 0, 1 and 2 add to the value at t in [0, 1): Catmull and Rom's cubic.
std::array<double, 4> cubic_shares(double t) {
  return {0.5 * t * (t * (2.0 - t) - 1.0),
          1.0 + 0.5 * t * t * (3.0 * t - 5.0),
          0.5 * t * (1.0 + t * (4.0 - 3.0 * t)),
          0.5 * t * t * (t - 1.0)};
}

double distance_to_whole(double x) {
  return std::abs(x - std::round(x));
}

}  // namespace

ScanRipple::ScanRipple(const Sensor& sensor, const StripeSettings& stripes)
    : stripes_(stripes),
      variance_px2_(sensor.blur_variance_px2() + 1.0 / 12.0),
      cells_per_turn_(kCellsPerTurn * std::sqrt(variance_px2_)),
      weights_(sensor.blur_weights().begin(), sensor.blur_weights().end()) {
  std::for_each(weights_.begin() + 1, weights_.end(), [](double& weight) { weight *= 2.0; });
  const SensorSettings& settings = sensor.settings();
  const double linear = settings.gain * settings.exposure * stripes.gain;
  slope_ = linear * (1.0 - stripes.dark);
  offset_ = dark_grey(settings) + linear * stripes.dark;
  floor_ = sensor.blur_is_cut_off() ? dark_grey(settings) : -1.0;
  const int phases = stripes.num_phases();
  scans_ = std::clamp((kFewestPhases + phases - 1) / phases, kFewestScans, kMostScans);
  for (int scan = 0; scan < scans_; ++scan) {
    for (int k = 0; k < phases; ++k) {
      const double from_middle = (k + (scan + 0.5) / (2 * scans_)) / phases;
      cosines_.push_back(std::cos(2.0 * kPi * from_middle));
    }
  }
  shares_.resize(cosines_.size());
  for (int scan = 0; scan < scans_; ++scan) {
    for (int j = 0; j < scans_; ++j) {
      cosines_of_scans_.push_back(2.0 / scans_ * std::cos(kPi * (scan + 0.5) * j / scans_));
    }
  }
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
  const double place = place_of(turns, cells_per_turn_);
  const int cell = static_cast<int>(place);
  const auto direction = static_cast<int>(std::lround(angle / kDirectionStep_rad));
  const std::array<double, 4> shares = cubic_shares(place - cell);
  Wave wave;
  for (int i = 0; i < 4; ++i) {
    const Wave& near = of_cell(std::abs(cell + i - 1), direction);
    const double share = shares[static_cast<std::size_t>(i)];
    wave.bias += share * near.bias;
    for (std::size_t j = 0; j + 1 < static_cast<std::size_t>(scans_); ++j) {
      wave.amplitudes[j] += share * near.amplitudes[j];
    }
  }
  double squares = 0.0;
  for (const double amplitude : wave.amplitudes) {
    squares += 0.5 * amplitude * amplitude;
  }
  return {.deviation = std::sqrt(squares), .bias = wave.bias};
}

const ScanRipple::Wave& ScanRipple::of_cell(int cell, int direction) {
  const auto [found, is_new] = waves_.try_emplace(cell * kMostDirections + direction);
  if (is_new) {
    const double length = turns_of(cell, cells_per_turn_) / stripes_.num_phases();
    found->second = wave_at(length * std::cos(direction * kDirectionStep_rad),
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

ScanRipple::Wave ScanRipple::wave_at(double gx, double gy) {
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
  Wave wave;
  const double* share = shares_.data();
  for (int scan = 0; scan < scans_; ++scan) {
    double total = 0.0;
    for (int k = 0; k < phases; ++k, ++share) {
      total += std::clamp(offset_ + slope_ * *share, floor_, 1.0);
    }
    const double mean = total / phases;
    sum += mean;
    for (int j = 1; j < scans_; ++j) {
      const auto at = static_cast<std::size_t>(scan * scans_ + j);
      wave.amplitudes[static_cast<std::size_t>(j - 1)] += cosines_of_scans_[at] * mean;
    }
  }
  const double mean = sum / scans_;
  if (mean <= 0.0) {
    return {};
  }
  for (double& amplitude : wave.amplitudes) {
    amplitude /= mean;
  }
  const double table = clipped_mean_of({.duty = stripes_.duty, .w = w}, slope_, offset_);
  wave.bias = (table - mean) / mean;
  return wave;
}

}  // namespace glint

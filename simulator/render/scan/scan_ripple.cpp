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
#include <utility>

#include "core/units.h"
#include "simulator/render/scan/clipped_stripe.h"
#include "simulator/render/scan/width_kernels.h"

namespace glint {
namespace {

/// Scans that begin at different phases, so many at least, and so many phases in all. With their
/// mirror images about the middle of a stripe, which give the same means, four tell the ripple and
/// two overtones. Stripes with sharp edges, in the first cells, have more overtones.
constexpr int kMinScans = 4;
constexpr int kMinPhases = 40;
constexpr int kSharpScans = 8;
constexpr int kSharpCells = 4;

/// Cells for each period that the ripple moves by from pixel to pixel, up to one; then for each
/// factor e.
constexpr double kCellsPerTurn = 20.0;

/// Between the directions of cells, from the nearer axis on.
constexpr double kDirectionStep_rad = 10.0 * kRadPerDeg;
constexpr int kMaxDirections = 8;

/// Where the ripple moves by fewer periods from pixel to pixel no harmonic near it is aliased.
constexpr double kAliasedTurns = 0.35;

/// Harmonics of so many periods a pixel are aliased and little: beyond, they count where clipping
/// mixes them into the ripple, near the number of frames.
constexpr double kMaxPeriods_per_px = 1.5;
constexpr double kMaxTurns = 1.25;
constexpr int kHarmonicsBeyond = 8;

constexpr int kMaxHarmonics = 1024;

/// The ripple counts as the same at the next pixel when it moves by less than this many turns, or
/// by whole turns and less than so many: what is aliased there swings around them.
constexpr double kCoherent = 0.02;
constexpr double kCoherentAliased = 0.05;

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
  const int scans = std::clamp((kMinPhases + phases - 1) / phases, kMinScans, kMaxScans);
  smooth_ = Scans(scans, phases);
  sharp_ = Scans(std::max(scans, kSharpScans), phases);
  known_ = kept_waves().find(key());
}

Cache<TableKey, ScanRipple::Waves>& ScanRipple::kept_waves() {
  static Cache<TableKey, Waves> waves({.max_values = kKeptTables});
  return waves;
}

TableKey ScanRipple::key() const {
  TableKey key = {stripes_.duty,
                  static_cast<double>(stripes_.num_phases()),
                  slope_,
                  offset_,
                  floor_,
                  variance_px2_};
  key.insert(key.end(), weights_.begin(), weights_.end());
  return key;
}

void ScanRipple::keep() const {
  if (!waves_.empty()) {
    Waves all = known_ ? *known_ : Waves();
    all.insert(waves_.begin(), waves_.end());
    kept_waves().put(key(), std::move(all));
  }
}

ScanRipple::Scans::Scans(int number, int phases) : count(number) {
  for (int scan = 0; scan < count; ++scan) {
    for (int k = 0; k < phases; ++k) {
      const double from_middle = (k + (scan + 0.5) / (2 * count)) / phases;
      cosines.push_back(std::cos(2.0 * kPi * from_middle));
      // In 2 count phases steps from the middle to the next stripe's, or back from there.
      const int step = 2 * count * k + scan;
      order.push_back(std::min(step, 2 * count * phases - 1 - step));
    }
    for (int j = 0; j < count; ++j) {
      overtones.push_back(2.0 / count * std::cos(kPi * (scan + 0.5) * j / count));
    }
  }
}

bool ScanRipple::is_coherent(double gx, double gy) const {
  const double most = is_aliased(gx, gy) ? kCoherentAliased : kCoherent;
  const auto is_still = [&](double turns) {
    return distance_to_whole(turns * gx) < most && distance_to_whole(turns * gy) < most;
  };
  return is_still(stripes_.num_phases()) || is_still(2.0 * stripes_.num_phases());
}

bool ScanRipple::is_aliased(double gx, double gy) const {
  return stripes_.num_phases() * std::sqrt(gx * gx + gy * gy) > kAliasedTurns;
}

ScanRipple::Size ScanRipple::at(double gx, double gy) {
  const double x = std::max(std::abs(gx), std::abs(gy));
  const double y = std::min(std::abs(gx), std::abs(gy));
  const double turns = stripes_.num_phases() * std::sqrt(x * x + y * y);
  // Where nothing is aliased the direction does not matter.
  const double angle = is_aliased(gx, gy) ? std::atan2(y, x) : 0.0;
  const double place = place_of(turns, cells_per_turn_);
  const int cell = static_cast<int>(place);
  const auto direction = static_cast<int>(std::lround(angle / kDirectionStep_rad));
  std::array<double, 4> shares = cubic_shares(place - cell);
  int first = cell - 1;
  if (cell == 0) {
    // The wave's edges move with |g|: there is nothing before 0 but what the next three continue.
    shares = {shares[1] + 3.0 * shares[0], shares[2] - 3.0 * shares[0], shares[3] + shares[0], 0.0};
    first = 0;
  }
  Wave wave;
  for (int i = 0; i < 4; ++i) {
    const double share = shares[static_cast<std::size_t>(i)];
    if (share == 0.0) {
      continue;
    }
    const Wave& near = of_cell(first + i, direction);
    wave.bias += share * near.bias;
    for (std::size_t j = 0; j + 1 < static_cast<std::size_t>(sharp_.count); ++j) {
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
  const int place = cell * kMaxDirections + direction;
  if (known_) {
    if (const auto known = known_->find(place); known != known_->end()) {
      return known->second;
    }
  }
  const auto [found, is_new] = waves_.try_emplace(place);
  Wave& wave = found->second;  // stays where it is when others come
  if (!is_new) {
    return wave;
  }
  if (cell == 0) {
    wave = sharp_wave();
    return wave;
  }
  const double length = turns_of(cell, cells_per_turn_) / stripes_.num_phases();
  wave = wave_at(length * std::cos(direction * kDirectionStep_rad),
                 length * std::sin(direction * kDirectionStep_rad),
                 cell < kSharpCells ? sharp_ : smooth_);
  if (cell < kSharpCells) {
    // Edges far from each other err by their width, which so few phases hardly tell.
    wave.bias = of_cell(kSharpCells, direction).bias * cell / kSharpCells;
  }
  return wave;
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

/// Without blur a pixel is bright in a whole number of frames: their share has the harmonics of the
/// stripes whose order is a multiple of the number of phases.
ScanRipple::Wave ScanRipple::sharp_wave() const {
  const double dark = std::min(offset_, 1.0);
  const double height = std::min(offset_ + slope_, 1.0) - dark;
  const double mean = dark + stripes_.duty * height;
  Wave wave;
  for (int j = 1; j < sharp_.count && mean > 0.0; ++j) {
    const double turn = kPi * j * stripes_.num_phases();
    wave.amplitudes[static_cast<std::size_t>(j - 1)] =
        2.0 / turn * std::sin(turn * stripes_.duty) * height / mean;
  }
  return wave;
}

/// What the mean over equal steps of a wave that falls from the first misses because it is cut off,
/// at full scale or at the floor. A kink between two steps, a part t of them after the first, adds
/// its jump of slope times t (1 - t) / 2 - 1 / 12 (Euler and Maclaurin's sum).
double ScanRipple::missed_at_kinks() const {
  const auto of_kink = [](double t) { return 0.5 * t * (1.0 - t) - 1.0 / 12.0; };
  double missed = 0.0;
  for (std::size_t i = 0; i + 1 < values_.size(); ++i) {
    const double high = values_[i];
    const double fall = high - values_[i + 1];
    if (high > 1.0 && high - fall < 1.0) {
      missed += fall * of_kink((high - 1.0) / fall);
    }
    if (high > floor_ && high - fall < floor_) {
      missed -= fall * of_kink((high - floor_) / fall);
    }
  }
  return missed / static_cast<double>(values_.size());
}

ScanRipple::Wave ScanRipple::wave_at(double gx, double gy, const Scans& scans) {
  const int phases = stripes_.num_phases();
  const double w = std::sqrt(variance_px2_) * std::hypot(gx, gy);
  const double steepest = std::max({gx, gy, kMaxPeriods_per_px / kMaxHarmonics});
  const int count = std::max(static_cast<int>(kMaxPeriods_per_px / steepest),
                             static_cast<int>(kMaxTurns * phases) + kHarmonicsBeyond);
  start(count, terms_);
  transfer(gx, terms_);
  transfer(gy, terms_);
  shares_.resize(scans.cosines.size());
  values_.resize(scans.cosines.size());
  footprint_kernels::cosine_series(terms_.data(),
                                   count,
                                   stripes_.duty,
                                   scans.cosines.data(),
                                   static_cast<int>(scans.cosines.size()),
                                   shares_.data());
  double sum = 0.0;
  Wave wave;
  std::size_t at = 0;
  for (int scan = 0; scan < scans.count; ++scan) {
    double total = 0.0;
    for (int k = 0; k < phases; ++k, ++at) {
      const double value = offset_ + slope_ * shares_[at];
      values_[static_cast<std::size_t>(scans.order[at])] = value;
      total += std::clamp(value, floor_, 1.0);
    }
    const double mean = total / phases;
    sum += mean;
    for (int j = 1; j < scans.count; ++j) {
      wave.amplitudes[static_cast<std::size_t>(j - 1)] +=
          scans.overtones[static_cast<std::size_t>(scan * scans.count + j)] * mean;
    }
  }
  const double mean = sum / scans.count + missed_at_kinks();
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

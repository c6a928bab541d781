// SPDX-License-Identifier: GPL-3.0-or-later
//
// Levels are the same for all scenes, not a division of what one of them has: candidates of a
// search share their tables, and a mean does not jump where the range of D changes.
// docs/theory/clipped_mean.md, "Dark stripes that shine". Cost: a table for each level that the
// picture needs, mostly four to ten, kept for the next candidate of the same sensor and duty; four
// look-ups per pixel. Memory: some 6 kB a level.
#include "simulator/render/scan/shining_mean.h"

#include <algorithm>
#include <cmath>

#include "simulator/render/scan/kept_tables.h"

namespace glint {

namespace kernels = footprint_kernels;

namespace {

/// Catmull and Rom's cubic through values at -1, 0, 1 and 2.
template <class Number>
std::array<Number, 4> cubic_weights(Number t) {
  const Number half = 0.5;
  const Number t2 = t * t;
  const Number t3 = t2 * t;
  return {half * (-t + 2 * t2 - t3),
          half * (2 - 5 * t2 + 3 * t3),
          half * (t + 4 * t2 - 3 * t3),
          half * (t3 - t2)};
}

/// The cell between two levels that a dark radiance lies in.
int cell_of(double dark) {
  return std::clamp(static_cast<int>(dark * ShiningMean::kLevels), 0, ShiningMean::kLevels - 1);
}

/// The first of the four levels about a cell.
int first_of(int cell) {
  return std::clamp(cell - 1, 0, ShiningMean::kLevels - 3);
}

/// Beyond the first and the last level the parabola through the three next ones goes on: what the
/// four levels about a cell count, from what the cubic makes of its four places.
template <class Number>
std::array<Number, 4> without_missing(int cell, const std::array<Number, 4>& c) {
  if (cell == 0) {
    return {c[1] + 3 * c[0], c[2] - 3 * c[0], c[3] + c[0], 0};
  }
  if (cell == ShiningMean::kLevels - 1) {
    return {0, c[0] + c[3], c[1] - 3 * c[3], c[2] + 3 * c[3]};
  }
  return c;
}

/// The dark radiance from which on stripes blurred by w never come below full scale.
double saturated_from(const SensorSettings& sensor, const StripeSettings& stripes, double w) {
  const double step = sensor.bits > 0 ? 1.0 / ((1 << sensor.bits) - 1) : 0.0;
  const double wanted = (1.0 - 0.5 * step) / (sensor.gain * sensor.exposure * stripes.gain);
  const double share =
      stripes.duty < 1.0 ? blurred_stripe(0.5 * (stripes.duty + 1.0), stripes.duty, w) : 1.0;
  return share < 1.0 ? (wanted - share) / (1.0 - share) : wanted > 1.0 ? 2.0 : 0.0;
}

}  // namespace

ShiningMean::ShiningMean(const SensorSettings& sensor,
                         const StripeSettings& stripes,
                         double lowest,
                         double highest)
    : first_level_(stencil_of(lowest).first) {
  for (int level = first_level_; level < stencil_of(highest).first + 4; ++level) {
    StripeSettings at_level = stripes;
    at_level.dark = dark_of(level);
    levels_.push_back(kept_mean_table(sensor, at_level));
    means_.push_back(levels_.back()->coefficients());
  }
  for (int i = 0; i <= ClippedMean::kIntervals; ++i) {
    const double w = ClippedMean::kWidest * i / ClippedMean::kIntervals;
    saturated_from_.push_back(saturated_from(sensor, stripes, w));
  }
}

DarkStencil ShiningMean::stencil_of(double dark) {
  const int cell = cell_of(dark);
  const double t = dark * kLevels - cell;
  const double t2 = t * t;
  const std::array<double, 4> slope = {0.5 * kLevels * (-1.0 + 4.0 * t - 3.0 * t2),
                                       0.5 * kLevels * (-10.0 * t + 9.0 * t2),
                                       0.5 * kLevels * (1.0 + 8.0 * t - 9.0 * t2),
                                       0.5 * kLevels * (3.0 * t2 - 2.0 * t)};
  return {.first = first_of(cell),
          .weight = without_missing(cell, cubic_weights(t)),
          .slope = without_missing(cell, slope)};
}

ShiningMean::Value ShiningMean::value_of(const Pieces& pieces,
                                         double w,
                                         const DarkStencil& stencil) const {
  constexpr double kPerUnit = ClippedMean::kIntervals / ClippedMean::kWidest;
  const ClippedMean::Place at = ClippedMean::place_of(w);
  const auto first = static_cast<std::size_t>(stencil.first - first_level_);
  Value sum;
  for (std::size_t k = 0; k < 4; ++k) {
    const float* piece = pieces[first + k].data() + 4 * at.interval;
    const std::array<double, 4> c = {piece[0], piece[1], piece[2], piece[3]};
    const double value = c[0] + at.s * (c[1] + at.s * (c[2] + at.s * c[3]));
    sum.value += stencil.weight[k] * value;
    sum.by_dark += stencil.slope[k] * value;
    sum.by_width += stencil.weight[k] * kPerUnit * (c[1] + at.s * (2.0 * c[2] + at.s * 3.0 * c[3]));
  }
  return sum;
}

double ShiningMean::deviation(double w, double dark) const {
  const DarkStencil stencil = stencil_of(dark);
  double sum = 0.0;
  for (int k = 0; k < 4; ++k) {
    sum += stencil.weight[static_cast<std::size_t>(k)] * table(stencil.first + k).deviation(w);
  }
  return std::max(0.0, sum);
}

namespace {

/// The cell that a run's pixels all lie in; `any` where there are none, -1 where they differ.
int common_cell(const unsigned char* mask, const float* dark, int count, int any) {
  float lowest = 2.0F;
  float highest = -1.0F;
  for (int i = 0; i < count; ++i) {
    lowest = mask[i] != 0 && dark[i] < lowest ? dark[i] : lowest;
    highest = mask[i] != 0 && dark[i] > highest ? dark[i] : highest;
  }
  if (lowest > highest) {
    return any;
  }
  const int cell = cell_of(static_cast<double>(lowest));
  return cell_of(static_cast<double>(highest)) == cell ? cell : -1;
}

}  // namespace

void ShiningMean::look_up(const unsigned char* mask,
                          const float* w,
                          const float* dark,
                          int count,
                          float* mean,
                          float* deviation) const {
  for (int i = 0; i < count; i += kernels::kRun) {
    const int size = std::min(kernels::kRun, count - i);
    const int cell = common_cell(mask + i, dark + i, size, first_level_ + 1);
    if (cell >= 0) {
      look_up_alike(cell, mask + i, w + i, dark + i, size, mean + i, deviation + i);
    } else {
      look_up_each(mask + i, w + i, dark + i, size, mean + i, deviation + i);
    }
  }
}

void ShiningMean::look_up_alike(int cell,
                                const unsigned char* mask,
                                const float* w,
                                const float* dark,
                                int count,
                                float* mean,
                                float* deviation) const {
  const kernels::PieceValues none = {.cubic = static_cast<float>(dark_level()),
                                     .straight = static_cast<float>(dark_deviation())};
  using Run = std::array<float, kernels::kRun>;
  std::array<Run, 4> means;
  std::array<Run, 4> deviations;
  for (std::size_t k = 0; k < 4; ++k) {
    const kernels::PieceTables tables = table(first_of(cell) + static_cast<int>(k)).piece_tables();
    kernels::look_up_where(mask, w, count, tables, none, means[k].data(), deviations[k].data());
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const std::array<float, 4> c =
        without_missing(cell, cubic_weights(dark[i] * kLevels - static_cast<float>(cell)));
    const auto mixed = [&](const std::array<Run, 4>& runs) {
      return c[0] * runs[0][i] + c[1] * runs[1][i] + c[2] * runs[2][i] + c[3] * runs[3][i];
    };
    mean[i] = mask[i] != 0 ? mixed(means) : none.cubic;
    deviation[i] = mask[i] != 0 ? std::max(0.0F, mixed(deviations)) : none.straight;
  }
}

void ShiningMean::look_up_each(const unsigned char* mask,
                               const float* w,
                               const float* dark,
                               int count,
                               float* mean,
                               float* deviation) const {
  for (int i = 0; i < count; ++i) {
    const auto width = static_cast<double>(w[i]);
    const auto radiance = static_cast<double>(dark[i]);
    const bool is_used = mask[i] != 0;
    mean[i] = static_cast<float>(is_used ? this->mean(width, radiance) : dark_level());
    deviation[i] =
        static_cast<float>(is_used ? this->deviation(width, radiance) : dark_deviation());
  }
}

bool ShiningMean::is_saturated(double w, double dark) const {
  return dark >= saturated_from_[ClippedMean::place_of(w).interval];
}

}  // namespace glint

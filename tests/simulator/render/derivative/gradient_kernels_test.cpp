// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/derivative/gradient_kernels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint::gradient_kernels {
namespace {

constexpr int kFrames = 48;
constexpr double kDuty = 0.3;

/// Lying footprints in stripes far away: [periods], differences of the phase a pixel.
struct FarFootprints {
  std::vector<double> phase;
  std::vector<float> gx, gy, weight;

  explicit FarFootprints(std::size_t count) : weight(count, 1.0F) {
    for (std::size_t i = 0; i < count; ++i) {
      Rng rng(131, Stream::kTest, i);
      phase.push_back(rng.uniform(-40.0, 40.0));
      gx.push_back(static_cast<float>(rng.uniform(0.02, 0.06)));
      gy.push_back(static_cast<float>(rng.uniform(1e-3, 3e-3)));
    }
  }

  int count() const { return static_cast<int>(phase.size()); }

  std::vector<FixedPhase> turns() const {
    std::vector<FixedPhase> all;
    std::ranges::transform(phase, std::back_inserter(all), fixed_phase_of);
    return all;
  }
};

double shift_of(int frame) {
  return static_cast<double>(frame) / kFrames;
}

/// How much of a footprint's longer side an edge of stripes cuts.
double cut_at(double distance, double gx, double gy) {
  const double from_middle = std::abs(distance - std::round(distance));
  return std::clamp((0.5 * (gx + gy) - from_middle) / gy, 0.0, 1.0);
}

/// Derivative of the bright share by the phase, summed over the frames.
double expected_derivative(const FarFootprints& prints, std::size_t i) {
  const auto gx = static_cast<double>(prints.gx[i]);
  const auto gy = static_cast<double>(prints.gy[i]);
  double sum = 0.0;
  for (int k = 0; k < kFrames; ++k) {
    const double moved = prints.phase[i] - shift_of(k);
    sum += (cut_at(moved, gx, gy) - cut_at(moved - kDuty, gx, gy)) / gx;
  }
  return sum;
}

/// By the kernel for any footprint.
std::vector<float> box_gradients(const FarFootprints& prints,
                                 const std::vector<FixedPhase>& turns) {
  const std::vector<float> none(turns.size());
  std::vector<float> v = none, gx = none, gy = none, duty = none, dark = none;
  for (int k = 0; k < kFrames; ++k) {
    add_box_gradients(turns.data(),
                      prints.gx.data(),
                      prints.gy.data(),
                      prints.weight.data(),
                      prints.count(),
                      shift_of(k),
                      kDuty,
                      {.v = v.data(),
                       .gx = gx.data(),
                       .gy = gy.data(),
                       .duty = duty.data(),
                       .dark = dark.data()});
  }
  return v;
}

/// By the kernel for those that see one edge at most.
std::vector<float> narrow_gradients(const FarFootprints& prints,
                                    const std::vector<FixedPhase>& turns) {
  const std::vector<float> none(turns.size());
  std::array<std::vector<float>, 15> rows;
  rows.fill(none);
  const auto row = [&](std::size_t i) { return rows[i].data(); };
  const BoxShapes shapes = {.outer = row(0),
                            .inner = row(1),
                            .per_major = row(2),
                            .per_minor = row(3),
                            .flatness = row(4)};
  const NarrowSums sums = {
      .rising = row(5), .falling = row(6), .major = row(7), .minor = row(8), .dark = row(9)};
  box_shapes(prints.gx.data(), prints.gy.data(), prints.count(), shapes);
  for (int k = 0; k < kFrames; ++k) {
    add_narrow_frame(
        turns.data(), shapes, prints.weight.data(), prints.count(), shift_of(k), kDuty, sums);
  }
  add_narrow_sums(prints.gx.data(),
                  prints.gy.data(),
                  shapes,
                  sums,
                  prints.count(),
                  {.v = row(10), .gx = row(11), .gy = row(12), .duty = row(13), .dark = row(14)});
  return rows[10];
}

/// Largest error, in units of one edge's derivative.
double worst_error(const FarFootprints& prints, const std::vector<float>& gradient) {
  double worst = 0.0;
  for (std::size_t i = 0; i < gradient.size(); ++i) {
    const double error = static_cast<double>(gradient[i]) - expected_derivative(prints, i);
    worst = std::max(worst, std::abs(error) * static_cast<double>(prints.gx[i]));
  }
  return worst;
}

// What the rising edges change the falling ones take back, but for the ripple of the frames: an
// edge that is misplaced by 3e-8 periods errs by 3e-8 / gy of its derivative, 3e-5 here.
TEST(BoxGradients, CancelToTheRippleOfTheFrames) {
  constexpr double kTolerance = 6e-6;
  const FarFootprints prints(4096);
  EXPECT_LT(worst_error(prints, box_gradients(prints, prints.turns())), kTolerance);
  EXPECT_LT(worst_error(prints, narrow_gradients(prints, prints.turns())), kTolerance);
  // The control: phases in float, less whole periods.
  FarFootprints rounded = prints;
  for (double& phase : rounded.phase) {
    phase = static_cast<double>(static_cast<float>(phase - std::floor(phase)));
  }
  EXPECT_GT(worst_error(prints, box_gradients(rounded, rounded.turns())), 3.0 * kTolerance);
  EXPECT_GT(worst_error(prints, narrow_gradients(rounded, rounded.turns())), 3.0 * kTolerance);
}

// A quarter, two and a quarter and a quarter less eight periods are the same turn.
TEST(FixedPhaseOf, DropsWholePeriods) {
  EXPECT_EQ(fixed_phase_of(0.25), FixedPhase{1} << 30U);
  EXPECT_EQ(fixed_phase_of(2.25), FixedPhase{1} << 30U);
  EXPECT_EQ(fixed_phase_of(-7.75), FixedPhase{1} << 30U);
  EXPECT_EQ(fixed_phase_of(-3.0), 0U);
  EXPECT_EQ(fixed_phase_of(1.0 - 1e-12), ~FixedPhase{0});
}

TEST(ExactPhases, AreThoseOfTheCornersInTurns) {
  const std::vector<float> top = {10.0F, 12.0F, -31.0F};
  const std::vector<float> bottom = {11.0F, 13.0F, -30.0F};
  std::array<double, 2> phase = {};
  std::array<FixedPhase, 2> turns = {};
  std::array<float, 2> gx = {}, gy = {};
  exact_phases({.top = top.data(), .bottom = bottom.data()},
               2,
               0.3,
               1.0 / 7.0,
               {.phase = phase.data(), .v = turns.data(), .gx = gx.data(), .gy = gy.data()});
  EXPECT_DOUBLE_EQ(phase[0], 11.2 / 7.0);
  EXPECT_DOUBLE_EQ(phase[1], -9.3 / 7.0);
  EXPECT_FLOAT_EQ(gx[0], 2.0F / 7.0F);
  EXPECT_FLOAT_EQ(gy[1], 1.0F / 7.0F);
  for (std::size_t i = 0; i < 2; ++i) {
    const double share = phase[i] - std::floor(phase[i]);
    EXPECT_NEAR(static_cast<double>(turns[i]), share * 4294967296.0, 1.0) << i;
  }
}

TEST(ExactPhases, WrapHoweverFarTheyAre) {
  const std::array<float, 2> corners = {0.0F, 0.0F};
  for (const double periods : {0.25, 1000.25, 524288.25, -524287.75, 4e6 + 0.25}) {
    double phase = 0.0;
    FixedPhase v = 0;
    float gx = 0.0F;
    float gy = 0.0F;
    exact_phases({.top = corners.data(), .bottom = corners.data()},
                 1,
                 -periods,
                 1.0,
                 {.phase = &phase, .v = &v, .gx = &gx, .gy = &gy});
    EXPECT_EQ(phase, periods);
    EXPECT_EQ(v, fixed_phase_of(0.25)) << periods;
  }
}

}  // namespace
}  // namespace glint::gradient_kernels

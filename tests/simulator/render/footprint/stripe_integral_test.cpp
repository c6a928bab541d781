// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/footprint/stripe_integral.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/units.h"
#include "simulator/render/footprint/footprint_kernels.h"
#include "simulator/render/footprint/stripe_shares.h"
#include "simulator/render/scan/clipped_mean.h"
#include "simulator/render/scan/width_kernels.h"

namespace glint {
namespace {

namespace kernels = footprint_kernels;

double share_of(const PixelPolygon& polygon,
                const LinearFunction& phase,
                double duty,
                double shift = 0.0) {
  StripeSum sum;
  sum.add(polygon, phase);
  double share = 0.0;
  sum.evaluate({shift}, duty, &share);
  return share;
}

/// A line through the pixel at a random place and angle.
LinearFunction random_line(Rng& rng) {
  const double angle = rng.uniform(0.0, 2.0 * kPi);
  return {.value = rng.uniform(-0.4, 0.4), .dx = std::cos(angle), .dy = std::sin(angle)};
}

struct RandomCase {
  std::vector<LinearFunction> cuts;
  LinearFunction phase;
  double duty = 0.5;

  RandomCase(int index, double widest) {
    Rng rng(21, Stream::kTest, static_cast<std::uint64_t>(index));
    for (int i = index % 4; i > 0; --i) {
      cuts.push_back(random_line(rng));
    }
    const double angle = rng.uniform(0.0, 2.0 * kPi);
    const double size = widest * std::pow(rng.uniform(), 2.0);
    phase = {.value = rng.uniform(-30.0, 30.0),
             .dx = size * std::cos(angle),
             .dy = index % 5 == 0 ? 0.0 : size * std::sin(angle)};
    duty = rng.uniform(0.05, 0.95);
  }

  PixelPolygon polygon() const {
    PixelPolygon result;
    for (const LinearFunction& cut : cuts) {
      result.clip(cut, 0);
    }
    return result;
  }

  /// By 400 x 400 points.
  double sampled(double shift) const {
    constexpr int kPoints = 400;
    int lit = 0;
    for (int j = 0; j < kPoints; ++j) {
      const double y = (j + 0.5) / kPoints - 0.5;
      for (int i = 0; i < kPoints; ++i) {
        const double x = (i + 0.5) / kPoints - 0.5;
        const double moved = phase.at(x, y) - shift;
        const bool is_inside = std::ranges::all_of(
            cuts, [&](const LinearFunction& cut) { return cut.at(x, y) >= 0.0; });
        lit += is_inside && moved - std::floor(moved) < duty ? 1 : 0;
      }
    }
    return static_cast<double>(lit) / (kPoints * kPoints);
  }
};

// (1 + 2 + 3 + 6) / 4 = 3; along x (2 + 6 - 1 - 3) / 2 = 2; along y (3 + 6 - 1 - 2) / 2 = 3.
// A footprint of one period around an edge, of stripes far thinner than it, sees the duty's share
// wherever it lies: the box has the width 0.6 along x and none along y.
TEST(BoxFrame, SeesThinStripesAndThinGapsOnce) {
  for (const float duty : {0.0F, 1e-3F, 0.01F, 0.99F, 1.0F}) {
    constexpr int kCount = 1000;
    std::vector<float> v(kCount), gx(kCount, 0.6F), gy(kCount, 1e-6F), gain(kCount, 1.0F);
    std::vector<float> outer(kCount), inner(kCount), per_major(kCount), per_both(kCount);
    std::vector<float> out(kCount);
    const kernels::Trapezoids shape = {
        outer.data(), inner.data(), per_major.data(), per_both.data()};
    for (int i = 0; i < kCount; ++i) {
      v[static_cast<std::size_t>(i)] = static_cast<float>(i) / kCount;
    }
    kernels::trapezoids(gx.data(), gy.data(), kCount, shape);
    kernels::box_frame(v.data(), shape, gain.data(), kCount, {.duty = duty}, out.data());
    double sum = 0.0;
    for (const float share : out) {
      EXPECT_GT(share, -1e-5F);
      EXPECT_LT(share, 1.0F + 1e-5F);
      sum += static_cast<double>(share);
    }
    // Over all places of a period the mean is the duty.
    EXPECT_NEAR(sum / kCount, static_cast<double>(duty), 1e-4) << duty;
  }
}

TEST(LinearThrough, IsTheLeastSquaresPlaneOfTheCorners) {
  const LinearFunction f = linear_through({1.0, 2.0, 3.0, 6.0});
  EXPECT_DOUBLE_EQ(f.value, 3.0);
  EXPECT_DOUBLE_EQ(f.dx, 2.0);
  EXPECT_DOUBLE_EQ(f.dy, 3.0);
  EXPECT_DOUBLE_EQ(f.at(0.5, -0.5), 2.5);
}

// x >= 0.25 leaves a quarter; then x + y >= 0.5 a triangle and a piece: from x = 0.25 to 0.5 the
// height is x, (0.5^2 - 0.25^2) / 2 = 0.09375. Outside everything nothing is left.
TEST(PixelPolygon, IsCutByHandWorkedLines) {
  PixelPolygon polygon;
  EXPECT_DOUBLE_EQ(polygon.area(), 1.0);
  polygon.clip({.value = -0.25, .dx = 1.0}, 7);
  EXPECT_DOUBLE_EQ(polygon.area(), 0.25);
  polygon.clip({.value = -0.5, .dx = 1.0, .dy = 1.0}, 8);
  EXPECT_NEAR(polygon.area(), 0.09375, 1e-15);
  int by_seven = 0;
  int by_eight = 0;
  for (int i = 0; i < polygon.size(); ++i) {
    by_seven += polygon.vertex(i).boundary == 7 ? 1 : 0;
    by_eight += polygon.vertex(i).boundary == 8 ? 1 : 0;
  }
  EXPECT_EQ(by_seven, 1);
  EXPECT_EQ(by_eight, 1);
  polygon.clip({.value = -1.0, .dx = 1.0}, 9);
  EXPECT_EQ(polygon.area(), 0.0);
}

// Phase 0.5 x around 0.1: the pixel spans -0.15 to 0.35, bright from 0 on: 0.35 / 0.5 = 0.7.
// Phase 0.2 (x + y) around -0.1: bright beyond x + y = 0.5, a triangle of legs 0.5: 0.125.
// Phase 3.5 x around 0.25: -1.5 to 2, three whole bright halves: 1.5 / 3.5.
// Phase 0.3 all over: bright when duty is larger.
TEST(StripeSum, AgreesWithHandWorkedShares) {
  const PixelPolygon whole;
  EXPECT_NEAR(share_of(whole, {.value = 0.1, .dx = 0.5}, 0.5), 0.7, 1e-13);
  EXPECT_NEAR(share_of(whole, {.value = -0.1, .dx = 0.2, .dy = 0.2}, 0.5), 0.125, 1e-13);
  EXPECT_NEAR(share_of(whole, {.value = 0.25, .dx = 3.5}, 0.5), 1.5 / 3.5, 1e-13);
  EXPECT_NEAR(share_of(whole, {.value = 0.3}, 0.4), 1.0, 1e-4);
  EXPECT_NEAR(share_of(whole, {.value = 0.3}, 0.2), 0.0, 1e-4);
  // Moved by 0.2, the first pixel spans -0.35 to 0.15.
  EXPECT_NEAR(share_of(whole, {.value = 0.1, .dx = 0.5}, 0.5, 0.2), 0.3, 1e-13);
}

// The slot's edge x + y = 0.5 cuts off a triangle; the stripe's edge runs through it at x = 0.25,
// bright beyond: the integral of x from 0.25 to 0.5, 0.09375. Its other side: 0.125 - 0.09375.
TEST(StripeSum, SlotAndStripeMayCrossInACornerOfThePixel) {
  PixelPolygon corner;
  corner.clip({.value = -0.5, .dx = 1.0, .dy = 1.0}, 3);
  EXPECT_NEAR(share_of(corner, {.value = -0.05, .dx = 0.2}, 0.5), 0.09375, 1e-13);
  EXPECT_NEAR(share_of(corner, {.value = 0.45, .dx = 0.2}, 0.5), 0.125 - 0.09375, 1e-13);
}

TEST(StripeSum, AgreesWithManySamplesOnRandomPolygons) {
  double squares = 0.0;
  constexpr int kCases = 1000;
  for (int i = 0; i < kCases; ++i) {
    const RandomCase c(i, 4.0);
    Rng rng(22, Stream::kTest, static_cast<std::uint64_t>(i));
    const double shift = rng.uniform();
    const double error = share_of(c.polygon(), c.phase, c.duty, shift) - c.sampled(shift);
    // Each edge of a stripe along the samples' rows may be off by half a row, 1 / 800.
    const double edges = 2.0 + 2.0 * (std::abs(c.phase.dx) + std::abs(c.phase.dy));
    ASSERT_LE(std::abs(error), edges / 800.0) << i;
    squares += error * error;
  }
  EXPECT_LE(std::sqrt(squares / kCases), 5e-4);
}

// Evenly shifted stripes over a whole period leave every place bright for the duty's share of time,
// up to the jumps of N shifts: with N duty whole the mean is exact.
TEST(StripeSum, OverAWholePeriodOfShiftsIsDutyTimesArea) {
  for (int i = 0; i < 1000; ++i) {
    const RandomCase c(i, 6.0);
    const int frames = 10 + i % 30;
    const double duty = std::max(1.0, std::floor(c.duty * frames)) / frames;
    std::vector<double> shifts;
    for (int k = 0; k < frames; ++k) {
      shifts.push_back(static_cast<double>(k) / frames);
    }
    std::vector<double> shares(shifts.size());
    StripeSum sum;
    sum.add(c.polygon(), c.phase);
    sum.evaluate(shifts, duty, shares.data());
    const double mean = std::accumulate(shares.begin(), shares.end(), 0.0) / frames;
    ASSERT_NEAR(mean, duty * sum.area, 1e-6) << i;
  }
}

TEST(StripeSum, BothSidesOfACutAddUpToTheWhole) {
  for (int i = 0; i < 2000; ++i) {
    const RandomCase c(i, 6.0);
    Rng rng(23, Stream::kTest, static_cast<std::uint64_t>(i));
    const LinearFunction cut = random_line(rng);
    PixelPolygon left = c.polygon();
    PixelPolygon right = left;
    left.clip(cut, 1);
    right.clip({.value = -cut.value, .dx = -cut.dx, .dy = -cut.dy}, 1);
    const double parts = share_of(left, c.phase, c.duty) + share_of(right, c.phase, c.duty);
    ASSERT_NEAR(left.area() + right.area(), c.polygon().area(), 1e-12) << i;
    ASSERT_NEAR(parts, share_of(c.polygon(), c.phase, c.duty), 1e-6) << i;
  }
}

// The bright share and the dark share of the same stripes are the polygon.
TEST(StripeSum, BrightAndDarkAddUpToTheArea) {
  for (int i = 0; i < 2000; ++i) {
    const RandomCase c(i, 6.0);
    const double bright = share_of(c.polygon(), c.phase, c.duty);
    const double dark = share_of(c.polygon(), c.phase, 1.0 - c.duty, c.duty);
    ASSERT_NEAR(bright + dark, c.polygon().area(), 1e-6) << i;
    ASSERT_GE(bright, -1e-6) << i;
    ASSERT_LE(bright, c.polygon().area() + 1e-6) << i;
  }
}

/// Footprints as arrays of the kernels.
struct KernelCases {
  std::vector<float> v, gx, gy, outer, inner, per_major, per_both, gain;

  void add(double phase, double dx, double dy) {
    v.push_back(static_cast<float>(phase));
    gx.push_back(static_cast<float>(dx));
    gy.push_back(static_cast<float>(dy));
    gain.push_back(1.0F);
  }

  int count() const { return static_cast<int>(v.size()); }

  kernels::Trapezoids shape() {
    for (auto* array : {&outer, &inner, &per_major, &per_both}) {
      array->resize(v.size());
    }
    kernels::Trapezoids shape = {.outer = outer.data(),
                                 .inner = inner.data(),
                                 .per_major = per_major.data(),
                                 .per_both = per_both.data()};
    kernels::trapezoids(gx.data(), gy.data(), count(), shape);
    return shape;
  }

  double exact(std::size_t i, double duty, double shift) const {
    return share_of(PixelPolygon(),
                    {.value = static_cast<double>(v[i]),
                     .dx = static_cast<double>(gx[i]),
                     .dy = static_cast<double>(gy[i])},
                    duty,
                    shift);
  }
};

// The kernel's limit: (|gx| + |gy|) / 2 <= min(duty, 1 - duty).
TEST(BoxFrame, IsTheExactShareWithinItsLimit) {
  for (const double duty : {0.08, 0.3, 0.5, 0.77}) {
    KernelCases cases;
    Rng rng(24, Stream::kTest, static_cast<std::uint64_t>(100 * duty));
    const double limit = 2.0 * std::min(duty, 1.0 - duty);
    for (int i = 0; i < 2003; ++i) {
      const double sum = limit * rng.uniform();
      const double part = i % 7 == 0 ? 0.0 : i % 7 == 1 ? 0.5 : rng.uniform();
      cases.add(rng.uniform(-20.0, 20.0),
                (i % 2 == 0 ? 1.0 : -1.0) * sum * part,
                (i % 3 == 0 ? 1.0 : -1.0) * sum * (1.0 - part));
    }
    const kernels::Trapezoids shape = cases.shape();
    std::vector<float> out(cases.v.size());
    kernels::box_frame(cases.v.data(),
                       shape,
                       cases.gain.data(),
                       cases.count(),
                       {.shift = 0.375F, .duty = static_cast<float>(duty), .dark = 0.0F},
                       out.data());
    int near_edge = 0;
    for (std::size_t i = 0; i < out.size(); ++i) {
      // Phases in float are good to 1e-6 of 20 periods; narrow footprints turn that into shares.
      const double width =
          static_cast<double>(std::max(std::abs(cases.gx[i]), std::abs(cases.gy[i])));
      const double error = std::abs(static_cast<double>(out[i]) - cases.exact(i, duty, 0.375));
      near_edge += error > 1e-5 + 3e-6 / std::max(width, 1e-3) ? 1 : 0;
    }
    EXPECT_LE(near_edge, 2) << duty;
  }
}

// Beyond its limit a footprint covers more stripes than the kernel looks at: -1.25 to 1.25 periods
// have 1.25 bright, a share of 0.5; edges at -0.5, 0, 0.5, 1 and 1.5
// alone give 0.5 + (0 + 0.5 - 1 - 0.5 + 1.25) / 2.5 = 0.6.
TEST(BoxFrame, IsWrongFarBeyondItsLimit) {
  KernelCases cases;
  cases.add(0.0, 2.5, 0.0);
  const kernels::Trapezoids shape = cases.shape();
  float out = 0.0F;
  kernels::box_frame(cases.v.data(), shape, cases.gain.data(), 1, {}, &out);
  EXPECT_NEAR(cases.exact(0, 0.5, 0.0), 0.5, 1e-12);
  EXPECT_NEAR(out, 0.6F, 1e-6F);
}

// gain (dark + (1 - dark) share) with the share 0.7 from above: 0.8 (0.25 + 0.75 * 0.7) = 0.62.
TEST(BoxFrame, MixesBrightAndDarkByHand) {
  KernelCases cases;
  cases.add(0.1, 0.5, 0.0);
  const kernels::Trapezoids shape = cases.shape();
  const float gain = 0.8F;
  float out = 0.0F;
  kernels::box_frame(cases.v.data(), shape, &gain, 1, {.duty = 0.5F, .dark = 0.25F}, &out);
  EXPECT_NEAR(out, 0.62F, 1e-6F);
}

TEST(AnyShares, AreExactForEveryWidthAndScale) {
  for (const double scale : {1.0, 24.0}) {
    KernelCases cases;
    Rng rng(25, Stream::kTest, static_cast<std::uint64_t>(scale));
    for (int i = 0; i < 2003; ++i) {
      const double size = 5.0 * std::pow(rng.uniform(), 3.0) / scale;
      const double angle = rng.uniform(0.0, 2.0 * kPi);
      cases.add(rng.uniform(-3.0, 3.0),
                i % 11 == 0 ? 0.0 : size * std::cos(angle),
                i % 13 == 0 ? 0.0 : size * std::sin(angle));
    }
    const double duty = 0.37;
    std::vector<float> shares(cases.v.size());
    kernels::any_shares(cases.v.data(),
                        cases.gx.data(),
                        cases.gy.data(),
                        cases.count(),
                        scale,
                        duty,
                        shares.data());
    int wrong = 0;
    for (std::size_t i = 0; i < shares.size(); ++i) {
      const LinearFunction phase = {.value = scale * static_cast<double>(cases.v[i]),
                                    .dx = scale * static_cast<double>(cases.gx[i]),
                                    .dy = scale * static_cast<double>(cases.gy[i])};
      const double exact = share_of(PixelPolygon(), phase, duty);
      // Footprints below 1e-4 periods are widened to that.
      const double size = std::abs(phase.dx) + std::abs(phase.dy);
      const double bound = 1e-6 + 2e-4 / std::max(size, 1e-4) * 1e-2;
      wrong += std::abs(static_cast<double>(shares[i]) - exact) > bound ? 1 : 0;
    }
    EXPECT_LE(wrong, 2) << scale;
  }
}

TEST(SumBoxFrames, IsTheSumOfSingleFrames) {
  KernelCases cases;
  Rng rng(26, Stream::kTest, 0);
  for (int i = 0; i < 64 * kernels::kLanes; ++i) {
    cases.add(rng.uniform(-5.0, 5.0), rng.uniform(-0.25, 0.25), rng.uniform(-0.25, 0.25));
    cases.gain.back() = static_cast<float>(rng.uniform());
  }
  const kernels::Trapezoids shape = cases.shape();
  const std::vector<double> shifts = {0.0, 0.21, 0.5, 0.93};
  std::vector<double> sums(shifts.size(), 10.0);
  kernels::sum_box_frames(cases.v.data(),
                          shape,
                          cases.gain.data(),
                          cases.count(),
                          shifts.data(),
                          static_cast<int>(shifts.size()),
                          0.4,
                          0.1,
                          0.9,
                          false,
                          sums.data());
  for (std::size_t k = 0; k < shifts.size(); ++k) {
    std::vector<float> out(cases.v.size());
    kernels::box_frame(cases.v.data(),
                       shape,
                       cases.gain.data(),
                       cases.count(),
                       {.shift = static_cast<float>(shifts[k]), .duty = 0.4F, .dark = 0.1F},
                       out.data());
    const double expected = std::accumulate(out.begin(), out.end(), 10.0);
    EXPECT_NEAR(sums[k], expected, 1e-4 * expected) << k;
  }
}

// Neighbours share a piece at first, and are strewn over the whole table after that.
TEST(LookUpWhere, HasBothTablesInTheMaskAndOtherValuesElsewhere) {
  const ClippedMean table({.gain = 2.0, .full_well_e = 10000.0}, {.duty = 0.4});
  std::vector<float> w;
  std::vector<unsigned char> mask;
  for (int i = 0; i < 4007; ++i) {
    w.push_back(static_cast<float>(i < 2003 ? i : i * 977 % 2003) / 2000.0F);
    mask.push_back(i % 7 != 3 ? 1 : 0);
  }
  std::vector<float> values(w.size()), deviations(w.size());
  kernels::look_up_where(
      mask.data(),
      w.data(),
      static_cast<int>(w.size()),
      {.coefficients = table.coefficients().data(),
       .nodes = table.deviations().data(),
       .pieces = ClippedMean::kIntervals,
       .per_unit = static_cast<float>(ClippedMean::kIntervals / ClippedMean::kWidest)},
      {.cubic = 7.0F, .straight = 8.0F},
      values.data(),
      deviations.data());
  for (std::size_t i = 0; i < w.size(); ++i) {
    const auto width = static_cast<double>(w[i]);
    const double mean = mask[i] != 0 ? table.mean(width) : 7.0;
    const double deviation = mask[i] != 0 ? table.deviation(width) : 8.0;
    ASSERT_NEAR(static_cast<double>(values[i]), mean, 2e-6) << i;
    ASSERT_NEAR(static_cast<double>(deviations[i]), deviation, 2e-6) << i;
  }
}

}  // namespace
}  // namespace glint

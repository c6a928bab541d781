// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/footprint/footprint_kernels.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"

namespace glint::footprint_kernels {
namespace {

constexpr int kCount = 1000;

/// Two rows of corners in stripes up to 100 periods away.
struct TwoRows {
  std::vector<float> top, bottom;

  explicit TwoRows(double period_mm) {
    Rng rng(17, Stream::kTest, 0);
    for (int i = 0; i <= kCount; ++i) {
      const double at_mm = period_mm * (0.2 * i - 100.0);
      top.push_back(static_cast<float>(at_mm + rng.uniform(-0.05, 0.05) * period_mm));
      bottom.push_back(static_cast<float>(at_mm + rng.uniform(-0.05, 0.05) * period_mm));
    }
  }

  /// In double. @param x_sign, y_sign  1: mean of both corners, -1: half their difference
  double corners(int i, double x_sign, double y_sign) const {
    const auto at = static_cast<std::size_t>(i);
    const double left = static_cast<double>(bottom[at]) + y_sign * static_cast<double>(top[at]);
    const double right =
        static_cast<double>(bottom[at + 1]) + y_sign * static_cast<double>(top[at + 1]);
    return 0.25 * (right + x_sign * left);
  }
};

struct Phases {
  std::vector<float> v = std::vector<float>(kCount), gx = v, gy = v;

  PhaseRow row() { return {.v = v.data(), .gx = gx.data(), .gy = gy.data()}; }
};

/// From the phase to the nearest that differs from the true one by whole periods.
double largest_error(const TwoRows& rows, double offset_mm, double period_mm, const Phases& found) {
  double largest = 0.0;
  for (int i = 0; i < kCount; ++i) {
    const double phase = (rows.corners(i, 1.0, 1.0) - offset_mm) / period_mm;
    const double error = phase - static_cast<double>(found.v[static_cast<std::size_t>(i)]);
    largest = std::max(largest, std::abs(error - std::round(error)));
  }
  return largest;
}

// Those of a float would be off by 4e-6 periods, here and there.
TEST(PhasesInPeriod, AreRightToTheLastDigitsFarFromTheMiddle) {
  for (const auto& [period_mm, offset_mm] :
       {std::pair{16.0, 0.0}, {11.3, 2.0}, {0.7123, -555.5}, {37.91, 1e4}}) {
    const TwoRows rows(period_mm);
    const CornerRows corners = {.top = rows.top.data(), .bottom = rows.bottom.data()};
    Phases near, far;
    phases_in_period(corners, kCount, offset_mm, 1.0 / period_mm, near.row());
    EXPECT_LT(largest_error(rows, offset_mm, period_mm, near), 1.5e-7) << period_mm;
    phases_of_corners(corners,
                      kCount,
                      static_cast<float>(offset_mm),
                      static_cast<float>(1.0 / period_mm),
                      far.row());
    EXPECT_GT(largest_error(rows, offset_mm, period_mm, far), 2e-6) << period_mm;
    for (int i = 0; i < kCount; ++i) {
      const auto at = static_cast<std::size_t>(i);
      EXPECT_LT(std::abs(near.v[at]), 1.5F);
      EXPECT_NEAR(near.gx[at], 2.0 * rows.corners(i, -1.0, 1.0) / period_mm, 2e-7) << i;
      EXPECT_NEAR(near.gy[at], 2.0 * rows.corners(i, 1.0, -1.0) / period_mm, 2e-7) << i;
    }
  }
}

}  // namespace
}  // namespace glint::footprint_kernels

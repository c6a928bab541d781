// SPDX-License-Identifier: GPL-3.0-or-later
//
// Figures worked out by hand for a flat mirror under a light plane 120 mm away, seen by a camera
// far away, with a Gaussian dent 0.8 mm across (field survey, sections 1d and 1e).
#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/simulator/render/render_fixtures.h"

namespace glint {
namespace {

constexpr double kDistance_mm = 120.0;
constexpr double kDiameter_mm = 0.8;

/// Share of the defect that lights up while a dark stripe of half width `dark_mm` lies over it.
double lit_share(const test::Bench& bench, double dark_mm) {
  constexpr double kPeriod_mm = 1000.0;
  TunnelSettings settings = test::ceiling(kDistance_mm, kPeriod_mm);
  settings.duty = 1.0 - 2.0 * dark_mm / kPeriod_mm;
  settings.offset_mm = dark_mm;  // bright begins at +dark, so (-dark, +dark) is dark
  const Tunnel tunnel(settings);
  const WallRays wall = intersect_wall(bench.rays, tunnel, bench.camera_mm);
  ImageF frame;
  render_frame(bench.rays, wall, tunnel.pattern(0.0), frame);
  double lit = 0.0;
  double all = 0.0;
  const double pixel_mm = bench.camera_settings.object_pixel_mm;
  for (int y = 0; y < frame.height(); ++y) {
    for (int x = 0; x < frame.width(); ++x) {
      const double r =
          pixel_mm * std::hypot(x + 0.5 - 0.5 * frame.width(), y + 0.5 - 0.5 * frame.height());
      if (r <= 0.5 * kDiameter_mm) {
        lit += static_cast<double>(frame(x, y));
        all += 1.0;
      }
    }
  }
  return lit / all;
}

// The table of section 1e; columns are the stripe's half width over the defect's diameter.
TEST(PublishedCurves, SignatureShrinksWithTheDistanceToTheEdge) {
  constexpr std::array<double, 10> kHalfWidths = {
      0.25, 0.75, 1.25, 1.75, 2.25, 2.75, 3.25, 4.25, 5.25, 6.25};
  const std::vector<std::pair<double, std::vector<double>>> table = {
      {0.005, {88, 64, 32, 1, 0}},
      {0.010, {93, 80, 66, 50, 29, 13, 0}},
      {0.020, {97, 89, 82, 75, 67, 59, 49, 29, 13, 0}},
      {0.040, {98, 94, 91, 87, 83, 80, 76, 68, 59, 48}}};
  for (const auto& [slope_rad, percent] : table) {
    const test::Bench bench(test::plate(),
                            test::far_camera(128, 128, 0.008),
                            {.rays_per_axis = 2},
                            {test::bump(slope_rad)});
    for (std::size_t i = 0; i < percent.size(); ++i) {
      EXPECT_NEAR(100.0 * lit_share(bench, kHalfWidths[i] * kDiameter_mm), percent[i], 2.0)
          << slope_rad << " rad, half width " << kHalfWidths[i] << " diameters";
    }
  }
}

/// The same share from the formula: where |x + sign 2 L dh/dx| > half width, over the disc.
double formula_share(double slope_rad, double dark_mm, double sign) {
  constexpr double kSigma_mm = kDiameter_mm / 4.0;
  constexpr int kSteps = 800;
  const double height_mm = slope_rad * kSigma_mm * std::sqrt(std::exp(1.0));
  double lit = 0.0;
  double all = 0.0;
  for (int j = 0; j < kSteps; ++j) {
    for (int i = 0; i < kSteps; ++i) {
      const double x = kDiameter_mm * ((i + 0.5) / kSteps - 0.5);
      const double y = kDiameter_mm * ((j + 0.5) / kSteps - 0.5);
      const double r2 = x * x + y * y;
      if (r2 > 0.25 * kDiameter_mm * kDiameter_mm) {
        continue;
      }
      const double slope =
          height_mm * x / (kSigma_mm * kSigma_mm) * std::exp(-0.5 * r2 / (kSigma_mm * kSigma_mm));
      lit += std::abs(x + sign * 2.0 * kDistance_mm * slope) > dark_mm ? 1.0 : 0.0;
      all += 1.0;
    }
  }
  return lit / all;
}

TEST(PublishedCurves, DentAndBumpFollowTheirOwnFormula) {
  for (const double sign : {1.0, -1.0}) {
    HeightFeature feature = test::bump(0.005);
    feature.height_mm *= sign;
    const test::Bench bench(
        test::plate(), test::far_camera(128, 128, 0.008), {.rays_per_axis = 2}, {feature});
    for (const double half_width : {0.1, 0.3, 0.6, 0.9, 1.2}) {
      EXPECT_NEAR(lit_share(bench, half_width), formula_share(0.005, half_width, sign), 0.005)
          << half_width << " mm, sign " << sign;
    }
  }
}

// A place seen in the same stripe but with no slope at all never lights up.
TEST(PublishedCurves, WithoutDerivativeThereIsNoSignature) {
  const test::Bench bench(test::plate(), test::far_camera(128, 128, 0.008), {});
  EXPECT_EQ(lit_share(bench, 0.75 * kDiameter_mm), 0.0);
}

/// Largest deviation from the flawless mean over the mean, in the mean image.
double peak_contrast(const test::Bench& bench, double gain) {
  const int size = bench.rays.width_px;
  const Tunnel tunnel(test::ceiling(kDistance_mm, 8.0));
  const Sensor sensor({.gain = gain, .blur_px = 0.7, .bits = 0}, size, size);
  const ScanResult scan = take_scan(bench.rays, tunnel, sensor, {.positions = 24}, bench.camera_mm);
  double flawless = 0.0;
  int count = 0;
  double peak = 0.0;
  const double middle = 0.5 * size;
  for (int y = 2; y < size - 2; ++y) {
    for (int x = 2; x < size - 2; ++x) {
      if (std::hypot(x + 0.5 - middle, y + 0.5 - middle) > 12.0) {
        flawless += static_cast<double>(scan.aspect(x, y));
        ++count;
      }
    }
  }
  flawless /= count;
  for (int y = 2; y < size - 2; ++y) {
    for (int x = 2; x < size - 2; ++x) {
      const double deviation = static_cast<double>(scan.aspect(x, y)) - flawless;
      peak = std::abs(deviation) > std::abs(peak) ? deviation : peak;
    }
  }
  return peak / flawless;
}

/// 65 x 65 pixels of 0.15 mm with the bump on the middle one.
test::Bench bump_bench(double slope_rad) {
  return {
      test::plate(), test::far_camera(65, 65, 0.15), {.rays_per_axis = 8}, {test::bump(slope_rad)}};
}

// Item 4 of section 1d: period 8 mm, 24 positions, blur 0.7 px; gain 1.5, 2, 3. At 2 mrad the
// survey prints two digits for one unstated phase of the stripes, and the contrast moves by 0.015
// with it: a step of 2.2 px between positions is coarse against the blur.
TEST(PublishedCurves, ClippingMakesADefectShow) {
  struct Row {
    double slope_rad;
    double tolerance;
    std::array<double, 3> contrasts;
  };

  constexpr std::array<Row, 3> kRows = {{{0.005, 0.005, {0.188, 0.278, 0.366}},
                                         {0.020, 0.005, {0.456, 0.851, 0.885}},
                                         {0.002, 0.015, {0.07, 0.10, 0.13}}}};
  constexpr std::array<double, 3> kGains = {1.5, 2.0, 3.0};
  for (const Row& row : kRows) {
    const test::Bench bench = bump_bench(row.slope_rad);
    for (std::size_t i = 0; i < kGains.size(); ++i) {
      EXPECT_NEAR(peak_contrast(bench, kGains[i]),
                  row.contrasts[i],
                  std::max(row.tolerance, 0.03 * row.contrasts[i]))
          << row.slope_rad << " rad, gain " << kGains[i];
    }
  }
}

// Over whole periods a shift of phase does not change the mean: a linear camera is blind.
TEST(PublishedCurves, ALinearSensorSeesNoDefectInTheMeanOfAWholePeriod) {
  for (const double slope_rad : {0.002, 0.005, 0.020}) {
    EXPECT_LT(std::abs(peak_contrast(bump_bench(slope_rad), 1.0)), 0.005) << slope_rad;
  }
}

}  // namespace
}  // namespace glint

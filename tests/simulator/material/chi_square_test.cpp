// SPDX-License-Identifier: GPL-3.0-or-later
//
// Samples against their density: a chi-square test over bins around the mirror direction, which
// narrow with the material. One more bin holds lost samples and mirrors'; its expected share is
// what the density lacks to 1.
#include <gtest/gtest.h>

#include "tests/simulator/material/material_cases.h"

namespace glint {
namespace {

using material_cases::Case;
using material_cases::coloured_cases;
using material_cases::direction_at;

constexpr int kRings = 12;
constexpr int kSectors = 8;
constexpr int kBins = kRings * kSectors + 1;
constexpr int kDraws = 20'000;

/// Rings around the mirror direction at equal steps of asinh(angle / width), and sectors.
class PolarBins {
 public:
  PolarBins(const LocalDirection& to_viewer, double width)
      : width_(width), last_(std::asinh(kPi / width)) {
    frame_ = frame_at({-to_viewer.x, -to_viewer.y, to_viewer.z}, Eigen::Vector3d::UnitX());
  }

  int bin_of(const LocalDirection& v) const {
    const LocalDirection local = frame_.to_local({v.x, v.y, v.z});
    const double angle_rad = std::atan2(std::hypot(local.x, local.y), local.z);
    const double turn = std::atan2(local.y, local.x) / (2.0 * kPi) + 0.5;
    const int ring = static_cast<int>(std::asinh(angle_rad / width_) / last_ * kRings);
    const int sector = static_cast<int>(turn * kSectors);
    return std::min(ring, kRings - 1) * kSectors + std::min(sector, kSectors - 1);
  }

  /// The integral of a density over each bin, by midpoints.
  std::vector<double> integrate(const Material& material, const LocalDirection& to_viewer) const {
    constexpr int kSteps = 20;
    constexpr int kRows = kRings * kSteps;
    constexpr int kColumns = kSectors * kSteps;
    std::vector<double> sums(kBins, 0.0);
    for (int r = 0; r < kRows; ++r) {
      const double t = last_ * (r + 0.5) / kRows;
      const double angle_rad = width_ * std::sinh(t);
      const double area =
          std::sin(angle_rad) * width_ * std::cosh(t) * last_ / kRows * 2.0 * kPi / kColumns;
      for (int c = 0; c < kColumns; ++c) {
        const double phi_rad = 2.0 * kPi * ((c + 0.5) / kColumns - 0.5);
        const Eigen::Vector3d v = std::sin(angle_rad) * std::cos(phi_rad) * frame_.tangent +
                                  std::sin(angle_rad) * std::sin(phi_rad) * frame_.bitangent +
                                  std::cos(angle_rad) * frame_.normal;
        const auto bin = static_cast<std::size_t>(r / kSteps * kSectors + c / kSteps);
        sums[bin] += area * density(material, to_viewer, {v.x(), v.y(), v.z()});
      }
    }
    return sums;
  }

 private:
  double width_;
  double last_;
  ShadingFrame frame_;
};

/// Standard deviations that the chi-square statistic lies above its mean (Wilson and Hilferty).
double surprise(const std::vector<double>& expected, const std::vector<int>& found) {
  constexpr double kMin = 10.0;
  double statistic = 0.0;
  double few_expected = 0.0;
  int few_found = 0;
  int bins = 0;
  const auto add = [&](double e, int n) {
    statistic += (n - e) * (n - e) / e;
    ++bins;
  };
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (expected[i] < kMin) {
      few_expected += expected[i];
      few_found += found[i];
    } else {
      add(expected[i], found[i]);
    }
  }
  if (few_expected >= kMin) {
    add(few_expected, few_found);
  }
  const double degrees = std::max(1, bins - 1);
  const double spread = 2.0 / (9.0 * degrees);
  return (std::cbrt(statistic / degrees) - (1.0 - spread)) / std::sqrt(spread);
}

double surprise_of(const Material& sampled,
                   const Material& density_of,
                   double cosine,
                   double width) {
  const LocalDirection to_viewer = direction_at(cosine, 0.6);
  const PolarBins bins(to_viewer, width);
  std::vector<double> expected = bins.integrate(density_of, to_viewer);
  double whole = 0.0;
  for (double& e : expected) {
    whole += e;
    e *= kDraws;
  }
  expected.back() = kDraws * std::max(0.0, 1.0 - whole);
  std::vector<int> found(kBins, 0);
  Rng rng(11, Stream::kTest, 0);
  for (int i = 0; i < kDraws; ++i) {
    const auto light = sample(sampled, to_viewer, {rng.uniform(), rng.uniform(), rng.uniform()});
    const int bin = light && !light->is_mirror ? bins.bin_of(light->to_light) : kBins - 1;
    ++found[static_cast<std::size_t>(bin)];
  }
  return surprise(expected, found);
}

constexpr double kSurprised = 4.5;

TEST(Material, ChoosesDirectionsWithItsDensity) {
  for (const Case& c : coloured_cases()) {
    for (const double cosine : {0.95, 0.5, 0.15}) {
      EXPECT_LT(surprise_of(c.material, c.material, cosine, c.width), kSurprised)
          << c.name << " at cosine " << cosine;
    }
  }
}

// The negative control: a density that is 10 % too wide is found out.
TEST(ChiSquare, RefusesADensityOfAnotherWidth) {
  const Conductor metal = {.alpha = {0.3, 0.3}};
  const Conductor wider = {.alpha = {0.33, 0.33}};
  const Conductor turned = {.alpha = {0.3, 0.33}};
  EXPECT_LT(surprise_of(metal, metal, 0.5, 0.3), kSurprised);
  EXPECT_GT(surprise_of(metal, wider, 0.5, 0.3), kSurprised);
  EXPECT_GT(surprise_of(metal, turned, 0.5, 0.3), kSurprised);
  EXPECT_GT(surprise_of(metal, RoughDiffuse{}, 0.5, 0.3), kSurprised);
}

/// Share of samples that are lost or a mirror's.
double share_without_density(const Material& material, const LocalDirection& to_viewer, int count) {
  int lost = 0;
  for (int i = 0; i < count; ++i) {
    const auto light = sample(material, to_viewer, material_cases::quasi_random(i));
    lost += !light || light->is_mirror ? 1 : 0;
  }
  return static_cast<double>(lost) / count;
}

TEST(Material, HasADensityThatIntegratesToWhatIsNotLost) {
  for (const Case& c : coloured_cases()) {
    for (const double cosine : {0.95, 0.5, 0.15}) {
      const LocalDirection to_viewer = direction_at(cosine, 0.6);
      double whole = share_without_density(c.material, to_viewer, 10'000);
      for (const double part : PolarBins(to_viewer, c.width).integrate(c.material, to_viewer)) {
        whole += part;
      }
      EXPECT_NEAR(whole, 1.0, 0.005) << c.name << " at cosine " << cosine;
    }
  }
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Derivatives of footprints against central differences of what they differentiate.
#include "simulator/render/derivative/stripe_gradient.h"

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "simulator/render/footprint/stripe_integral.h"

namespace glint {
namespace {

constexpr int kRimLabel = 0;
constexpr int kSlotLabel = 4;

/// A cell cut by the wall's rim and one side of the slot.
struct CutCell {
  LinearFunction phase, rim, slot;
  double duty = 0.5;
  double dark = 0.1;
  std::vector<double> shifts = {0.0, 0.25, 0.5, 0.75};
  std::vector<double> weights = {0.4, 1.0, -0.3, 0.7};

  PixelPolygon polygon() const {
    PixelPolygon cut;
    cut.clip(rim, kRimLabel);
    cut.clip(slot, kSlotLabel);
    return cut;
  }

  double value() const {
    StripeSum sum;
    sum.clear();
    sum.add(polygon(), phase);
    std::vector<double> shares(shifts.size());
    sum.evaluate(shifts, duty, shares.data());
    double total = 0.0;
    for (std::size_t k = 0; k < shifts.size(); ++k) {
      total += weights[k] * (dark * sum.area + (1.0 - dark) * shares[k]);
    }
    return total;
  }

  StripeGradient gradient() const {
    std::array<LinearFunction, 5> boundaries;
    boundaries[kRimLabel] = rim;
    boundaries[kSlotLabel] = slot;
    StripeGradient result;
    result.add(polygon(), phase, boundaries, shifts, weights, {duty, dark, 1.0 - dark});
    return result;
  }
};

CutCell random_cut_cell(std::uint64_t index) {
  Rng rng(109, Stream::kTest, index);
  const auto random_function = [&](double offset, double size) {
    return LinearFunction{
        rng.uniform(-offset, offset), rng.uniform(-size, size), rng.uniform(-size, size)};
  };
  CutCell cell;
  cell.phase = random_function(2.0, 1.5);
  cell.rim = random_function(0.5, 2.0);
  cell.slot = random_function(0.5, 2.0);
  cell.duty = rng.uniform(0.1, 0.9);
  cell.dark = rng.uniform() < 0.5 ? 0.0 : rng.uniform(0.0, 0.5);
  for (double& weight : cell.weights) {
    weight = rng.uniform(-1.0, 1.0);
  }
  return cell;
}

using NumberOfCell = std::function<double&(CutCell&)>;

double cell_difference(const CutCell& cell, const NumberOfCell& number) {
  constexpr double kStep = 1e-6;
  CutCell high = cell;
  CutCell low = cell;
  number(high) += kStep;
  number(low) -= kStep;
  return (high.value() - low.value()) / (2.0 * kStep);
}

struct CellNumber {
  const char* name;
  NumberOfCell number;
  std::function<double(const StripeGradient&)> derivative;
};

std::vector<CellNumber> cell_numbers() {
  return {
      {"phase",
       [](CutCell& c) -> double& { return c.phase.value; },
       [](const StripeGradient& s) { return s.phase.value; }},
      {"phase dx",
       [](CutCell& c) -> double& { return c.phase.dx; },
       [](const StripeGradient& s) { return s.phase.dx; }},
      {"phase dy",
       [](CutCell& c) -> double& { return c.phase.dy; },
       [](const StripeGradient& s) { return s.phase.dy; }},
      {"rim",
       [](CutCell& c) -> double& { return c.rim.value; },
       [](const StripeGradient& s) { return s.boundary[kRimLabel].value; }},
      {"rim dx",
       [](CutCell& c) -> double& { return c.rim.dx; },
       [](const StripeGradient& s) { return s.boundary[kRimLabel].dx; }},
      {"slot",
       [](CutCell& c) -> double& { return c.slot.value; },
       [](const StripeGradient& s) { return s.boundary[kSlotLabel].value; }},
      {"slot dy",
       [](CutCell& c) -> double& { return c.slot.dy; },
       [](const StripeGradient& s) { return s.boundary[kSlotLabel].dy; }},
      {"duty",
       [](CutCell& c) -> double& { return c.duty; },
       [](const StripeGradient& s) { return s.duty; }},
  };
}

// A difference whose step takes a corner of the polygon across an edge is off by a kink; few do.
TEST(StripeGradient, AgreeWithDifferencesOfRandomCutCells) {
  for (const CellNumber& n : cell_numbers()) {
    int off = 0;
    for (std::uint64_t i = 0; i < 1000; ++i) {
      const CutCell cell = random_cut_cell(i);
      const double expected = cell_difference(cell, n.number);
      const double found = n.derivative(cell.gradient());
      off += std::abs(found - expected) > 1e-5 + 1e-3 * std::abs(expected) ? 1 : 0;
    }
    EXPECT_LE(off, 3) << n.name;
  }
}

// Negative control: the boundary's own term, left out or of the other sign, would be noticed.
TEST(StripeGradient, AMissingBoundaryTermWouldBeNoticed) {
  for (const double factor : {0.0, -1.0}) {
    int off = 0;
    for (std::uint64_t i = 0; i < 1000; ++i) {
      const CutCell cell = random_cut_cell(i);
      const double expected =
          cell_difference(cell, [](CutCell& c) -> double& { return c.slot.value; });
      const double wrong = factor * cell.gradient().boundary[kSlotLabel].value;
      off += std::abs(wrong - expected) > 1e-5 + 1e-3 * std::abs(expected) ? 1 : 0;
    }
    EXPECT_GT(off, 300) << factor;
  }
}

// All of the pixel bright, x >= 0 kept: half of it. Moving the boundary c = x by dc uncovers a
// strip of height 1 and width dc; turning it (c = x + s y) takes from one half what it gives to the
// other.
TEST(StripeGradient, MatchAHandWorkedHalfPixel) {
  CutCell cell;
  cell.phase = {0.25, 0.0, 0.0};
  cell.rim = {1.0, 0.0, 0.0};
  cell.slot = {0.0, 1.0, 0.0};
  cell.dark = 0.0;
  cell.shifts = {0.0};
  cell.weights = {1.0};
  EXPECT_NEAR(cell.value(), 0.5, 1e-6);
  const StripeGradient gradient = cell.gradient();
  EXPECT_NEAR(gradient.boundary[kSlotLabel].value, 1.0, 1e-6);
  EXPECT_NEAR(gradient.boundary[kSlotLabel].dy, 0.0, 1e-6);
  EXPECT_NEAR(gradient.boundary[kRimLabel].value, 0.0, 1e-12);
}

// Each corner's share of value, dx and dy, against linear_through().
TEST(LinearGradient, ByCornersIsTheTransposeOfLinearThrough) {
  const LinearGradient gradient = {.value = 0.7, .dx = -0.2, .dy = 0.4};
  const std::array<double, 4> by = gradient.by_corners();
  for (std::size_t i = 0; i < 4; ++i) {
    std::array<double, 4> corners = {};
    corners[i] = 1.0;
    const LinearFunction f = linear_through(corners);
    EXPECT_NEAR(by[i], 0.7 * f.value - 0.2 * f.dx + 0.4 * f.dy, 1e-15);
  }
}

}  // namespace
}  // namespace glint

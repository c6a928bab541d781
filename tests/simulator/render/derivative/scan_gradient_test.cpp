// SPDX-License-Identifier: GPL-3.0-or-later
//
// Derivatives of scans against central differences of what they differentiate.
#include "simulator/render/derivative/scan_gradient.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "simulator/render/derivative/gradient_kernels.h"
#include "simulator/render/scan/width_rows.h"
#include "tests/simulator/render/footprint/footprint_fixtures.h"

namespace glint {
namespace {

/// The same pixels by table and by frames, for footprints nearby: what a central difference needs.
ScanPlan with_same_pixels(const ScanPlan& plan,
                          const Footprints& footprints,
                          const Sensor& sensor) {
  ScanPlan same = plan;
  if (plan.form.kind == ScanForm::Kind::kTable) {
    find_tables(footprints, sensor, same);
    WidthRows widths(footprints, sensor);
    std::vector<unsigned char> unused(static_cast<std::size_t>(same.width.width()));
    for (int y = 0; y < same.width.height(); ++y) {
      widths.find(y, same.width.row(y), unused.data());
    }
  }
  return same;
}

/// A small scene of a strip under a round tunnel, with a slot that is mirrored in it.
struct SmallScan {
  TunnelSettings tunnel = test::bench_tunnel();
  ScanSettings scan{.positions = 16};
  SensorSettings sensor{.gain = 1.7, .blur_px = 1.3, .bits = 0};

  static const test::FootprintBench& bench() {
    static const test::FootprintBench one(test::bench_strip(), test::bench_camera());
    return one;
  }
};

/// Pixels in the middle of the picture, away from the part's outline by more than the blur.
Mask middle_region(const VisibilityBuffer& seen) {
  Mask region(seen.width_px, seen.height_px);
  for (int y = 36; y < seen.height_px - 36; ++y) {
    for (int x = 40; x < seen.width_px - 40; ++x) {
      region(x, y) = 1;
    }
  }
  return region;
}

/// The sum of the region's aspect, pixels sorted as at first.
class SmallScanSum {
 public:
  explicit SmallScanSum(const SmallScan& at, const test::FootprintBench& bench = SmallScan::bench())
      : bench_(bench),
        tunnel_(at.tunnel),
        footprints_(rays(), tunnel_, at.scan, bench.camera_mm),
        sensor_(at.sensor, rays().width_px, rays().height_px),
        region_(middle_region(rays())),
        plan_(plan_scan(
            footprints_, sensor_, region_, Mask(rays().width_px, rays().height_px), 1.0)) {}

  const ScanPlan& plan() const { return plan_; }

  ScanGradient gradient(ShapeDerivative& motion) const { return gradient(motion, region_); }

  /// Of the sum over `watched` pixels of the region.
  ScanGradient gradient(ShapeDerivative& motion, const Mask& watched) const {
    ImageF by(rays().width_px, rays().height_px);
    for (std::size_t i = 0; i < by.size(); ++i) {
      by.values()[i] = watched.values()[i] != 0 ? 1e-3F : 0.0F;
    }
    ScanGradient found = gradient_of_scan(footprints_, sensor_, plan_, 1.0, by);
    found.collect(footprints_, motion);
    return found;
  }

  void collect(const ScanGradient& gradient, ShapeDerivative& motion) const {
    gradient.collect(footprints_, motion);
  }

  double at(const SmallScan& moved) const {
    const Tunnel tunnel(moved.tunnel);
    const Footprints footprints(rays(), tunnel, moved.scan, bench_.camera_mm);
    const Sensor sensor(moved.sensor, rays().width_px, rays().height_px);
    const ScanPlan plan = with_same_pixels(plan_, footprints, sensor);
    const ClosedScan closed = scan_closed(footprints, sensor, plan);
    double sum = 0.0;
    for (std::size_t i = 0; i < region_.size(); ++i) {
      sum += region_.values()[i] != 0 ? 1e-3 * static_cast<double>(closed.aspect.values()[i]) : 0.0;
    }
    return sum;
  }

 private:
  const CornerRays& rays() const { return bench_.rays; }

  const test::FootprintBench& bench_;
  Tunnel tunnel_;
  Footprints footprints_;
  Sensor sensor_;
  Mask region_;
  ScanPlan plan_;
};

double scan_difference(const SmallScanSum& sum,
                       const std::function<double&(SmallScan&)>& number,
                       double step,
                       const SmallScan& at = {}) {
  SmallScan high = at;
  SmallScan low = at;
  number(high) += step;
  number(low) -= step;
  return (sum.at(high) - sum.at(low)) / (2.0 * step);
}

/// What a number changes by the light of dark stripes at fixed places of the wall.
double by_dark_nodes(const ScanGradient& gradient,
                     const std::function<double&(SmallScan&)>& number,
                     double step,
                     const SmallScan& at) {
  const auto dark_at = [&](double change) {
    SmallScan moved = at;
    number(moved) += change;
    return Tunnel(moved.tunnel).dark();
  };
  const DarkRadiance here = dark_at(0.0);
  const DarkRadiance high = dark_at(step);
  const DarkRadiance low = dark_at(-step);
  double sum = 0.0;
  for (int node = 0; node < here.num_nodes(); ++node) {
    sum += gradient.dark_nodes[static_cast<std::size_t>(node)] *
           (high.at_node_of(here, node) - low.at_node_of(here, node));
  }
  return sum / (2.0 * step);
}

/// @param tolerance  of all derivatives, relative
void expect_differences(const SmallScan& scene, double tolerance) {
  const SmallScanSum sum(scene);
  ASSERT_GT(sum.plan().form.frame_pixels, 0);
  ASSERT_EQ(sum.plan().form.table_pixels > 0, scene.sensor.blur_px > 0.4);
  ShapeDerivative motion{Tunnel(scene.tunnel)};
  const ScanGradient gradient = sum.gradient(motion);
  EXPECT_EQ(gradient.detached_pixels, 0);
  const auto expect = [&](const char* name,
                          double found,
                          double step,
                          const std::function<double&(SmallScan&)>& number) {
    const double expected = scan_difference(sum, number, step, scene);
    const double all = found + by_dark_nodes(gradient, number, step, scene);
    EXPECT_NE(expected, 0.0) << name;
    EXPECT_NEAR(all, expected, tolerance * std::abs(expected)) << name;
  };
  expect("gain", gradient.gain, 1e-3, [](SmallScan& s) -> double& { return s.sensor.gain; });
  expect("exposure", gradient.exposure, 1e-3, [](SmallScan& s) -> double& {
    return s.sensor.exposure;
  });
  expect("blur", gradient.blur_px, 1e-3, [](SmallScan& s) -> double& { return s.sensor.blur_px; });
  expect("duty", gradient.duty, 1e-4, [](SmallScan& s) -> double& { return s.tunnel.duty; });
  expect("slot", gradient.slot_mm, 1e-2, [](SmallScan& s) -> double& { return s.tunnel.slot_mm; });
  expect("base", motion.derivative_by("base_mm").value(), 1e-2, [](SmallScan& s) -> double& {
    return s.tunnel.base_mm;
  });
  expect("radius", motion.derivative_by("radius_mm").value(), 1e-2, [](SmallScan& s) -> double& {
    return s.tunnel.radius_mm;
  });
}

TEST(GradientOfScan, AgreeWithDifferencesOfASmallScene) {
  expect_differences({}, 2e-3);
}

// Dark stripes from 0.02 to 0.3, of which some are at full scale where the wall is brightest.
TEST(GradientOfScan, AgreeWithDifferencesUnderDarkStripesThatShine) {
  for (const double gain : {1.7, 4.0}) {
    SmallScan scene;
    scene.sensor.gain = gain;
    scene.tunnel.dark_reflectance = 0.7;
    ASSERT_FALSE(Tunnel(scene.tunnel).dark().is_even());
    expect_differences(scene, 5e-3);
  }
}

// Below 0.683 px the blur is cut off at 0, with kinks. At 0.3 px all pixels are frames.
TEST(GradientOfScan, AgreeWithDifferencesBehindANarrowBlur) {
  for (const double blur_px : {0.3, 0.5, 0.6, 0.85}) {
    expect_differences({.sensor = {.gain = 1.7, .blur_px = blur_px, .bits = 0}}, 1e-2);
  }
}

/// A slot through which the camera sees 6 mm of the strip: the wall hides both sides of the region.
SmallScan hidden_scan(TunnelSettings::Shape shape) {
  SmallScan scene;
  scene.tunnel.shape = shape;
  scene.tunnel.slot_mm = 4.0;
  scene.tunnel.half_width_mm = 80.0;
  scene.tunnel.height_mm = 105.0;
  scene.tunnel.exponent = 2.6;
  scene.tunnel.opening_rad = 1.2;
  scene.tunnel.distance_mm = 60.0;
  scene.tunnel.panel_height_mm = 150.0;  // a roof
  return scene;
}

// The edges of what the wall hides move with the slot and the wall.
TEST(GradientOfScan, AgreeWithDifferencesWhereTheWallHidesTheView) {
  using Shape = TunnelSettings::Shape;
  using Number = std::function<double&(SmallScan&)>;
  const Number slot = [](SmallScan& s) -> double& { return s.tunnel.slot_mm; };
  const Number base = [](SmallScan& s) -> double& { return s.tunnel.base_mm; };
  const Number distance = [](SmallScan& s) -> double& { return s.tunnel.distance_mm; };
  const Number height = [](SmallScan& s) -> double& { return s.tunnel.height_mm; };
  const Number radius = [](SmallScan& s) -> double& { return s.tunnel.radius_mm; };
  for (const auto& [shape, key, number] : {std::tuple(Shape::kSemicylinder, "radius_mm", radius),
                                           std::tuple(Shape::kEllipse, "height_mm", height),
                                           std::tuple(Shape::kSuperellipse, "height_mm", height),
                                           std::tuple(Shape::kFlat, "distance_mm", distance)}) {
    for (const double gain : {0.8, 1.7}) {
      SmallScan scene = hidden_scan(shape);
      scene.sensor.gain = gain;
      const SmallScanSum sum(scene);
      ShapeDerivative motion{Tunnel(scene.tunnel)};
      const ScanGradient gradient = sum.gradient(motion);
      EXPECT_GT(gradient.edges.size(), 100U);
      const auto expect = [&, key = key](const char* name, double found, const Number& moved) {
        const double expected = scan_difference(sum, moved, 2e-3, scene);
        EXPECT_GT(std::abs(expected), 1e-4) << name;
        EXPECT_NEAR(found, expected, 1e-2 * std::abs(expected)) << name << " " << key;
      };
      expect("slot", gradient.slot_mm, slot);
      expect("base", motion.derivative_by("base_mm").value(), base);
      expect(key, motion.derivative_by(key).value(), number);
      // Negative control: without the edges' own term it would be noticed.
      ShapeDerivative other{Tunnel(scene.tunnel)};
      ScanGradient held = sum.gradient(other);
      ShapeDerivative without{Tunnel(scene.tunnel)};
      held.edges.clear();
      sum.collect(held, without);
      const double expected = scan_difference(sum, base, 2e-3, scene);
      EXPECT_GT(std::abs(without.derivative_by("base_mm").value() - expected),
                0.1 * std::abs(expected));
    }
  }
}

// A pixel a thousand periods away has the derivatives of one nearby, in plain pixels as in cells.
TEST(GradientOfScan, WholePeriodsOfOffsetChangeNoDerivative) {
  SmallScan scene;
  scene.sensor.gain = 0.8;
  scene.tunnel.duty = 0.43;  // no whole number of frames: their mean has a ripple
  ShapeDerivative motion{Tunnel(scene.tunnel)};
  const ScanGradient near = SmallScanSum(scene).gradient(motion);
  scene.tunnel.offset_mm += 1000.0 * scene.tunnel.period_mm;
  const ScanGradient far = SmallScanSum(scene).gradient(motion);
  const auto expect_same = [](const std::vector<float>& a, const std::vector<float>& b) {
    ASSERT_EQ(a.size(), b.size());
    double largest = 0.0;
    double worst = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      const auto value = static_cast<double>(a[i]);
      largest = std::max(largest, std::abs(value));
      worst = std::max(worst, std::abs(static_cast<double>(b[i]) - value));
    }
    EXPECT_GT(largest, 0.0);
    EXPECT_LT(worst, 1e-4 * largest);
  };
  expect_same(near.corners.x, far.corners.x);
  ASSERT_EQ(near.refined.size(), far.refined.size());
  for (std::size_t g = 0; g < near.refined.size(); ++g) {
    if (!near.refined[g].by_hits.empty()) {
      expect_same(near.refined[g].by_hits.x, far.refined[g].by_hits.x);
    }
  }
}

// A small dent is rendered in one with the smooth pixels on both its sides.
TEST(GradientOfScan, PixelsThatNoScoreLooksAtAreNotDetached) {
  SmallScan scene;
  scene.sensor.blur_px = 0.0;
  const test::FootprintBench dented(test::bench_strip(), test::bench_camera(), 0.06);
  const SmallScanSum sum(scene, dented);
  ShapeDerivative motion{Tunnel(scene.tunnel)};
  EXPECT_GT(sum.gradient(motion).detached_pixels, 0);
  Mask smooth = middle_region(dented.rays);
  for (std::size_t i = 0; i < smooth.size(); ++i) {
    if (dented.rays.kind.values()[i] != PixelKind::kSmooth) {
      smooth.values()[i] = 0;
    }
  }
  EXPECT_EQ(sum.gradient(motion, smooth).detached_pixels, 0);
}

TEST(GradientOfScan, RefuseAScanOfBrokenPeriods) {
  SmallScan scene;
  scene.scan.step_mm = 0.3 * scene.tunnel.period_mm;
  scene.scan.positions = 7;
  scene.tunnel.led_ripple = 0.2;
  const SmallScanSum sum(scene);
  ShapeDerivative motion{Tunnel(scene.tunnel)};
  EXPECT_THROW(sum.gradient(motion), ConfigError);
}

}  // namespace
}  // namespace glint

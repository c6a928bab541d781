// SPDX-License-Identifier: GPL-3.0-or-later
//
// Linearly transformed cosines beside quadrature: how exact they are under random rectangles.
//
// A lobe is taken for a cosine over the hemisphere whose directions are changed by a matrix M;
// light of a polygon is then that of the changed polygon on a matt surface, in closed form. M is
// fitted for each width and incidence by the least squares of value over directions, here without a
// table between. Source: E. Heitz, J. Dupuy, S. Hill, D. Neubelt, "Real-time polygonal-light
// shading with linearly transformed cosines", ACM Transactions on Graphics 35(4), 2016.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <Eigen/LU>

#include "core/cpu_clock.h"
#include "tests/simulator/render/direct/direct_bench.h"

namespace glint::direct_test {
namespace {

using Eigen::Matrix3d;

/// The parameters of M: its corner elements and its first two diagonal ones; the last is 1.
using Fit = std::array<double, 4>;

Matrix3d matrix_of(const Fit& fit) {
  Matrix3d m = Matrix3d::Identity();
  m(0, 0) = fit[0];
  m(1, 1) = fit[1];
  m(0, 2) = fit[2];
  m(2, 0) = fit[3];
  return m;
}

/// A direction that the metal draws, BRDF times cosine there, and its density.
struct LobeSample {
  Vector3d direction;
  double value = 0.0;
  double density = 0.0;
};

std::vector<LobeSample> lobe_samples(const Material& metal, const LocalDirection& viewer) {
  constexpr int kPerAxis = 40;
  std::vector<LobeSample> samples;
  for (int i = 0; i < kPerAxis * kPerAxis; ++i) {
    const int row = i / kPerAxis;
    const double u = (i % kPerAxis + 0.5) / kPerAxis;
    const double v = (row + 0.5) / kPerAxis;
    if (const auto drawn = sample(metal, viewer, {u, v, 0.5})) {
      const LocalDirection& to = drawn->to_light;
      const Reflection towards = evaluate(metal, viewer, to);
      samples.push_back(
          {.direction = {to.x, to.y, to.z}, .value = towards.value[0], .density = towards.density});
    }
  }
  return samples;
}

double albedo_of(const std::vector<LobeSample>& samples) {
  double sum = 0.0;
  for (const LobeSample& s : samples) {
    sum += s.value / s.density / 1600.0;
  }
  return sum;
}

/// Mean square of what is off, over directions.
double misfit(const std::vector<LobeSample>& samples, double albedo, const Fit& fit) {
  const Matrix3d inverse = matrix_of(fit).inverse();
  const double determinant = std::abs(inverse.determinant());
  double sum = 0.0;
  for (const LobeSample& s : samples) {
    const Vector3d from = inverse * s.direction;
    const double length = from.norm();
    const double cosine = std::max(0.0, from.z()) / length;
    const double value = albedo * cosine / kPi * determinant / (length * length * length);
    sum += (value - s.value) * (value - s.value) / s.density;
  }
  return sum;
}

/// Coordinate search with shrinking steps, from a lobe around the mirrored direction.
Fit fitted(const std::vector<LobeSample>& samples, double albedo, double alpha, double incidence) {
  Fit best = {alpha, alpha, -std::tan(incidence), std::tan(incidence)};
  best[3] = 0.0;
  double least = misfit(samples, albedo, best);
  double step = 0.2;
  while (step > 1e-4) {
    for (int round = 0; round < 12; ++round) {
      for (std::size_t k = 0; k < 8; ++k) {
        Fit next = best;
        next[k / 2] += (k % 2 == 0 ? step : -step) * std::max(0.2, std::abs(best[k / 2]));
        const double off = misfit(samples, albedo, next);
        best = off < least ? next : best;
        least = std::min(least, off);
      }
    }
    step *= 0.6;
  }
  return best;
}

/// What is left of a polygon above the horizon.
std::vector<Vector3d> above_horizon(const std::vector<Vector3d>& corners) {
  std::vector<Vector3d> kept;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3d& a = corners[i];
    const Vector3d& b = corners[(i + 1) % corners.size()];
    if (a.z() > 0.0) {
      kept.push_back(a);
    }
    if ((a.z() > 0.0) != (b.z() > 0.0)) {
      kept.emplace_back(a + a.z() / (a.z() - b.z()) * (b - a));
    }
  }
  return kept;
}

/// Lambert's formula over pi: what a matt white surface shows.
double matt_radiance(const std::vector<Vector3d>& corners) {
  double sum = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3d a = corners[i].normalized();
    const Vector3d b = corners[(i + 1) % corners.size()].normalized();
    const Vector3d normal = a.cross(b);
    sum += std::atan2(normal.norm(), a.dot(b)) * normal.normalized().z();
  }
  return std::abs(sum) / (2.0 * kPi);
}

std::vector<Vector3d> corners_of(const RectangleShape& s) {
  const Vector3d x = s.half_x_mm * s.frame.x;
  const Vector3d y = s.half_y_mm * s.frame.y;
  const Vector3d& o = s.frame.origin_mm;
  return {o + x + y, o - x + y, o - x - y, o + x - y};
}

/// A rectangle near where the viewer is mirrored to.
RectangleShape rectangle_near(Rng& rng, double incidence) {
  const Vector3d mirrored(-std::sin(incidence), 0.0, std::cos(incidence));
  const Vector3d off(rng.uniform(-0.3, 0.3), rng.uniform(-0.3, 0.3), rng.uniform(-0.1, 0.3));
  const Vector3d towards = (mirrored + off).normalized();
  return {.frame = frame_around(100.0 * towards, -towards),
          .half_x_mm = rng.uniform(5.0, 60.0),
          .half_y_mm = rng.uniform(5.0, 30.0)};
}

/// Errors of both over some rectangles: root of the mean square.
struct Errors {
  double cosines = 0.0;
  double largest = 0.0;
  double sums = 0.0;
};

Errors errors_at(const Metal& metal, double alpha, double incidence) {
  constexpr int kCases = 200;
  const DirectPoint point = point_seen(incidence);
  const auto samples = lobe_samples(metal.material.plain(), point.to_viewer);
  const double albedo = albedo_of(samples);
  const Matrix3d inverse = matrix_of(fitted(samples, albedo, alpha, incidence)).inverse();
  Rng rng(49, Stream::kTest, 0);
  Errors errors;
  for (int k = 0; k < kCases; ++k) {
    const RectangleShape rectangle = rectangle_near(rng, incidence);
    const Lights lights = lights_with({rectangle});
    const double exact = direct_at(lights, metal.numbers, point, 1e-6);
    std::vector<Vector3d> corners;
    for (const Vector3d& corner : above_horizon(corners_of(rectangle))) {
      corners.emplace_back(inverse * corner);
    }
    const double off = albedo * matt_radiance(above_horizon(corners)) - exact;
    errors.cosines += off * off / kCases;
    errors.largest = std::max(errors.largest, std::abs(off));
    errors.sums += std::pow(direct_at(lights, metal.numbers, point) - exact, 2) / kCases;
  }
  return {std::sqrt(errors.cosines), errors.largest, std::sqrt(errors.sums)};
}

TEST(TransformedCosines, AreLessExactThanSums) {
  for (const double alpha : {0.1, 0.2, 0.3, 0.5}) {
    MaterialSettings white = path_test::white_metal({alpha});
    white.multiple_reflections = false;
    const Metal metal(white);
    for (const double degrees : {0.0, 30.0, 50.0, 70.0}) {
      const Errors errors = errors_at(metal, alpha, degrees * kRadPerDeg);
      fmt::print("alpha {:3} at {:2} deg: cosines {:.4f}, at most {:.4f}; sums {:.5f}\n",
                 alpha,
                 degrees,
                 errors.cosines,
                 errors.largest,
                 errors.sums);
      EXPECT_LT(errors.sums, 5e-4);
      EXPECT_LT(errors.cosines, 0.1);
      EXPECT_GT(errors.cosines, errors.sums);
    }
  }
}

}  // namespace
}  // namespace glint::direct_test

// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/surrogate/gaussian_process.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/optimizer/algorithm/problems.h"

namespace glint {
namespace {

struct Data {
  std::vector<Point> points;
  std::vector<double> values;
};

Data sampled(const SearchSpace& space, int count, double noise) {
  Data data;
  Rng rng(3, Stream::kTest, 77);
  for (int i = 0; i < count; ++i) {
    std::vector<double> unit(space.variables.size());
    for (double& u : unit) {
      u = rng.uniform();
    }
    data.points.push_back(point_from_unit(space, unit));
    const Point& p = data.points.back();
    const double value = p.size() == 7 ? test::mixed_value(p) : std::sin(4.0 * p[0]) + p[1] * p[1];
    data.values.push_back(value + noise * rng.normal());
  }
  return data;
}

TEST(GaussianProcess, OfOnePointFollowsTheKernel) {
  GaussianProcess process(test::box(1, 0, 1));
  KernelParameters parameters(3);
  parameters << std::log(0.5), 0.0, std::log(0.25);
  process.set(parameters, std::vector<Point>{{0.2}}, std::vector<double>{3.0});
  // The mean is the only value. At distance 0.3, r = 0.6: k = (1 + 1.3416 + 0.6) exp(-1.3416)
  // = 0.76887; variance = 1 - k^2 / 1.25 = 0.52707.
  const Posterior there = process.predict(Point{0.5});
  EXPECT_NEAR(there.mean, 3.0, 1e-12);
  EXPECT_NEAR(there.variance, 0.52707, 2e-4);
}

TEST(GaussianProcess, LearnsASmoothFunctionAndItsNoise) {
  const SearchSpace space = test::box(2, 0, 1);
  const Data data = sampled(space, 120, 0.1);
  GaussianProcess process(space);
  process.fit(data.points, data.values);
  EXPECT_NEAR(process.noise(), 0.1, 0.03);
  EXPECT_NEAR(process.predict(Point{0.5, 0.5}).mean, std::sin(2.0) + 0.25, 0.1);
  EXPECT_GT(process.leave_one_out_q2(), 0.8);
  EXPECT_NEAR(process.means_at_points()[5], process.predict(data.points[5]).mean, 1e-9);
}

TEST(GaussianProcess, FindsNoEvidenceInPureNoise) {
  const SearchSpace space = test::box(2, 0, 1);
  Data data = sampled(space, 60, 0.0);
  Rng rng(8, Stream::kTest, 1);
  for (double& value : data.values) {
    value = rng.normal();
  }
  GaussianProcess process(space);
  process.fit(data.points, data.values);
  EXPECT_LT(process.leave_one_out_q2(), 0.3);
}

// Two values are added that leave mean and spread of all as they were, so that the parameters mean
// the same to both.
TEST(GaussianProcess, AddingOneByOneIsTheSameAsAllAtOnce) {
  for (const SearchSpace& space : {test::box(2, 0, 1), test::mixed_space()}) {
    Data data = sampled(space, 40, 0.05);
    GaussianProcess grown(space);
    grown.fit(data.points, data.values);
    const Eigen::Map<const Eigen::VectorXd> values(data.values.data(), 40);
    const double mean = values.mean();
    const double spread = std::sqrt((values.array() - mean).square().mean());
    for (const double sign : {-1.0, 1.0}) {
      data.points.push_back(data.points[7]);
      data.values.push_back(mean + sign * spread);
      grown.add(data.points.back(), data.values.back());
    }
    GaussianProcess whole(space);
    whole.set(grown.parameters(), data.points, data.values);
    EXPECT_NEAR(grown.predict(data.points[3]).mean, whole.predict(data.points[3]).mean, 1e-6);
    EXPECT_NEAR(
        grown.predict(data.points[3]).variance, whole.predict(data.points[3]).variance, 1e-6);
  }
}

TEST(GaussianProcess, LeaveOneOutIsWhatIsPredictedWithoutTheValue) {
  const SearchSpace space = test::box(2, 0, 1);
  const Data data = sampled(space, 25, 0.05);
  GaussianProcess process(space);
  process.fit(data.points, data.values);
  const std::vector<Posterior> expected = process.leave_one_out();
  std::vector<Point> points(data.points.begin() + 1, data.points.end());
  std::vector<double> values(data.values.begin() + 1, data.values.end());
  GaussianProcess without(space);
  without.set(process.parameters(), points, values);
  // The scale of the values differs a little without one of them.
  EXPECT_NEAR(expected[0].mean, without.predict(data.points[0]).mean, 0.05);
}

TEST(GaussianProcess, SurvivesDuplicatesAndConstants) {
  const SearchSpace space = test::box(3, 0, 1);
  const std::vector<Point> points(20, Point{0.5, 0.5, 0.5});
  GaussianProcess process(space, {.is_noisy = false});
  process.fit(points, std::vector<double>(20, 7.0));
  EXPECT_NEAR(process.predict(Point{0.1, 0.2, 0.3}).mean, 7.0, 1e-9);
  EXPECT_EQ(process.leave_one_out_q2(), 0.0);
}

TEST(GaussianProcess, KnowsBranchesAndForgetsInactiveVariables) {
  const SearchSpace space = test::mixed_space();
  const Data data = sampled(space, 150, 0.0);
  GaussianProcess process(space, {.is_noisy = false});
  process.fit(data.points, data.values);
  EXPECT_GT(process.leave_one_out_q2(), 0.7);
  const Encoding& encoding = process.encoding();
  const Point flat = canonical(space, Point{1, 1, 30, 6, 0, 12, 3});
  Point other = flat;
  other[5] = 19.0;  // radius is not active where shape is flat
  EXPECT_EQ(encoding.row(flat), encoding.row(other));
}

TEST(GaussianProcess, GivesTheSameBitsAgain) {
  const SearchSpace space = test::mixed_space();
  const Data data = sampled(space, 60, 0.1);
  GaussianProcess a(space);
  GaussianProcess b(space);
  a.fit(data.points, data.values);
  b.fit(data.points, data.values);
  EXPECT_EQ(a.predict(data.points[3]).mean, b.predict(data.points[3]).mean);
  EXPECT_EQ(a.parameters(), b.parameters());
}

}  // namespace
}  // namespace glint

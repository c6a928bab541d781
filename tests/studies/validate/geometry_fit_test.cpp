// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/geometry_fit.h"

#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "core/rng.h"
#include "hardware/calibration/lens_vector.h"
#include "studies/validate/validated_scene.h"

namespace glint {
namespace {

constexpr double kDegree = 0.017453292519943295;

PinholeIntrinsics camera() {
  return {.width_px = 600,
          .height_px = 500,
          .focal_px = {1800, 1800},
          .center_px = {300, 250},
          .radial = {-0.08, 0, 0}};
}

GeometryBudget budget() {
  GeometryBudget budget;
  Eigen::Matrix<double, 15, 1> sigma;
  sigma << 0.5, 0.5, 0.5, 0.5, 0.005, 0.0, 0.0, 1e-4, 1e-4, 2e-4, 2e-4, 2e-4, 0.04, 0.04, 0.04;
  budget.camera = sigma.cwiseAbs2().asDiagonal();
  budget.part_sigma << 3e-4, 3e-4, 3e-4, 0.03, 0.03, 0.03;
  return budget;
}

/// Edges of a plate of 48 x 36 mm with a step of 5 mm, seen from five tilted views, moved by true
/// changes of lens and part, with noise of 0.1 px.
std::vector<ViewEdges> edges_of(const Eigen::Matrix<double, 9, 1>& lens_change,
                                const Eigen::Matrix<double, 6, 1>& part,
                                const Eigen::Matrix<double, 6, 1>& hand_eye,
                                std::uint64_t seed,
                                const std::vector<Eigen::Matrix<double, 6, 1>>& robot = {}) {
  std::vector<ViewEdges> views;
  const LensVector lens = lens_vector(camera());
  const LensVector true_lens = lens + lens_change;
  GeometryFit truth;
  truth.part = part;
  truth.hand_eye = hand_eye;
  truth.robot = robot;
  Rng random(seed, Stream::kViewpoints, 0);
  const double tilts[5][2] = {{0, 0}, {0.25, 0}, {-0.25, 0.1}, {0.1, 0.25}, {-0.1, -0.25}};
  for (const auto& tilt : tilts) {
    Eigen::Matrix<double, 6, 1> motion;
    motion << tilt[0], tilt[1], 0.3, 0, 0, 0;
    RigidTransform pose = moved_by(motion);
    pose.translation_mm = {0.0, 0.0, 180.0};
    ViewEdges view = {.camera_from_scene = pose, .robot_sigma_mm = 0.02, .robot_sigma_rad = 1e-4};
    const RigidTransform moved = refitted_view(truth, budget(), pose, views.size());
    for (int i = 0; i < 800; ++i) {
      const double along = (i % 200) / 100.0 - 1.0;
      const int side = i / 200;
      const Eigen::Vector3d at = side < 2 ? Eigen::Vector3d(24 * along, side == 0 ? 18 : -18, 0)
                                          : Eigen::Vector3d(side == 2 ? 24 : -24, 18 * along, -5);
      const auto before = project_by_lens(lens, pose * at, nullptr);
      const auto after = project_by_lens(true_lens, moved * at, nullptr);
      const Eigen::Vector3d out = side < 2 ? Eigen::Vector3d(0, side == 0 ? 1 : -1, 0)
                                           : Eigen::Vector3d(side == 2 ? 1 : -1, 0, 0);
      const auto beyond = project_by_lens(lens, pose * (at + 0.01 * out), nullptr);
      const Eigen::Vector2d normal = (*beyond - *before).normalized();
      view.edges.push_back({.in_camera_mm = pose * at,
                            .normal = normal,
                            .offset_px = normal.dot(*after - *before) + 0.1 * random.normal()});
    }
    views.push_back(std::move(view));
  }
  return views;
}

using Vector9 = Eigen::Matrix<double, 9, 1>;
using Vector6 = Eigen::Matrix<double, 6, 1>;

TEST(GeometryFit, TellsNothingOfEdgesThatLieWhereTheyShould) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const auto views = edges_of(Vector9::Zero(), Vector6::Zero(), Vector6::Zero(), seed);
    const GeometryFit fit = fit_geometry(views, camera(), budget());
    EXPECT_TRUE(fit.is_known);
    EXPECT_TRUE(fit.faults.empty()) << seed;
    EXPECT_NEAR(fit.noise_px, 0.1, 0.02);
  }
}

TEST(GeometryFit, TellsAPartThatIsTurned) {
  Vector6 part = Vector6::Zero();
  part[2] = 3.0 * kDegree;
  const GeometryFit fit =
      fit_geometry(edges_of(Vector9::Zero(), part, Vector6::Zero(), 3), camera(), budget());
  ASSERT_EQ(fit.faults.size(), 1U);
  EXPECT_EQ(fit.faults[0], GeometryFault::kPartPose);
  EXPECT_NEAR(fit.part[2], part[2], 0.1 * kDegree);
}

TEST(GeometryFit, TellsAnotherLens) {
  Vector9 lens = Vector9::Zero();
  lens[0] = lens[1] = 54.0;
  GeometryFit fit =
      fit_geometry(edges_of(lens, Vector6::Zero(), Vector6::Zero(), 4), camera(), budget());
  ASSERT_EQ(fit.faults.size(), 1U);
  EXPECT_EQ(fit.faults[0], GeometryFault::kFocalLength);
  EXPECT_NEAR(fit.lens[0], 54.0, 3.0);
  lens = Vector9::Zero();
  lens[4] = 0.25;
  fit = fit_geometry(edges_of(lens, Vector6::Zero(), Vector6::Zero(), 5), camera(), budget());
  ASSERT_EQ(fit.faults.size(), 1U);
  EXPECT_EQ(fit.faults[0], GeometryFault::kDistortion);
}

TEST(GeometryFit, TellsAHandEyeThatIsOff) {
  Vector6 hand_eye;
  hand_eye << 1.0 * kDegree, -0.5 * kDegree, 0.8 * kDegree, 1.0, -1.0, 0.5;
  const GeometryFit fit =
      fit_geometry(edges_of(Vector9::Zero(), Vector6::Zero(), hand_eye, 6), camera(), budget());
  ASSERT_FALSE(fit.faults.empty());
  EXPECT_EQ(fit.faults.back(), GeometryFault::kHandEye);
}

TEST(GeometryFit, RefittedViewTakesThePartAlong) {
  // A part moved by (1, 0, 0) lies where it would for a camera moved by (-1, 0, 0).
  GeometryFit fit;
  fit.part << 0, 0, 0, 1, 0, 0;
  const RigidTransform pose = {.translation_mm = {0, 0, 180}};
  EXPECT_LT((refitted_view(fit, {}, pose, 0).translation_mm - Eigen::Vector3d(1, 0, 180)).norm(),
            1e-12);
  fit.part.setZero();
  fit.hand_eye << 0, 0, 0, 1, 0, 0;
  EXPECT_LT((refitted_view(fit, {}, pose, 0).translation_mm - Eigen::Vector3d(-1, 0, 180)).norm(),
            1e-12);
}

Vector6 drawn(Rng& random, double turn_rad, double shift_mm) {
  Vector6 motion;
  for (Eigen::Index i = 0; i < 6; ++i) {
    motion[i] = (i < 3 ? turn_rad : shift_mm) * random.normal();
  }
  return motion;
}

// Hand-eye, part and robot are off by what their sigmas say; what the edges leave of it is told.
TEST(GeometryFit, KnowsHowWellTheCameraIsKnown) {
  constexpr int kTrials = 60;
  int within = 0;
  int all = 0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Rng random(static_cast<std::uint64_t>(trial), Stream::kTest, 5);
    GeometryFit truth;
    truth.part = drawn(random, 3e-4, 0.03);
    truth.hand_eye = drawn(random, 2e-4, 0.04);
    for (int v = 0; v < 5; ++v) {
      truth.robot.push_back(drawn(random, 1e-4, 0.02));
    }
    const auto views = edges_of(Vector9::Zero(),
                                truth.part,
                                truth.hand_eye,
                                static_cast<std::uint64_t>(100 + trial),
                                truth.robot);
    const GeometryFit fit = fit_geometry(views, camera(), budget());
    for (std::size_t v = 0; v < views.size(); ++v) {
      const RigidTransform& pose = views[v].camera_from_scene;
      const RigidTransform off =
          refitted_view(fit, budget(), pose, v) * inverse(refitted_view(truth, budget(), pose, v));
      const Eigen::AngleAxisd turn(off.rotation);
      const auto at = static_cast<Eigen::Index>(9 + 6 * v);
      const Eigen::Vector3d sigma = fit.covariance.diagonal().segment<3>(at).cwiseSqrt();
      for (Eigen::Index i = 0; i < 3; ++i) {
        within += std::abs(turn.angle() * turn.axis()[i]) < 1.96 * sigma[i] ? 1 : 0;
        ++all;
      }
    }
  }
  const double share = static_cast<double>(within) / all;
  fmt::print("turns within 95 % intervals: {:.3f} of {}\n", share, all);
  EXPECT_GT(share, 0.88);
  EXPECT_LT(share, 0.99);
}

TEST(GeometryFit, KnowsNothingOfAFewEdges) {
  std::vector<ViewEdges> views(1);
  views[0].edges.resize(49, {.in_camera_mm = {0, 0, 180}});
  EXPECT_FALSE(fit_geometry(views, camera(), budget()).is_known);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/variance_components.h"

#include <gtest/gtest.h>

#include "hardware/calibration/bundle_adjustment.h"
#include "hardware/calibration/joint_fit.h"
#include "tests/hardware/calibration/simulated_cell.h"

namespace glint {
namespace {

/// Noisy views at the truth, with noise sizes that are off by some factor.
Bundle noisy_bundle(const SimulatedCell& cell, double factor) {
  Bundle bundle = bundle_at_truth(cell);
  bundle.noise.corner_px *= factor;
  bundle.noise.robot_rad *= factor;
  bundle.noise.robot_mm /= factor;
  for (std::size_t i = 0; i < cell.pictures.size(); ++i) {
    bundle.views[i] = joint_view(cell.pictures[i], cell.base_from_flange[i]);
  }
  return bundle;
}

class Sizes : public testing::TestWithParam<double> {};

TEST_P(Sizes, AreFoundFromTheDataWhateverTheStart) {
  const SimulatedCell cell = simulate_cell({}, 1);
  Bundle bundle = noisy_bundle(cell, GetParam());
  EstimatedNoise found;
  ASSERT_TRUE(fit_joint(bundle, 10, &found));
  const NoiseSizes& truth = cell.settings.noise;
  const Eigen::Vector3d logs(std::log(found.noise.corner_px / truth.corner_px),
                             std::log(found.noise.robot_rad / truth.robot_rad),
                             std::log(found.noise.robot_mm / truth.robot_mm));
  // 12 800 rows know the corner noise to 1 / sqrt(2 * 12 800) = 0.6 %, 240 numbers the robot's to
  // 1 / sqrt(2 * 240) = 4.6 % or a little less well.
  EXPECT_NEAR(found.log_sigma[0], 0.0064, 0.001);
  EXPECT_GT(found.log_sigma[1], 0.04);
  EXPECT_LT(found.log_sigma[1], 0.09);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(std::abs(logs[i]), 3.3 * found.log_sigma[i] + 0.006) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Starts, Sizes, testing::Values(0.2, 1.0, 5.0));

TEST(EstimateNoise, DoesNotBlameTheRobotForErrorsThatNeighboursShare) {
  const NoiseSizes truth = {.corner_px = 0.1, .robot_rad = 1e-4, .robot_mm = 0.02};
  const SimulatedCell cell = simulate_cell({.num_poses = 30, .noise = truth, .shared_px = 0.3}, 4);
  Bundle bundle = noisy_bundle(cell, 1.0);
  ASSERT_TRUE(fit_joint(bundle, 10, nullptr));
  EXPECT_GT(bundle.noise.pattern_px, 3.0 * bundle.noise.corner_px);
  EXPECT_LT(bundle.noise.robot_mm, 0.05);
  // Negative control: corners with independent errors, the patterns' size is near the corners'.
  const SimulatedCell plain = simulate_cell({.num_poses = 30, .noise = truth}, 4);
  Bundle other = noisy_bundle(plain, 1.0);
  ASSERT_TRUE(fit_joint(other, 10, nullptr));
  EXPECT_LT(other.noise.pattern_px, 2.0 * other.noise.corner_px);
}

TEST(EstimateNoise, MaximisesTheRestrictedLikelihood) {
  const SimulatedCell cell = simulate_cell({.num_poses = 20}, 2);
  Bundle bundle = noisy_bundle(cell, 1.0);
  ASSERT_TRUE(fit_joint(bundle, 10, nullptr));
  const CompressedBundle compressed = compress(bundle);
  const double best = shared_information(bundle, compressed, bundle.noise).minus_two_log_likelihood;
  for (const double factor : {0.9, 1.1}) {
    NoiseSizes corner = bundle.noise;
    corner.corner_px *= factor;
    NoiseSizes turn = bundle.noise;
    turn.robot_rad *= factor;
    NoiseSizes shift = bundle.noise;
    shift.robot_mm *= factor;
    for (const NoiseSizes& noise : {corner, turn, shift}) {
      EXPECT_GT(shared_information(bundle, compressed, noise).minus_two_log_likelihood, best);
    }
  }
}

TEST(SharedInformation, HasNoGradientAtTheSolution) {
  // The compressed form and the minimiser must speak of the same problem.
  const SimulatedCell cell = simulate_cell({.num_poses = 20}, 3);
  Bundle bundle = noisy_bundle(cell, 1.0);
  ASSERT_TRUE(fit_joint(bundle, 10, nullptr));
  ASSERT_TRUE(adjust_bundle(bundle).has_converged);
  const SharedInformation information = shared_information(bundle, compress(bundle), bundle.noise);
  const Eigen::VectorXd step = inverse_information(information.hessian) * information.gradient;
  const Eigen::VectorXd sigma = inverse_information(information.hessian).diagonal().cwiseSqrt();
  EXPECT_LT(step.cwiseQuotient(sigma).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(InverseInformation, OfADiagonalIsItsReciprocal) {
  const Eigen::MatrixXd hessian = Eigen::Vector3d(1e-6, 4.0, 1e8).asDiagonal();
  const Eigen::MatrixXd inverse = inverse_information(hessian);
  EXPECT_NEAR(inverse(0, 0), 1e6, 1e-3);
  EXPECT_NEAR(inverse(1, 1), 0.25, 1e-12);
  EXPECT_NEAR(inverse(2, 2), 1e-8, 1e-18);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether the sigmas of a fit of grey values hold what lens and poses are known to.
#include "studies/validate/camera_errors.h"

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "core/file.h"
#include "core/rng.h"
#include "core/units.h"
#include "hardware/calibration/lens_vector.h"
#include "studies/compare/camera/scene_camera.h"
#include "studies/definition/study.h"
#include "studies/validate/validated_scene.h"
#include "tests/studies/validate/trial_cell.h"
#include "tests/support/temporary_folder.h"

namespace glint::validate_detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr Index kPixels = 2000;
constexpr double kNoise = 0.01;

/// A pattern over the pixels.
VectorXd wave(double frequency, double phase) {
  VectorXd values(kPixels);
  for (Index i = 0; i < kPixels; ++i) {
    values[i] = std::sin(frequency * static_cast<double>(i) + phase);
  }
  return values;
}

VectorXd normal_numbers(Rng& random, Index count) {
  VectorXd values(count);
  for (Index i = 0; i < count; ++i) {
    values[i] = random.normal();
  }
  return values;
}

/// Three numbers that are fitted, and four errors of the camera that look much the same.
struct Rig {
  GreySystem system;
  std::vector<GreyHalves> by;
  MatrixXd root = MatrixXd(4, 4);  ///< of the errors' covariance

  Rig() {
    for (int i = 0; i < 3; ++i) {
      const VectorXd slope = 0.1 * wave(0.01 + 0.013 * i, 0.3 * i);
      system.add({slope, slope}, {.term = {.fault = GreyFault::kLightPlace}, .index = i});
    }
    for (int i = 0; i < 4; ++i) {
      const VectorXd slope = 0.2 * wave(0.01 + 0.013 * (i % 3), 0.5) + 0.1 * wave(0.05 * i, 0.1);
      by.push_back({slope, slope});
    }
    root << 0.3, 0, 0, 0, 0.1, 0.2, 0, 0, -0.2, 0.1, 0.25, 0, 0.05, 0, 0.1, 0.3;
  }
};

struct Coverage {
  double told = 0.0;   ///< share of trials within 1.96 sigmas that hold the camera's errors
  double noise = 0.0;  ///< within 1.96 sigmas of pixels' noise alone
};

Coverage coverage_of(const Rig& rig, int trials) {
  Rng random(11, Stream::kTest, 0);
  Coverage covered;
  for (int trial = 0; trial < trials; ++trial) {
    const VectorXd errors = rig.root * normal_numbers(random, 4);
    VectorXd seen = kNoise * normal_numbers(random, kPixels);
    for (std::size_t i = 0; i < 4; ++i) {
      seen += errors[static_cast<Index>(i)] * rig.by[i][0];
    }
    const GreyHalves left = {seen, seen};  // the numbers' true values are 0
    VectorXd sigma;
    const VectorXd step = step_of(rig.system, left, &sigma);
    const VectorXd added =
        added_variance(rig.system, left, rig.by, rig.root * rig.root.transpose());
    for (Index i = 0; i < 3; ++i) {
      const double whole = std::sqrt(sigma[i] * sigma[i] + added[i]);
      covered.told += std::abs(step[i]) < 1.96 * whole ? 1.0 : 0.0;
      covered.noise += std::abs(step[i]) < 1.96 * sigma[i] ? 1.0 : 0.0;
    }
  }
  covered.told /= 3.0 * trials;
  covered.noise /= 3.0 * trials;
  return covered;
}

TEST(CameraErrors, IntervalsHoldWhatTheCameraIsKnownTo) {
  const Coverage covered = coverage_of(Rig(), 500);
  fmt::print("within 95 % intervals: {:.3f}, by the noise of pixels alone {:.3f}\n",
             covered.told,
             covered.noise);
  EXPECT_GT(covered.told, 0.88);
  EXPECT_LT(covered.told, 0.99);
  EXPECT_LT(covered.noise, 0.6) << "or there is nothing to be added";
}

SceneSettings calibrated_scene(const MatrixXd& covariance) {
  const TemporaryFolder folder;
  write_file(folder / "scene.toml", kTrialScene);
  SceneSettings scene = load_study(folder / "scene.toml", {}).scene;
  scene.calibration->covariance = covariance_settings(covariance);
  return scene;
}

/// Of a calibration that moved fx fy cx cy and the hand-eye.
MatrixXd covariance_without_distortion() {
  VectorXd sigma = VectorXd::Constant(15, 1e-3);
  sigma.head<4>().setConstant(0.5);
  sigma.segment<5>(4).setZero();
  return sigma.cwiseAbs2().asDiagonal();
}

// p1 and p2 move a pixel by f p (x^2 + y^2 - r^2) more than the turn and the centre that go along.
TEST(CameraErrors, OfTangentialTermsThatWereLeftAtZeroAreATurnAndACentre) {
  const SceneSettings scene = calibrated_scene(covariance_without_distortion());
  std::vector<std::string> notes;
  const GeometryBudget budget = budget_of(scene, notes);
  const PinholeIntrinsics in = intrinsics_of(scene);
  const LensVector lens = lens_vector(in);
  const double focal_px = in.focal_px.x();
  const double mean = (204.0 * 204.0 + 170.0 * 170.0) / (12.0 * focal_px * focal_px);
  for (Index number = 0; number < 2; ++number) {
    const Eigen::Matrix<double, 15, 1> change = budget.unseen.col(number);
    const double p = change[7 + number];
    EXPECT_GT(p, 1e-4);
    const RigidTransform moved = inverse(moved_by(change.tail<6>()));
    for (const double x : {-0.16, -0.05, 0.1}) {
      for (const double y : {-0.12, 0.03, 0.13}) {
        const Eigen::Vector3d at(180.0 * x, 180.0 * y, 180.0);
        const auto before = project_by_lens(lens, at, nullptr);
        const auto after = project_by_lens(lens + change.head<9>(), moved * at, nullptr);
        Eigen::Vector2d expected = Eigen::Vector2d::Zero();
        expected[1 - number] = focal_px * p * (x * x + y * y - mean);
        EXPECT_LT((*after - *before - expected).norm(), 1e-3) << number << " " << x << " " << y;
      }
    }
  }
}

TEST(CameraErrors, OfTangentialTermsThatWereMeasuredAreThoseOfTheCalibration) {
  MatrixXd covariance = covariance_without_distortion();
  covariance(7, 7) = covariance(8, 8) = 1e-8;
  std::vector<std::string> notes;
  EXPECT_TRUE(budget_of(calibrated_scene(covariance), notes).unseen.isZero());
}

constexpr double kGuessedRad = 0.02 * kRadPerDeg;
constexpr double kGuessedMm = 0.05;

// 0 says that a number is not known, not that it is exact.
TEST(Budget, GuessesEachNumberOfThePartsPlaceThatIsNotTold) {
  SceneSettings scene = calibrated_scene(covariance_without_distortion());
  MeasuredPoseSettings& placement = *scene.cell->base_from_part;
  placement.sigma_mm = {0.1, 0.1, 0.0};
  placement.sigma_rad = {0.0, 0.0, 0.0};
  std::vector<std::string> notes;
  const GeometryBudget budget = budget_of(scene, notes);
  VectorXd expected(6);
  expected << kGuessedRad, kGuessedRad, kGuessedRad, 0.1, 0.1, kGuessedMm;
  EXPECT_TRUE(budget.part_sigma.isApprox(expected, 1e-12)) << budget.part_sigma.transpose();
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0],
            "How well the part's place is known is stated in part: of the rest 0.05 mm and 0.02 "
            "degree are assumed.");
  placement.sigma_mm = {0.0, 0.0, 0.0};
  placement.sigma_rad = {1e-3, 1e-3, 1e-3};
  EXPECT_NEAR(budget_of(scene, notes).part_sigma[0], 1e-3, 1e-12) << "rotations alone";
}

TEST(Budget, HasNoNoteOnWhatIsToldInFull) {
  std::vector<std::string> notes;
  budget_of(calibrated_scene(covariance_without_distortion()), notes);
  EXPECT_TRUE(notes.empty()) << notes[0];
}

TEST(Budget, GuessesWhatACovarianceLeavesOpen) {
  SceneSettings scene = calibrated_scene(covariance_without_distortion());
  CovarianceSettings& covariance = *scene.calibration->covariance;
  const CovarianceSettings both = covariance;
  covariance.hand_eye.clear();
  covariance.cross.clear();
  scene.calibration->flange_from_camera->sigma_rad = {0.0, 0.0, 0.0};
  std::vector<std::string> notes;
  const GeometryBudget lens = budget_of(scene, notes);
  EXPECT_NEAR(std::sqrt(lens.camera(9, 9)), kGuessedRad, 1e-12);
  EXPECT_NEAR(std::sqrt(lens.camera(12, 12)), 0.04, 1e-12) << "as flange_from_camera says";
  ASSERT_EQ(notes.size(), 1U);
  covariance = both;
  covariance.intrinsics.clear();
  covariance.cross.clear();
  const GeometryBudget hand_eye = budget_of(scene, notes);
  EXPECT_GT(hand_eye.camera(0, 0), 0.0) << "the focal length is not exact";
  EXPECT_NEAR(std::sqrt(hand_eye.camera(9, 9)), 1e-3, 1e-12);
  ASSERT_EQ(notes.size(), 2U);
}

}  // namespace
}  // namespace glint::validate_detail

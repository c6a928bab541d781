// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/cell_settings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include <fmt/format.h>
#include <Eigen/Eigenvalues>

namespace glint {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr Index kIntrinsics = 9;
constexpr Index kHandEye = 6;
constexpr std::array<std::string_view, 3> kSetups = {"none", "eye_in_hand", "eye_to_hand"};

/// Calls a function with row, column and place in the list of each number of a triangle.
template <class Function>
void for_triangle(Index first, Index size, const Function& function) {
  std::size_t at = 0;
  for (Index row = 0; row < size; ++row) {
    for (Index column = 0; column <= row; ++column) {
      function(first + row, first + column, at++);
    }
  }
}

template <class Function>
void for_cross(const Function& function) {
  std::size_t at = 0;
  for (Index row = 0; row < kHandEye; ++row) {
    for (Index column = 0; column < kIntrinsics; ++column) {
      function(kIntrinsics + row, column, at++);
    }
  }
}

/// Whether a symmetric matrix can be a covariance: no negative variance in any direction, but for
/// rounding. What is exact has neither variance nor covariances.
bool is_covariance(const MatrixXd& matrix) {
  constexpr double kRounding = 1e-6;
  const Eigen::VectorXd variances = matrix.diagonal();
  MatrixXd correlation = MatrixXd::Identity(matrix.rows(), matrix.cols());
  for (Index i = 0; i < matrix.rows(); ++i) {
    for (Index k = 0; k < i; ++k) {
      if (!(variances[i] > 0.0) || !(variances[k] > 0.0)) {
        if (matrix(i, k) != 0.0) {
          return false;
        }
        continue;
      }
      correlation(i, k) = matrix(i, k) / std::sqrt(variances[i] * variances[k]);
    }
  }
  const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(correlation, Eigen::EigenvaluesOnly);
  return variances.minCoeff() >= 0.0 && solver.eigenvalues().minCoeff() >= -kRounding;
}

bool is_told(const std::vector<double>& sigma) {
  return sigma != std::vector<double>{0.0, 0.0, 0.0};
}

bool agree(const std::vector<double>& told, const std::vector<double>& roots) {
  constexpr double kTolerance = 0.01;
  bool are_near = true;
  for (std::size_t i = 0; i < roots.size(); ++i) {
    are_near = are_near && std::abs(told[i] - roots[i]) <= kTolerance * roots[i];
  }
  return are_near;
}

void check_setup(KeyVisitor& keys, CalibrationSettings& s) {
  const bool is_on_flange = s.flange_from_camera.has_value();
  const bool is_beside = s.base_from_camera.has_value();
  keys.require(!is_on_flange || !is_beside,
               "base_from_camera",
               "cannot be given beside flange_from_camera: a camera is fixed in one place");
  if (!keys.is_given("setup")) {
    s.setup = is_on_flange ? CalibrationSetup::kEyeInHand
              : is_beside  ? CalibrationSetup::kEyeToHand
                           : s.setup;
  }
  keys.require((s.setup == CalibrationSetup::kEyeInHand) == is_on_flange,
               "setup",
               "must be \"eye_in_hand\" with [calibration.flange_from_camera], and only with it");
  keys.require((s.setup == CalibrationSetup::kEyeToHand) == is_beside,
               "setup",
               "must be \"eye_to_hand\" with [calibration.base_from_camera], and only with it");
}

void check_covariance(KeyVisitor& keys, CalibrationSettings& s) {
  std::optional<MeasuredPoseSettings>& pose =
      s.flange_from_camera ? s.flange_from_camera : s.base_from_camera;
  const bool has_hand_eye = s.covariance && !s.covariance->hand_eye.empty();
  keys.require(!has_hand_eye || pose,
               "covariance",
               "hand_eye is of a pose that is not there: give flange_from_camera or "
               "base_from_camera");
  if (!has_hand_eye || !pose) {
    return;
  }
  MeasuredPoseSettings roots = *pose;
  take_sigmas(*s.covariance, roots);
  keys.require((!is_told(pose->sigma_mm) || agree(pose->sigma_mm, roots.sigma_mm)) &&
                   (!is_told(pose->sigma_rad) || agree(pose->sigma_rad, roots.sigma_rad)),
               s.flange_from_camera ? "flange_from_camera" : "base_from_camera",
               "sigma_mm and sigma_deg do not agree with covariance.hand_eye, whose diagonal has "
               "their squares in rad and mm; leave them out or correct them");
  if (!is_told(pose->sigma_mm)) {
    pose->sigma_mm = roots.sigma_mm;
  }
  if (!is_told(pose->sigma_rad)) {
    pose->sigma_rad = roots.sigma_rad;
  }
}

}  // namespace

void visit_keys(KeyVisitor& keys, CovarianceSettings& s) {
  keys.numbers("intrinsics",
               s.intrinsics,
               {.min = 0, .max = 45},
               Range{},
               "45 numbers: covariance of fx fy cx cy [px] k1 k2 k3 p1 p2, row by row up to the "
               "diagonal; [] = not known");
  keys.numbers("hand_eye",
               s.hand_eye,
               {.min = 0, .max = 21},
               Range{},
               "21 numbers: covariance of a small motion in the camera's frame, rotation x y z "
               "[rad] and position x y z [mm], row by row up to the diagonal; [] = not known");
  keys.numbers("cross",
               s.cross,
               {.min = 0, .max = 54},
               Range{},
               "54 numbers: covariances of these six (rows) with the nine intrinsics (columns); "
               "[] = none");
  const auto has_size = [&](const char* key, const std::vector<double>& values, std::size_t size) {
    const bool is_right = values.empty() || values.size() == size;
    keys.require(is_right, key, fmt::format("has {} numbers, must have {}", values.size(), size));
    return is_right;
  };
  if (!has_size("intrinsics", s.intrinsics, 45) || !has_size("hand_eye", s.hand_eye, 21) ||
      !has_size("cross", s.cross, 54)) {
    s = {};
    return;
  }
  const bool can_cross = s.cross.empty() || (!s.intrinsics.empty() && !s.hand_eye.empty());
  keys.require(can_cross, "cross", "needs intrinsics and hand_eye, between which it is");
  const MatrixXd matrix = can_cross ? covariance_of(s) : MatrixXd();
  keys.require(matrix.rows() == 0 || is_covariance(matrix),
               s.intrinsics.empty() ? "hand_eye" : "intrinsics",
               "is no covariance together with what stands beside it: some direction would have a "
               "negative variance");
}

void visit_keys(KeyVisitor& keys, CalibrationSettings& s) {
  keys.choice("setup",
              s.setup,
              kSetups,
              "where the camera is fixed: on the flange, or beside the robot; without it what the "
              "pose's table says");
  keys.optional_table("flange_from_camera", s.flange_from_camera, "of a camera on the flange");
  keys.optional_table("base_from_camera", s.base_from_camera, "of a camera beside the robot");
  keys.optional_table("covariance", s.covariance, "of intrinsics and hand-eye");
  check_setup(keys, s);
  check_covariance(keys, s);
}

void visit_keys(KeyVisitor& keys, CellSettings& s) {
  keys.file("file",
            s.file,
            "cell file of the arm that takes the views, for reach.share and reach.margin_mm");
  keys.optional_table("base_from_part", s.base_from_part, "of a part that lies in the cell");
  keys.optional_table("flange_from_part", s.flange_from_part, "of a part that the robot holds");
  keys.require(!s.base_from_part || !s.flange_from_part,
               "flange_from_part",
               "cannot be given beside base_from_part: the part lies in the cell, or the robot "
               "holds it");
}

void visit_keys(KeyVisitor& keys, ReferenceSettings& s) {
  keys.files("pictures", s.pictures, "real pictures of the part, one a viewpoint");
  keys.files("masks",
             s.masks,
             "one a picture: the part is where they are brighter than three quarters of full "
             "scale, nothing is compared between a quarter and that; [] = not known");
  keys.file("calibration",
            s.calibration,
            "calibration.toml of the camera that took them; \"\" = the scene's own camera");
  keys.require(s.masks.empty() || s.masks.size() == s.pictures.size(),
               "masks",
               fmt::format("are {}, must be none or one for each of the {} pictures",
                           s.masks.size(),
                           s.pictures.size()));
}

void visit_keys(KeyVisitor& keys, ValidateSettings& s) {
  const Range share = Range::between(0, 10);
  keys.text("designs",
            s.designs,
            "designs to try out, with commas between them; \"\" = winner and all prototypes");
  keys.number("edge_px", s.edge_px, Range::between(0, 100), "edges agree up to this distance");
  keys.number("grey_share", s.grey_share, share, "grey values agree up to this share of them");
  keys.number("texture", s.texture, share, "spectra agree up to this log10 of their ratio");
  keys.number("contrast_share", s.contrast_share, share, "contrasts agree up to this share");
  keys.number("pose_mm", s.pose_mm, Range::between(0, 100), "a refit may move the part so far");
  keys.number("pose_deg", s.pose_rad, Range::between(0, 45), "a refit may turn it so far");
  keys.number("light_mm", s.light_mm, Range::between(0, 1000), "a refit may move a light so far");
  keys.number("power_share",
              s.power_share,
              share,
              "a refit may change the power of a light's segment against the others by this share");
  keys.number("exposure_share", s.exposure_share, share, "a refit may change the exposure so far");
  keys.number("roughness_share", s.roughness_share, share, "a refit may change roughness so far");
  keys.number("blur_px", s.blur_px, Range::between(0, 20), "a refit may change the blur so far");
}

MatrixXd covariance_of(const CovarianceSettings& settings) {
  if (settings.is_empty()) {
    return {};
  }
  const Index size = settings.hand_eye.empty() ? kIntrinsics : kIntrinsics + kHandEye;
  MatrixXd matrix = MatrixXd::Zero(size, size);
  const auto filler = [&](const std::vector<double>& values) {
    return [&](Index row, Index column, std::size_t at) {
      matrix(row, column) = values[at];
      matrix(column, row) = values[at];
    };
  };
  if (!settings.intrinsics.empty()) {
    for_triangle(0, kIntrinsics, filler(settings.intrinsics));
  }
  if (!settings.hand_eye.empty()) {
    for_triangle(kIntrinsics, kHandEye, filler(settings.hand_eye));
  }
  if (!settings.cross.empty()) {
    for_cross(filler(settings.cross));
  }
  return matrix;
}

void take_sigmas(const CovarianceSettings& covariance, MeasuredPoseSettings& pose) {
  if (covariance.hand_eye.empty()) {
    return;
  }
  const MatrixXd matrix = covariance_of(covariance);
  const auto root = [&](std::size_t i) {
    return std::sqrt(std::max(0.0, matrix.diagonal()[kIntrinsics + static_cast<Index>(i)]));
  };
  for (std::size_t i = 0; i < 3; ++i) {
    pose.sigma_rad[i] = root(i);
    pose.sigma_mm[i] = root(i + 3);
  }
}

CovarianceSettings covariance_settings(const MatrixXd& covariance) {
  CovarianceSettings settings;
  const auto adder = [&](std::vector<double>& values) {
    return [&](Index row, Index column, std::size_t /*at*/) {
      values.push_back(covariance(row, column));
    };
  };
  for_triangle(0, kIntrinsics, adder(settings.intrinsics));
  if (covariance.rows() == kIntrinsics + kHandEye) {
    for_triangle(kIntrinsics, kHandEye, adder(settings.hand_eye));
    for_cross(adder(settings.cross));
  }
  return settings;
}

}  // namespace glint

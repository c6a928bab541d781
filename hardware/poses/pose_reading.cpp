// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/poses/pose_reading.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <Eigen/SVD>

#include "core/units.h"

namespace glint {
namespace {

constexpr double kMaxFromRotation = 0.01;  ///< of an element of R R^T - 1; rounding leaves 1e-3

bool is_matrix(const WrittenPose& pose) {
  return pose.numbers.size() == 12 || pose.numbers.size() == 16;
}

/// The rotation nearest to a matrix, where it is one to rounding.
Eigen::Matrix3d checked_rotation(const Eigen::Matrix3d& matrix, const Place& place) {
  const double off =
      (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (!(off <= kMaxFromRotation)) {
    refuse_key(
        place,
        "pose",
        fmt::format("its matrix is no rotation: rows times rows differ from 1 by {:.3g}, at most "
                    "{} is allowed",
                    off,
                    kMaxFromRotation));
  }
  if (matrix.determinant() < 0.0) {
    refuse_key(
        place, "pose", "its matrix is no rotation but a mirror: the determinant is -1, must be 1");
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return svd.matrixU() * svd.matrixV().transpose();
}

Eigen::Matrix3d matrix_rotation(const WrittenPose& pose) {
  const auto& n = pose.numbers;
  if (n.size() == 16) {
    const double off = std::abs(n[12]) + std::abs(n[13]) + std::abs(n[14]) + std::abs(n[15] - 1.0);
    if (off > 1e-9) {
      refuse_key(pose.place, "pose", "the last row of its matrix must be 0, 0, 0, 1");
    }
  }
  Eigen::Matrix3d matrix;
  matrix << n[0], n[1], n[2], n[4], n[5], n[6], n[8], n[9], n[10];
  return checked_rotation(matrix, pose.place);
}

Eigen::Matrix3d quaternion_rotation(const WrittenPose& pose, bool is_w_first) {
  const auto& n = pose.numbers;
  const Eigen::Quaterniond quaternion = is_w_first ? Eigen::Quaterniond(n[3], n[4], n[5], n[6])
                                                   : Eigen::Quaterniond(n[6], n[3], n[4], n[5]);
  if (!(std::abs(quaternion.norm() - 1.0) <= kMaxFromRotation)) {
    refuse_key(pose.place,
               "pose",
               fmt::format("its quaternion has the length {:.4g}, must be 1", quaternion.norm()));
  }
  return quaternion.normalized().toRotationMatrix();
}

Eigen::Matrix3d vector_rotation(const Eigen::Vector3d& vector_rad) {
  const double angle = vector_rad.norm();
  if (angle < 1e-300) {
    return Eigen::Matrix3d::Identity();
  }
  return Eigen::AngleAxisd(angle, vector_rad / angle).toRotationMatrix();
}

Eigen::Matrix3d euler_rotation(const Eigen::Vector3d& angles_rad, const std::string& order) {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d axis = Eigen::Vector3d::Unit(order[static_cast<std::size_t>(k)] - 'x');
    rotation = rotation * Eigen::AngleAxisd(angles_rad[k], axis).toRotationMatrix();
  }
  return rotation;
}

/// Number k is about axis k of the order, which angles that have names are put into.
Eigen::Vector3d angles_of(const WrittenPose& pose, const std::string& order) {
  Eigen::Vector3d angles(pose.numbers[3], pose.numbers[4], pose.numbers[5]);
  std::string axes = order;
  std::ranges::sort(axes);
  if (!pose.has_named_angles || axes != "xyz") {
    return angles;
  }
  const auto about = [&](char axis) { return angles['z' - axis]; };
  return {about(order[0]), about(order[1]), about(order[2])};
}

Eigen::Matrix3d rotation_of(const WrittenPose& pose, const PoseConvention& convention) {
  switch (convention.rotation) {
    case PoseRotation::kQuaternionWxyz:
      return quaternion_rotation(pose, true);
    case PoseRotation::kQuaternionXyzw:
      return quaternion_rotation(pose, false);
    case PoseRotation::kRotationVector:
    case PoseRotation::kEuler: {
      const double scale = convention.angle == PoseAngle::kDegree ? kRadPerDeg : 1.0;
      return convention.rotation == PoseRotation::kEuler
                 ? euler_rotation(scale * angles_of(pose, convention.euler_order),
                                  convention.euler_order)
                 : vector_rotation(scale * Eigen::Vector3d::Map(pose.numbers.data() + 3));
    }
    default:
      return matrix_rotation(pose);
  }
}

Eigen::Isometry3d tcp_of(const std::vector<double>& numbers) {
  Eigen::Isometry3d flange_from_tcp = Eigen::Isometry3d::Identity();
  if (!numbers.empty()) {
    flange_from_tcp.translation() = Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
    flange_from_tcp.linear() = vector_rotation(Eigen::Vector3d(numbers[3], numbers[4], numbers[5]));
  }
  return flange_from_tcp;
}

}  // namespace

Eigen::Vector3d written_position(const WrittenPose& pose) {
  const auto& n = pose.numbers;
  return is_matrix(pose) ? Eigen::Vector3d(n[3], n[7], n[11]) : Eigen::Vector3d(n[0], n[1], n[2]);
}

Eigen::Isometry3d base_from_flange(const WrittenPose& pose, const PoseConvention& convention) {
  Eigen::Isometry3d written = Eigen::Isometry3d::Identity();
  written.linear() = rotation_of(pose, convention);
  written.translation() =
      written_position(pose) * (convention.unit == PoseUnit::kMetre ? 1e3 : 1.0);
  const Eigen::Isometry3d base_from_tcp =
      convention.direction == PoseDirection::kFlangeFromBase ? written.inverse() : written;
  return base_from_tcp * tcp_of(convention.flange_from_tcp).inverse();
}

}  // namespace glint

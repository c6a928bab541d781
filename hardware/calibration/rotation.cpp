// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/calibration/rotation.h"

#include <cmath>

#include <Eigen/LU>
#include <Eigen/SVD>

namespace glint {

using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d cross_matrix(const Vector3d& a) {
  Matrix3d matrix;
  matrix << 0.0, -a.z(), a.y(), a.z(), 0.0, -a.x(), -a.y(), a.x(), 0.0;
  return matrix;
}

Matrix3d rotation_of(const Vector3d& vector_rad) {
  const double angle = vector_rad.norm();
  const Matrix3d k = cross_matrix(vector_rad);
  if (angle < 1e-5) {
    return Matrix3d::Identity() + k + 0.5 * k * k;
  }
  const double half = std::sin(0.5 * angle) / angle;
  return Matrix3d::Identity() + std::sin(angle) / angle * k + 2.0 * half * half * k * k;
}

Vector3d rotation_vector_rad(const Matrix3d& rotation) {
  const Eigen::AngleAxisd turn{Eigen::Quaterniond(rotation)};
  return turn.angle() * turn.axis();
}

Matrix3d right_jacobian(const Vector3d& vector_rad) {
  const double angle = vector_rad.norm();
  const Matrix3d k = cross_matrix(vector_rad);
  if (angle < 1e-3) {  // the next terms are of the order of the angle's third power
    return Matrix3d::Identity() - 0.5 * k + k * k / 6.0;
  }
  const double square = angle * angle;
  const double half = std::sin(0.5 * angle) / angle;
  return Matrix3d::Identity() - 2.0 * half * half * k +
         (angle - std::sin(angle)) / (square * angle) * k * k;
}

Isometry3d motion_of(const Vector6d& six) {
  Isometry3d motion = Isometry3d::Identity();
  motion.linear() = rotation_of(six.head<3>());
  motion.translation() = six.tail<3>();
  return motion;
}

Vector6d six_of(const Isometry3d& motion) {
  Vector6d six;
  six << rotation_vector_rad(motion.linear()), motion.translation();
  return six;
}

double angle_rad(const Matrix3d& rotation) {
  return rotation_vector_rad(rotation).norm();
}

Matrix3d nearest_rotation(const Matrix3d& matrix) {
  const Eigen::JacobiSVD<Matrix3d> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Matrix3d both = svd.matrixU() * svd.matrixV().transpose();
  const Vector3d signs(1.0, 1.0, both.determinant() < 0.0 ? -1.0 : 1.0);
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

Isometry3d mean_pose(std::span<const Isometry3d> poses) {
  Matrix3d sum = Matrix3d::Zero();
  Vector3d translation = Vector3d::Zero();
  for (const Isometry3d& pose : poses) {
    sum += pose.linear();
    translation += pose.translation();
  }
  Isometry3d mean = Isometry3d::Identity();
  mean.linear() = nearest_rotation(sum);
  mean.translation() = translation / static_cast<double>(poses.size());
  return mean;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rotations as vectors (axis times angle in radian), six-vectors of small motions, means of poses.
#pragma once

#include <span>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace glint {

using Vector6d = Eigen::Matrix<double, 6, 1>;

/// The matrix of the cross product: cross_matrix(a) b = a x b.
Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& a);

/// The rotation by |vector_rad| about the vector (Rodrigues).
Eigen::Matrix3d rotation_of(const Eigen::Vector3d& vector_rad);

/// Inverse of rotation_of(), of length at most pi.
Eigen::Vector3d rotation_vector_rad(const Eigen::Matrix3d& rotation);

/// J with rotation_of(v + d) = rotation_of(v) rotation_of(J d) to first order in d.
///
/// Source: G. Chirikjian, "Stochastic Models, Information Theory, and Lie Groups 2", 2012, section
/// 10.8; checked against differences in rotation_test.cpp.
Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& vector_rad);

/// A motion of six numbers: rotation vector (rad), then translation (mm). Not the exponential of
/// SE(3): rotation and translation stand side by side.
Eigen::Isometry3d motion_of(const Vector6d& six);

/// Inverse of motion_of().
Vector6d six_of(const Eigen::Isometry3d& motion);

/// Angle of a rotation, 0 to pi.
double angle_rad(const Eigen::Matrix3d& rotation);

/// Rotation nearest to the mean of the matrices (Frobenius norm), mean of the translations.
/// @param poses  not empty
Eigen::Isometry3d mean_pose(std::span<const Eigen::Isometry3d> poses);

/// The rotation nearest to a matrix in the Frobenius norm.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& matrix);

}  // namespace glint

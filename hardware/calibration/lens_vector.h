// SPDX-License-Identifier: GPL-3.0-or-later
//
// The intrinsics of a camera as nine numbers that a least-squares solver moves.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

#include <Eigen/Core>

#include "simulator/camera/pinhole_camera.h"

namespace glint {

inline constexpr std::size_t kLensSize = 9;
/// Names and order of a LensVector's numbers. Order differs from OpenCV's (k1 k2 p1 p2 k3).
inline constexpr std::array<std::string_view, kLensSize> kLensNames = {
    "fx", "fy", "cx", "cy", "k1", "k2", "k3", "p1", "p2"};
/// fx fy cx cy in px, then k1 k2 k3 p1 p2; pixels and signs as PinholeIntrinsics.
using LensVector = Eigen::Matrix<double, kLensSize, 1>;
/// Which of the numbers a solver may move.
using LensMask = std::array<bool, kLensSize>;

LensVector lens_vector(const PinholeIntrinsics& intrinsics);

PinholeIntrinsics intrinsics_from(const LensVector& lens, int width_px, int height_px);

/// How a projection moves.
struct LensDerivatives {
  Eigen::Matrix<double, 2, 9> by_lens;
  Eigen::Matrix<double, 2, 3> by_point;  ///< [px/mm]
};

/// The pixel of a point; empty when the point is not in front of the camera. Unlike
/// PinholeCamera::project() it does not look for folds: a solver must be able to pass them.
/// @param derivatives  not null: receives the derivatives
std::optional<Eigen::Vector2d> project_by_lens(const LensVector& lens,
                                               const Eigen::Vector3d& point_in_camera_mm,
                                               LensDerivatives* derivatives);

/// Whether PinholeCamera accepts these intrinsics: sizes right, no fold within the picture.
bool is_possible_lens(const LensVector& lens, int width_px, int height_px);

}  // namespace glint

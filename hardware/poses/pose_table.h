// SPDX-License-Identifier: GPL-3.0-or-later
//
// Robot poses from a table of comma-separated values, one pose a line.
#pragma once

#include <array>
#include <string>
#include <string_view>

#include "hardware/poses/pose_file.h"

namespace glint {

/// Names of the key, or column, that names a pose, and of the one that holds its time in seconds.
inline constexpr std::array<std::string_view, 4> kPoseNameKeys = {
    "name", "picture", "file", "image"};
inline constexpr std::array<std::string_view, 4> kPoseStampKeys = {
    "stamp_s", "stamp", "time", "timestamp"};

/// Without a head numbers are read by their positions. A head that names all columns of numbers
/// tells their order, whatever it is (rx ry rz and a b c have to stand in this one), and where
/// their names end in _mm, _m, _rad or _deg also the unit. A head with other names is read by
/// position where the names that are known agree with it.
///
///   x y z rx ry rz     rx ry rz: rotation vector or Euler angles
///   x y z qw qx qy qz  a quaternion, qw first or last
///   x y z a b c        as rx ry rz
///   x y z roll pitch yaw; x y z w p r   Euler angles Rz(yaw) Ry(pitch) Rx(roll);
///                                       by another euler_order each keeps its axis
///   x y z r p y        as roll pitch yaw
///   r11 r12 ... r33 x y z               a matrix; tx ty tz and px py pz are as x y z
/// @param file  for messages
/// @throws ConfigError with file:line:column
PoseFile parse_pose_table(std::string_view text, const std::string& file);

}  // namespace glint

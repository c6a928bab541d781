// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the numbers of a robot's pose mean. Robots, pendants and programs write the same pose in
// many ways; what the user does not say is guessed from the numbers, and what was guessed is told.
#pragma once

#include <functional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/keys.h"
#include "core/error.h"

namespace glint {

/// @throws ConfigError at that place, naming the key
[[noreturn]] void refuse_key(const Place& place, std::string_view key, const std::string& text);

enum class PoseUnit { kAuto, kMillimetre, kMetre };
enum class PoseDirection { kAuto, kBaseFromFlange, kFlangeFromBase };
enum class PoseRotation {
  kAuto,
  kMatrix,
  kQuaternionWxyz,
  kQuaternionXyzw,
  kRotationVector,
  kEuler
};
enum class PoseAngle { kAuto, kRadian, kDegree };

/// Keys of [convention] in a file of poses, and of [poses] in a study.
struct PoseConvention {
  PoseUnit unit = PoseUnit::kAuto;
  PoseDirection direction = PoseDirection::kAuto;
  PoseRotation rotation = PoseRotation::kAuto;
  PoseAngle angle = PoseAngle::kAuto;  ///< of rotation vectors and Euler angles
  /// Axes of Euler angles in the order of the numbers, each turning about the axes as the ones
  /// before have left them: "zyx" is Rz(a) Ry(b) Rx(c). Fixed axes: the same in reverse.
  std::string euler_order = "zyx";
  /// When the poses are of a tool's tip as set on the pendant: where the tip is on the flange.
  /// Empty or six numbers: x y z in mm, rotation vector in rad.
  std::vector<double> flange_from_tcp;
  std::set<std::string, std::less<>> written;  ///< keys that somebody wrote, also as the default
};

void visit_keys(KeyVisitor& keys, PoseConvention& convention);

/// A pose as it was written.
struct WrittenPose {
  std::string name;             ///< of the picture or the file; empty: none
  std::vector<double> numbers;  ///< 6, 7: position, rotation; 12, 16: matrix row by row
  bool has_stamp = false;
  double stamp_s = 0.0;
  Place place;  ///< of its first number
  /// Its angles are about z, y and x by their names, in whatever order they are applied.
  bool has_named_angles = false;
  bool has_angle_unit = false;  ///< its column names the unit of its angles
};

/// The convention with nothing left open, and for each thing that was guessed one sentence with the
/// key that overrules it. Guessed are: the unit by the robot's reach (mm when the median distance
/// from the base is 10 or more), a rotation vector for six numbers, Euler angles in degrees when
/// one is greater than a whole turn in radians, their order zyx, a quaternion with w last for seven
/// numbers, and base_from_flange.
struct ResolvedConvention {
  PoseConvention convention;
  std::vector<std::string> told;
};

/// @param poses  at least one, equally many numbers in each
/// @throws ConfigError naming what the numbers contradict: NaN or beyond 1e6, another count of
/// numbers than the rotation needs, degrees given as radians, metres given as mm and the other way
/// round
ResolvedConvention resolved_convention(std::span<const WrittenPose> poses,
                                       const PoseConvention& convention);

/// Every other reading of the numbers that passes the same checks, the likelier ones first: for
/// comparing them by how well they agree with the pictures. Changes only what was left open.
std::vector<PoseConvention> other_conventions(std::span<const WrittenPose> poses,
                                              const PoseConvention& convention);

}  // namespace glint

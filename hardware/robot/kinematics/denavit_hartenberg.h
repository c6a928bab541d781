// SPDX-License-Identifier: GPL-3.0-or-later
//
// Arms with six revolute joints as tables of Denavit-Hartenberg parameters.
//
// Row i takes frame i + 1 to frame i: a turn about z by the joint's angle plus theta, a shift along
// z by d, a shift along x by a, a turn about x by alpha (the classic form of J. Denavit and R.
// Hartenberg, 1955). Frame 0 is the robot's base, frame 6 its flange.
#pragma once

#include <array>
#include <string_view>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace glint {

/// Angles of the six joints from the base to the flange, rad.
using JointVector = Eigen::Matrix<double, 6, 1>;

enum class ArmModel { kUr3, kUr3e, kUr5e };

/// In the order of ArmModel, as files write them.
inline constexpr std::array<std::string_view, 3> kArmModels = {"ur3", "ur3e", "ur5e"};

struct DhRow {
  double a_mm = 0.0;
  double d_mm = 0.0;
  double alpha_rad = 0.0;
  double theta_rad = 0.0;  ///< added to the joint's angle
};

using DhTable = std::array<DhRow, 6>;

/// The maker's nominal table. Each real arm differs from it by some tenths of a millimetre to some
/// millimetres (arm_deltas.h).
///
/// Source: Universal Robots, "DH Parameters for calculations of kinematics and dynamics"; the
/// values of the UR3 and the UR3e also stand in public programs.
DhTable nominal_table(ArmModel model);

/// True for the CB3 generation, whose controller runs at 125 Hz; e-Series run at 500 Hz.
bool is_cb3(ArmModel model);

/// Motion of frame i + 1 in frame i at a joint's angle.
Eigen::Isometry3d link_motion(const DhRow& row, double joint_rad);

/// base_from_frame 0 to 6; mm. The last one is base_from_flange.
using LinkFrames = std::array<Eigen::Isometry3d, 7>;
LinkFrames link_frames(const DhTable& table, const JointVector& joints_rad);

}  // namespace glint

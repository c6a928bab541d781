// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/keys.h"
#include "hardware/robot/kinematics/arm.h"
#include "hardware/robot/motion_limits.h"

namespace glint {

/// The keys of [robot] in a cell file.
struct UrSettings {
  ArmModel model = ArmModel::kUr3;
  std::string host;
  int rtde_port = 30004;
  int primary_port = 30001;
  int secondary_port = 30002;
  int dashboard_port = 29999;
  std::filesystem::path arm_deltas;     ///< arm_deltas.h; empty: the nominal arm
  std::vector<double> flange_from_tcp;  ///< six numbers, mm and rotation vector in rad
  double tool_radius_mm = 0.0;          ///< of the tool about the line from the flange to its tip
  double payload_kg = 0.0;
  std::vector<double> payload_cog_mm = {0.0, 0.0, 0.0};
  int ack_register = 0;  ///< output_int_register that scripts acknowledge through
};

/// Asks for model, host, TCP, radius of the tool and payload, and for ports that wrong_port() finds
/// nothing wrong with.
void visit_keys(KeyVisitor& keys, UrSettings& settings);

/// A controller runs what is written to this port: 30001, 30002, 30003 or 30020.
bool takes_scripts(int port);

struct WrongPort {
  std::string_view key;
  std::string text;  ///< what is wrong, what is allowed
};

/// RTDE and dashboard are written to without --move. So their ports must be none that
/// takes_scripts(), and none of the cell's own for scripts.
/// @return the first that is wrong; none: none is
std::optional<WrongPort> wrong_port(const UrSettings& settings);

/// A pose of six numbers: mm, rotation vector in rad.
Eigen::Isometry3d pose_of_six(const std::vector<double>& six);

/// The arm with its tool and limits: everything that a motion is checked with.
struct ArmWithTool {
  Arm arm;
  Eigen::Isometry3d flange_from_tcp = Eigen::Isometry3d::Identity();  ///< mm
  double tool_radius_mm = 0.0;
  MotionLimits limits;

  Eigen::Isometry3d base_from_tcp(const JointVector& joints_rad) const {
    return arm.forward(joints_rad) * flange_from_tcp;
  }
};

/// Reads the deltas where there are any. @throws ConfigError also for those of another model,
/// IoError
ArmWithTool arm_with_tool(const UrSettings& settings, const MotionLimits& limits);

}  // namespace glint

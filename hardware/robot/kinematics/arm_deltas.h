// SPDX-License-Identifier: GPL-3.0-or-later
//
// How one real arm differs from its nominal table. The controller keeps these numbers in its file
// calibration.conf (table [mounting]: delta_theta, delta_a, delta_d, delta_alpha; metres and
// radians). Glint reads them from a TOML file with millimetres and radians:
//
//     [arm_deltas]
//     model = "ur3e"
//     serial_number = "20195300001"
//     delta_theta_rad = [0, 0, 0, 0, 0, 0]   # added to each joint's angle
//     delta_a_mm      = [0, 0, 0, 0, 0, 0]   # added to a of each row
//     delta_d_mm      = [0, 0, 0, 0, 0, 0]   # d; of joints 2 and 3 often some 100 mm, with
//     opposite sign delta_alpha_rad = [0, 0, 0, 0, 0, 0]   # alpha
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/keys.h"
#include "hardware/robot/kinematics/denavit_hartenberg.h"

namespace glint {

/// Six numbers each, from joint 1 to joint 6.
struct ArmDeltas {
  ArmModel model = ArmModel::kUr3;
  std::string serial_number;
  std::vector<double> theta_rad = std::vector<double>(6, 0.0);
  std::vector<double> a_mm = std::vector<double>(6, 0.0);
  std::vector<double> d_mm = std::vector<double>(6, 0.0);
  std::vector<double> alpha_rad = std::vector<double>(6, 0.0);

  bool is_zero() const;
};

void visit_keys(KeyVisitor& keys, ArmDeltas& deltas);

/// The nominal table with the deltas added.
DhTable calibrated_table(ArmModel model, const ArmDeltas& deltas);

/// @param file  for messages
/// @throws ConfigError with file:line:column: no table [arm_deltas], not six numbers, angles beyond
///         0.2 rad, lengths beyond 1 m
ArmDeltas parse_arm_deltas(std::string_view text, const std::string& file);

/// @throws ConfigError, IoError
ArmDeltas read_arm_deltas(const std::filesystem::path& path);

}  // namespace glint

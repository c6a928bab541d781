// SPDX-License-Identifier: GPL-3.0-or-later
//
// Poses and joints as files have them: x, y, z in mm and a rotation vector in rad; degrees.
#pragma once

#include <Eigen/Geometry>
#include <nlohmann/json_fwd.hpp>

#include "hardware/robot/kinematics/denavit_hartenberg.h"

namespace glint {

nlohmann::ordered_json six_numbers(const Eigen::Isometry3d& pose);
nlohmann::ordered_json joints_deg(const JointVector& joints_rad);

/// @throws ConfigError for anything but a list of six numbers
Eigen::Isometry3d pose_of_numbers(const nlohmann::ordered_json& six);
/// @param pose  { translation_mm, rotation_vector_rad }, as results have it
Eigen::Isometry3d pose_of(const nlohmann::ordered_json& pose);

JointVector joints_of_deg(const nlohmann::ordered_json& six);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Robot poses from CSV, JSON, TOML and YAML files.
//
//   CSV   one pose a line: name (optional), then its numbers. A head line is optional; it may name
//   a
//         column "picture", "file" or "name", one "stamp" or "time", and the columns of numbers,
//         which then may stand in any order (pose_table.h). Lines with '#' do not count.
//   JSON, TOML   a list of poses, or one below "pose" or "poses"; beside it [convention]. A pose is
//   a
//         list of numbers, a list of rows, or a table: name or picture, stamp_s, and one of
//         pose, base_from_flange, flange_from_base.
//   YAML  the same; or one pose as ViSP and OpenCV write matrices (rows, cols, data): 4 x 4, or the
//         6 x 1 vector of position and rotation vector. Its name is that of the file.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Geometry>

#include "hardware/poses/pose_convention.h"

namespace glint {

/// Poses as their files hold them, and what the files say of them.
struct PoseFile {
  std::vector<WrittenPose> poses;
  PoseConvention convention;  ///< auto where the file says nothing
};

/// @param file    for messages, and its stem for the name of a pose that has a file of its own
/// @param ending  ".csv", ".json", ".toml", ".yaml" or ".yml"
/// @throws ConfigError with file:line:column of what is wrong
PoseFile parse_pose_file(std::string_view text, const std::string& file, std::string_view ending);

/// A pose of the robot.
struct RobotPose {
  std::string name;                                                    ///< empty: none
  Eigen::Isometry3d base_from_flange = Eigen::Isometry3d::Identity();  ///< mm
  Place place;
};

/// All poses of a robot, what was assumed of them, and what else is open.
struct RobotPoses {
  std::vector<RobotPose> poses;
  PoseConvention convention;              ///< resolved
  std::vector<std::string> told;          ///< what was guessed, with the key that overrules it
  std::vector<WrittenPose> written;       ///< in the same order
  std::vector<PoseConvention> otherwise;  ///< see other_conventions()
};

/// Reads files in their order. What the user says wins over what a file says, also where it is the
/// default; what one file says holds for all.
/// @param files  at least one
/// @throws ConfigError with places: see resolved_convention() and base_from_flange(); also for two
/// poses with one name or one time stamp, and files whose conventions contradict. IoError
RobotPoses read_poses(std::span<const std::filesystem::path> files, const PoseConvention& said);

/// The poses of files that were read.
RobotPoses robot_poses(const PoseFile& written, const PoseConvention& said);

}  // namespace glint

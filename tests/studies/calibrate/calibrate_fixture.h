// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "tests/cli/program.h"

namespace glint::test {

/// Photographs by others, which not every checkout has beside it.
inline std::filesystem::path photographs(const std::string& name) {
  return std::filesystem::path(GLINT_SHARED_DIR) / "data" / name;
}

/// The files of a folder whose names begin and end so, sorted.
inline Arguments files_in(const std::filesystem::path& folder,
                          const std::string& begin,
                          const std::string& ending) {
  Arguments files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(begin) && name.ends_with(ending)) {
      files.push_back(entry.path().string());
    }
  }
  std::ranges::sort(files);
  return files;
}

/// For tests that do not look at the mean over random splits, of which twenty take most of the time
/// of a calibration.
inline const Arguments kOneSplit = {"--set", "prediction.splits=1"};

/// Arguments, and then some more.
inline Arguments with(Arguments arguments, const Arguments& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

/// A calibration that several tests look at and none changes.
struct SharedCalibration {
  TemporaryFolder folder;  ///< its files in out/
  nlohmann::json result;   ///< null: the photographs are not there
};

/// @param more  arguments after the pictures
inline void make_calibration(SharedCalibration& made,
                             const Arguments& pictures,
                             const Arguments& more) {
  Arguments all = {"calibrate"};
  all.insert(all.end(), pictures.begin(), pictures.end());
  all.insert(all.end(), more.begin(), more.end());
  all.insert(all.end(), {"--out", "out", "--json"});
  const ProgramResult done = glint_in(made.folder, all);
  EXPECT_EQ(done.code, 0) << done.err;
  made.result = done.out.empty() ? nlohmann::json() : nlohmann::json::parse(done.out);
}

/// A camera alone, from pictures of a chessboard whose names begin so: "left" or "left0".
inline const SharedCalibration& chessboard(const std::string& begin) {
  static std::map<std::string, SharedCalibration> made;
  const auto [at, is_new] = made.try_emplace(begin);
  const std::filesystem::path set = photographs("calibration/chessboard_left");
  if (is_new && std::filesystem::exists(set)) {
    make_calibration(
        at->second, files_in(set, begin, ".jpg"), {"--board", (set / "board.json").string()});
  }
  return at->second;
}

/// The camera beside a robot that holds the board.
inline const SharedCalibration& board_on_robot() {
  static const SharedCalibration& shared = []() -> const SharedCalibration& {
    static SharedCalibration made;
    const std::filesystem::path set = photographs("calibration/board_on_robot");
    if (std::filesystem::exists(set)) {
      make_calibration(
          made,
          files_in(set, "img", ".png"),
          {"--board", (set / "board.json").string(), "--poses", (set / "poses.csv").string()});
    }
    return made;
  }();
  return shared;
}

/// Eight good pictures of the robot that holds the board.
inline Arguments eight_on_robot() {
  const std::filesystem::path set = photographs("calibration/board_on_robot");
  Arguments files;
  for (const char* name : {"00", "01", "04", "05", "06", "08", "10", "12"}) {
    files.push_back((set / ("img" + std::string(name) + ".png")).string());
  }
  return files;
}

/// The lines of the robot's poses that are of these pictures.
inline std::string poses_on_robot(const Arguments& pictures) {
  const std::string all = read_file(photographs("calibration/board_on_robot") / "poses.csv");
  std::string poses;
  for (const std::string& picture : pictures) {
    const std::size_t line = all.find(std::filesystem::path(picture).filename().string());
    poses += all.substr(line, all.find('\n', line) + 1 - line);
  }
  return poses;
}

/// The camera on an arm over a board in the cell.
inline const SharedCalibration& franka() {
  static const SharedCalibration& shared = []() -> const SharedCalibration& {
    static SharedCalibration made;
    const std::filesystem::path set = photographs("field/handeye_franka");
    if (std::filesystem::exists(set)) {
      write_file(made.folder / "board.toml", "[board]\ncols = 9\nrows = 6\nsquare_mm = 23.6\n");
      Arguments more = {
          "--board", "board.toml", "--camera", (set / "franka_camera.xml").string(), "--poses"};
      more = with(with(more, files_in(set, "franka_pose_rPe_", ".yaml")), kOneSplit);
      make_calibration(made, files_in(set, "franka_image-", ".png"), more);
    }
    return made;
  }();
  return shared;
}

/// `glint calibrate` in a folder of its own.
class CalibrateVerb : public ::testing::Test {
 protected:
  ProgramResult calibrate(const Arguments& pictures, const Arguments& more) const {
    Arguments arguments = {"calibrate"};
    arguments.insert(arguments.end(), pictures.begin(), pictures.end());
    arguments.insert(arguments.end(), more.begin(), more.end());
    arguments.insert(arguments.end(), {"--out", "out"});
    return glint_in(folder_, arguments);
  }

  nlohmann::json calibrate_json(const Arguments& pictures, Arguments more) const {
    more.emplace_back("--json");
    const ProgramResult result = calibrate(pictures, more);
    EXPECT_EQ(result.code, 0) << result.err;
    return result.out.empty() ? nlohmann::json() : nlohmann::json::parse(result.out);
  }

  /// Exit code 2 or as told, nothing on stdout, no folder.
  void expect_refused(const Arguments& pictures,
                      const Arguments& more,
                      const std::string& message,
                      int code = 2) const {
    const ProgramResult result = calibrate(pictures, more);
    EXPECT_EQ(result.code, code) << result.err;
    EXPECT_THAT(result.err, ::testing::HasSubstr(message));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  }

  /// expect_refused() within this process: a start of the program for each of many slips would take
  /// most of the time.
  template <class Call>
  void expect_refused_here(const Call& call, const std::string& message) const {
    const std::filesystem::path before = std::filesystem::current_path();
    std::filesystem::current_path(folder_ / "");
    std::string told = "nothing was refused";
    try {
      call();
    } catch (const ConfigError& error) {
      told = error.what();
    }
    std::filesystem::current_path(before);
    EXPECT_THAT(told, ::testing::HasSubstr(message));
    EXPECT_EQ(std::ranges::count(told, '\n'), 0) << told;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  }

  TemporaryFolder folder_;
};

}  // namespace glint::test

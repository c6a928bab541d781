// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate_cell/calibrate_cell_run.h"

#include <algorithm>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "hardware/robot/path_check.h"
#include "studies/acquire/acquired.h"
#include "studies/calibrate/calibrate_run.h"
#include "studies/calibrate/plan_run.h"
#include "studies/calibrate_cell/round_pictures.h"
#include "studies/cell/cell_file.h"
#include "studies/cell/pose_numbers.h"
#include "studies/output/result_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr double kWorthIt = 0.9;  ///< of the error before: more, and another round is not worth it

/// Joints of the branch that is nearest to the first safe position and stays in the box; empty:
/// none.
std::vector<double> joints_for(const ArmWithTool& arm,
                               const Eigen::Isometry3d& base_from_flange,
                               const JointVector& home_rad) {
  const auto joints = nearest_solution(arm.arm.inverse(base_from_flange), home_rad, kJointLimitRad);
  if (!joints || !check_joint_motion(arm, home_rad, *joints, 1.0).is_allowed()) {
    return {};
  }
  return {joints->data(), joints->data() + joints->size()};
}

class CellCalibration {
 public:
  CellCalibration(const CalibrateCellOptions& options, const MotionPermit& permit)
      : options_(options), permit_(permit), cell_(read_cell(options.acquire.cell)) {
    if (options.board.empty()) {
      throw ConfigError("--board: is missing; give the board's board.toml or board.json");
    }
    if (cell_.views.size() < 3) {
      throw ConfigError(fmt::format(
          "{}: view: there are {}; at least 3 that show the board are needed to begin with",
          cell_.file.string(),
          cell_.views.size()));
    }
    folder_ = calibration_folder(options.acquire);
  }

  Json run() {
    std::vector<CellPosition> views = cell_.views;
    std::string status = "no_pose_helps";
    double before_px = 0.0;
    for (int round = 1; round <= options_.most_rounds && !views.empty(); ++round) {
      const Json taken = acquire(round, views);
      if (taken["status"] == "stopped") {
        end_ = taken["end"];
        status = "stopped";
        break;
      }
      take_over(round);
      const Json calibration = calibrate();
      const double error_px = calibration["point_error_px"]["rms"].get<double>();
      rounds_.push_back({{"round", round},
                         {"pictures", taken["counts"]["accepted"]},
                         {"point_error_px", error_px},
                         {"prediction_rms_px", calibration["prediction_rms_px"]}});
      if (error_px <= options_.target_px) {
        status = "good";
        break;
      }
      if (round > 1 && error_px > kWorthIt * before_px) {
        break;
      }
      before_px = error_px;
      views = next_views(round + 1);
    }
    return {{"schema", 1},
            {"status", status},
            {"ok", status == "good"},
            {"folder", folder_.string()},
            {"target_px", options_.target_px},
            {"rounds", rounds_},
            {"end", end_},
            {"calibration", (folder_ / "calibration" / "calibration.toml").string()}};
  }

 private:
  Json acquire(int round, const std::vector<CellPosition>& views) const {
    AcquireOptions acquire = options_.acquire;
    acquire.source.clear();
    acquire.views = views;
    acquire.out = folder_ / fmt::format("round_{}", round);
    MountedPrototypes none({}, {});  // the board is seen by the cell's own lights
    return calibrate_cell_detail::acquire_round(acquire, none, permit_);
  }

  /// Pictures of a round beside those of the others, and their poses.
  void take_over(int round) {
    const Acquired acquired = read_acquired(folder_ / fmt::format("round_{}", round));
    make_folder(folder_ / "pictures");
    for (const std::string& view : acquired.views()) {
      const AcquiredPicture picture = acquired.of_view(view).front();
      const std::string name = fmt::format("round_{}_{}.png", round, folder_name_of(view));
      const fs::path file = folder_ / "pictures" / name;
      write_file(file, read_file(acquired.folder / picture.file));
      pictures_.push_back(file);
      poses_ += calibrate_cell_detail::pose_toml(name, picture.base_from_flange);
    }
    write_file(folder_ / "poses.toml", calibrate_cell_detail::pose_convention_toml() + poses_);
  }

  Json calibrate() const {
    return calibrate_pictures({.pictures = pictures_,
                               .board = options_.board,
                               .poses = {folder_ / "poses.toml"},
                               .out = folder_ / "calibration",
                               .setup = options_.setup,
                               .threads = options_.threads});
  }

  /// A plan that is there already holds: an earlier call began to drive it.
  Json plan_of(int round) const {
    const fs::path folder = folder_ / fmt::format("plan_{}", round);
    if (fs::exists(folder / "plan.json")) {
      return Json::parse(read_file(folder / "plan.json"), nullptr, false);
    }
    return plan_poses({.count = options_.poses_a_round,
                       .board = options_.board,
                       .camera = folder_ / "calibration",
                       .out = folder});
  }

  /// What the calibration asks for, as far as the arm gets there.
  std::vector<CellPosition> next_views(int round) const {
    const Json plan = plan_of(round);
    const ArmWithTool arm = arm_with_tool(robot_of(cell_), cell_.limits);
    const CellPosition& home = safe_position_of(cell_, "");
    const JointVector home_rad = Eigen::Map<const JointVector>(home.joints_rad.data());
    std::vector<CellPosition> views;
    for (const Json& pose : plan.at("poses")) {
      CellPosition view = cell_.views.front();  // its lights and exposure
      view.name = pose["name"].get<std::string>();
      view.joints_rad = joints_for(arm, pose_of(pose), home_rad);
      if (!view.joints_rad.empty()) {
        views.push_back(view);
      }
    }
    return views;
  }

  const CalibrateCellOptions& options_;
  const MotionPermit& permit_;
  Cell cell_;
  fs::path folder_;
  std::vector<fs::path> pictures_;
  std::string poses_;
  Json rounds_ = Json::array();
  Json end_;  ///< of an acquisition that was stopped
};

}  // namespace

fs::path calibration_folder(const AcquireOptions& acquire) {
  return acquire.out.empty()
             ? default_result_folder(fs::absolute(acquire.cell).parent_path().filename().string(),
                                     ResultKind::kCalibrate)
             : acquire.out;
}

Json calibrate_cell(const CalibrateCellOptions& options, const MotionPermit& permit) {
  return CellCalibration(options, permit).run();
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate_cell/calibrate_cell_run.h"

#include <limits>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "hardware/planning/plan_check.h"
#include "studies/acquire/acquired.h"
#include "studies/acquire/journal.h"
#include "studies/calibrate/calibrate_run.h"
#include "studies/calibrate/plan_run.h"
#include "studies/calibrate_cell/next_poses.h"
#include "studies/calibrate_cell/round_pictures.h"
#include "studies/cell/cell_file.h"
#include "studies/cell/pose_numbers.h"
#include "studies/output/result_folder.h"

namespace glint {
namespace {

using calibrate_cell_detail::calibrated_cell;
using calibrate_cell_detail::check_board;
using calibrate_cell_detail::ended_round;
using calibrate_cell_detail::is_hand_eye_worst;
using calibrate_cell_detail::keep_poses;
using calibrate_cell_detail::kept_poses;
using calibrate_cell_detail::missed_by;
using calibrate_cell_detail::promise_of;
using calibrate_cell_detail::reached_poses;
using calibrate_cell_detail::ReachedPoses;
using calibrate_cell_detail::RoundErrors;
using calibrate_cell_detail::RoundTargets;
using calibrate_cell_detail::status_after_round;
using calibrate_cell_detail::WantedPose;
using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

constexpr int kPlannedForOne = 3;  ///< poses asked for, so that others replace those out of reach

Json refused_json(const std::vector<PlannedView>& refused) {
  Json list = Json::array();
  for (const PlannedView& view : refused) {
    list.push_back(
        {{"pose", view.name}, {"outcome", name_of(view.outcome)}, {"reason", view.reason}});
  }
  return list;
}

/// Views of the cell that cannot be taken, as refused_json() tells poses.
Json unplanned_json(const Json& unplanned) {
  Json list = Json::array();
  for (const Json& view : unplanned) {
    list.push_back(
        {{"pose", view["view"]}, {"outcome", view["outcome"]}, {"reason", view["reason"]}});
  }
  return list;
}

/// What a calibration tells of itself; a hand-eye without sigmas is not known.
RoundErrors errors_in(const Json& calibration) {
  const Json& hand_eye = calibration["hand_eye"];
  const auto sigma = [&hand_eye](const char* name) {
    return hand_eye.is_object() && hand_eye[name].is_number()
               ? hand_eye[name].get<double>()
               : std::numeric_limits<double>::infinity();
  };
  return {.point_px = calibration["point_error_px"]["rms"].get<double>(),
          .hand_eye_mm = sigma("sigma_mm"),
          .hand_eye_deg = sigma("sigma_deg")};
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
    calibrate_cell_detail::check_rounds_folder(folder_);
    check_board(folder_, options.board);
  }

  Json run() {
    std::string status;
    for (int round = 1; status.empty(); ++round) {
      status = status_after(round);
    }
    Json result = {{"schema", 1},
                   {"status", status},
                   {"ok", status == "good"},
                   {"folder", folder_.string()},
                   {"target_px", options_.targets.point_px},
                   {"target_mm", options_.targets.hand_eye_mm},
                   {"target_deg", options_.targets.hand_eye_deg},
                   {"rounds", rounds_},
                   {"refused", refused_},
                   {"end", end_},
                   {"calibration", (folder_ / "calibration" / "calibration.toml").string()}};
    if (status == "waiting") {
      result["next"] = next_;
    }
    return result;
  }

 private:
  fs::path round_folder(int round) const { return folder_ / fmt::format("round_{}", round); }

  fs::path plan_folder(int round) const { return folder_ / fmt::format("plan_{}", round); }

  /// Poses and paths that were chosen for a round.
  fs::path kept_file(int round) const { return plan_folder(round) / "tour.json"; }

  /// Photographs and calibrates. @return empty: another round is to follow
  std::string status_after(int round) {
    const Json taken = acquire(round);
    if (taken["status"] == "stopped") {
      end_ = taken["end"];
      return "stopped";
    }
    if (taken["status"] == "waiting") {
      next_ = taken["next"];
      end_ = taken["end"];
      return "waiting";
    }
    if (round == 1) {
      refused_ = unplanned_json(taken.value("unplanned", Json::array()));
    }
    if (taken["counts"]["accepted"] == 0) {
      return "no_picture";
    }
    take_over(round);
    const Json calibration = calibrate();
    const RoundErrors errors = errors_in(calibration);
    rounds_.push_back({{"round", round},
                       {"pictures", taken["counts"]["accepted"]},
                       {"point_error_px", errors.point_px},
                       {"hand_eye_sigma_mm", errors.hand_eye_mm},
                       {"hand_eye_sigma_deg", errors.hand_eye_deg},
                       {"prediction_rms_px", calibration["prediction_rms_px"]}});
    take_accepted(calibration);
    const std::string status = status_of(round, errors);
    return !status.empty() || seek_poses(round + 1) ? status : "no_pose_reached";
  }

  /// What the errors after a round mean. @return empty: another round is to follow
  std::string status_of(int round, const RoundErrors& errors) {
    const RoundTargets& targets = options_.targets;
    const double missed = missed_by(errors, targets);
    const bool was_aimed = std::exchange(is_aimed_, is_hand_eye_worst(errors, targets));
    const auto promised = [&] {
      return promise_of(was_aimed, is_aimed_, missed, [&] {
        return missed_by(promised_errors(round + 1, errors), targets);
      });
    };
    return status_after_round(
        round, missed, std::exchange(missed_, missed), targets.max_rounds, promised);
  }

  Json acquire(int round) const {
    AcquireOptions acquire = options_.acquire;
    acquire.source.clear();
    acquire.views = views_;
    acquire.plan = plan_;
    acquire.out = round_folder(round);
    MountedPrototypes none({}, {});  // the board is seen by the cell's own lights
    return calibrate_cell_detail::acquire_round(acquire, none, permit_);
  }

  /// Pictures of a round beside those of the others, and their poses.
  void take_over(int round) {
    const Acquired acquired = read_acquired(round_folder(round));
    make_folder(folder_ / "pictures");
    for (const std::string& view : acquired.views()) {
      const AcquiredPicture picture = acquired.of_view(view).front();
      const std::string name = fmt::format("round_{}_{}.png", round, folder_name_of(view));
      const fs::path file = folder_ / "pictures" / name;
      write_file(file, read_file(acquired.folder / picture.file));
      pictures_.push_back(file);
      poses_ += calibrate_cell_detail::pose_toml(name, picture.base_from_flange);
      base_from_flange_.push_back(picture.base_from_flange);
    }
    write_file(folder_ / "poses.toml", calibrate_cell_detail::pose_convention_toml() + poses_);
  }

  Json calibrate() const {
    const CalibrateOptions options = {.pictures = pictures_,
                                      .board = options_.board,
                                      .poses = {folder_ / "poses.toml"},
                                      .out = folder_ / "calibration",
                                      .setup = options_.setup,
                                      .threads = options_.threads};
    return options_.calibrate ? options_.calibrate(options) : calibrate_pictures(options);
  }

  /// The poses of the pictures that the calibration rests on; a plan of others no longer counts.
  void take_accepted(const Json& calibration) {
    accepted_.clear();
    next_plan_ = nullptr;
    for (std::size_t i = 0; i < base_from_flange_.size(); ++i) {
      if (calibration["pictures"][i]["accepted"].get<bool>()) {
        accepted_.push_back(base_from_flange_[i]);
      }
    }
  }

  bool is_hand_eye_asked() const {
    return options_.targets.hand_eye_mm > 0.0 || options_.targets.hand_eye_deg > 0.0;
  }

  /// What a round's poses make of the errors now; nothing where none can be planned. Of the point
  /// error nothing is foretold.
  RoundErrors promised_errors(int round, RoundErrors errors) {
    Json plan;
    try {
      plan = plan_of(round);
    } catch (const ConfigError&) {
      return errors;  // the calibration that there is stands
    }
    if (!plan.contains("after")) {
      return errors;
    }
    const Json& after = plan.at("after").at(static_cast<std::size_t>(options_.poses_a_round) - 1);
    const auto share = [&](const char* name) {
      return after.at(name).get<double>() / plan.at("before").at(name).get<double>();
    };
    errors.hand_eye_mm *= share("hand_eye_mm");
    errors.hand_eye_deg *= share("hand_eye_deg");
    return errors;
  }

  /// Whether the poses of a plan have been chosen for a round that was begun: any other may be for
  /// other targets, or add to pictures that have been taken anew.
  bool is_plan_in_use(int round) const {
    return fs::exists(plan_folder(round) / "plan.json") &&
           (fs::exists(kept_file(round)) || ended_round(round_folder(round)));
  }

  /// Of the round that follows the one that was calibrated last.
  const Json& plan_of(int round) {
    if (!next_plan_.is_null()) {
      return next_plan_;
    }
    const fs::path folder = plan_folder(round);
    if (is_plan_in_use(round)) {
      next_plan_ = Json::parse(read_file(folder / "plan.json"), nullptr, false);
      return next_plan_;
    }
    next_plan_ =
        plan_poses({.count = kPlannedForOne * options_.poses_a_round,
                    .board = options_.board,
                    .camera = folder_ / "calibration",
                    .out = folder,
                    .taken = is_hand_eye_asked() ? accepted_ : std::vector<Eigen::Isometry3d>(),
                    .aim_mm = is_aimed_ ? options_.targets.hand_eye_mm : 0.0,
                    .aim_deg = is_aimed_ ? options_.targets.hand_eye_deg : 0.0});
    return next_plan_;
  }

  /// What the calibration asks for, as far as the arm gets there without touching anything.
  ReachedPoses planned_poses(int round) {
    const Json& plan = plan_of(round);
    std::vector<WantedPose> wanted;
    for (const Json& pose : plan.at("poses")) {
      wanted.push_back(
          {.name = pose["name"].get<std::string>(), .base_from_flange = pose_of(pose)});
    }
    return reached_poses(calibrated_cell(cell_, folder_ / "calibration"),
                         wanted,
                         static_cast<std::size_t>(options_.poses_a_round));
  }

  /// Pictures of a round belong to the paths that its arm was on, which earlier programs have not
  /// kept.
  void check_not_begun(int round) const {
    if (recorded_sessions(round_folder(round)) > 0) {
      throw ConfigError(fmt::format(
          "{}: an earlier program began this round and has not kept the paths that it chose for "
          "it; remove this folder, and the same command takes the round anew",
          round_folder(round).string()));
    }
  }

  /// The cell may have got another obstacle since the paths were chosen.
  void check_still_free(int round, const ViewPlan& plan) const {
    const std::string touch = obstruction(calibrated_cell(cell_, folder_ / "calibration"), plan);
    if (!touch.empty()) {
      throw ConfigError(fmt::format(
          "{}: a path that was chosen for this round is no longer free: {}; remove this folder and "
          "{}, and the same command takes the round anew",
          plan_folder(round).string(),
          touch,
          round_folder(round).string()));
    }
  }

  /// Those that the round was begun with, else new ones, which are kept for a later call.
  ReachedPoses poses_of(int round) {
    const fs::path kept = kept_file(round);
    if (fs::exists(kept)) {
      ReachedPoses poses = kept_poses(kept);
      check_still_free(round, poses.plan);
      return poses;
    }
    check_not_begun(round);
    ReachedPoses reached = planned_poses(round);
    if (reached.plan.paths.empty()) {
      return reached;  // not kept: the same command looks again, in a cell that was changed
    }
    keep_poses(reached, cell_.file, kept);
    return kept_poses(kept);
  }

  /// @return whether there is anything to photograph, or it has been photographed
  bool seek_poses(int round) {
    views_.clear();
    if (ended_round(round_folder(round))) {
      const fs::path kept = kept_file(round);
      plan_.reset();
      refused_ = fs::exists(kept) ? refused_json(kept_poses(kept).refused) : Json::array();
      return true;
    }
    ReachedPoses poses = poses_of(round);
    for (const PlannedView& planned : poses.plan.views) {
      CellPosition view = cell_.views.front();  // its lights and exposure
      view.name = planned.name;
      view.joints_rad.assign(planned.joints_rad.begin(), planned.joints_rad.end());
      views_.push_back(view);
    }
    refused_ = refused_json(poses.refused);
    plan_ = std::move(poses.plan);
    return !plan_->paths.empty();
  }

  const CalibrateCellOptions& options_;
  const MotionPermit& permit_;
  Cell cell_;
  fs::path folder_;
  std::vector<CellPosition> views_ = cell_.views;  ///< of the next round
  std::optional<ViewPlan> plan_;                   ///< of these; none: by their joints
  std::vector<fs::path> pictures_;
  std::string poses_;
  std::vector<Eigen::Isometry3d> base_from_flange_;  ///< of pictures_
  std::vector<Eigen::Isometry3d> accepted_;          ///< of those that the calibration rests on
  Json rounds_ = Json::array();
  double missed_ = 0.0;           ///< missed_by() after the last round
  bool is_aimed_ = false;         ///< the next poses are chosen for the hand-eye
  Json next_plan_;                ///< of the next round; null: not needed so far
  Json refused_ = Json::array();  ///< poses that the last plan passed over
  Json end_;                      ///< of an acquisition that was stopped, or a question that was
  Json next_;                     ///< what a person has to do before a round can be taken
};

}  // namespace

fs::path calibration_folder(const AcquireOptions& acquire) {
  return acquire.out.empty()
             ? default_result_folder(cell_name(acquire.cell), ResultKind::kCalibrate)
             : acquire.out;
}

Json calibrate_cell(const CalibrateCellOptions& options, const MotionPermit& permit) {
  return CellCalibration(options, permit).run();
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/check_run.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/units.h"
#include "hardware/calibration/camera_bundle.h"
#include "hardware/upkeep/drift.h"
#include "studies/calibrate/calibrate_files.h"
#include "studies/calibrate/known_calibration.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using PictureResiduals = std::vector<Eigen::Vector2d>;

/// New pictures against a calibration.
class Check {
 public:
  Check(const KnownCalibration& known, const CalibrateInput& input)
      : known_(known), input_(input), lens_(lens_vector(known.intrinsics)) {
    symmetry_.turns = num_symmetries(input.board);
    symmetry_.center_mm.head<2>() =
        0.5 * input.board.square_mm * Eigen::Vector2d(input.board.cols - 1, input.board.rows - 1);
    if (input.poses) {
      robot_ = picture_poses(input, input.poses->convention);
    }
  }

  Json result() const {
    std::vector<std::optional<PictureResiduals>> of_pictures;
    for (std::size_t i = 0; i < input_.corners.size(); ++i) {
      of_pictures.push_back(residuals(i, known_.poses.board));
    }
    Json json = judged(of_pictures);
    json["pictures"] = Json::array();
    for (std::size_t i = 0; i < of_pictures.size(); ++i) {
      json["pictures"].push_back(picture_json(i, of_pictures[i]));
    }
    json["notes"] = input_.notes;
    if (!can_judge()) {
      json["notes"].push_back(
          "the calibration does not know how well the robot's poses predict pictures "
          "(prediction_rms_px is null): without --poses its lens can be judged");
    }
    if (const std::string sets = sets_of_calibration();
        !sets.empty() && json["status"] != "valid") {
      json["notes"].push_back("the calibration's poses were read otherwise: with" + sets);
    }
    return json;
  }

 private:
  bool is_by_poses() const { return input_.poses.has_value(); }

  /// What the calibration's poses were read with and these are not.
  std::string sets_of_calibration() const {
    return is_by_poses() && known_.convention
               ? sets_between(input_.poses->convention, *known_.convention)
               : std::string();
  }

  /// Empty where no board was found, or where it cannot be computed.
  std::optional<PictureResiduals> residuals(std::size_t picture,
                                            const Eigen::Isometry3d& board) const {
    const BoardCorners& corners = input_.corners[picture];
    if (corners.board_mm.empty()) {
      return std::nullopt;
    }
    if (is_by_poses()) {
      const HandEye poses = {.hand_eye = known_.poses.hand_eye, .board = board};
      return residuals_at(
          lens_, camera_from_board(*known_.mounting, poses, robot_[picture]), symmetry_, corners);
    }
    const auto fitted = fit_view(corners, lens_);
    return fitted ? residuals_at(lens_, pose_of(camera_bundle(lens_, {}), fitted->view), corners)
                  : std::nullopt;
  }

  /// What the robot's poses predict is compared with what they predicted of pictures left out.
  bool can_judge() const { return !is_by_poses() || known_.prediction_rms_px.has_value(); }

  /// By its own pictures; of those that the robot's pose predicts, by those that were left out.
  double expected_px() const {
    const bool is_same_measure = is_by_poses() || !known_.mounting;
    return is_same_measure ? known_.prediction_rms_px.value_or(known_.rms_px) : known_.rms_px;
  }

  Json judged(const std::vector<std::optional<PictureResiduals>>& of_pictures) const {
    const PictureResiduals all = joined(of_pictures);
    const auto count = std::ranges::count_if(
        of_pictures, [](const auto& residuals) { return residuals.has_value(); });
    if (all.empty()) {
      throw ConfigError("no picture can be compared: the board would lie behind the camera");
    }
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    for (const Eigen::Vector2d& residual : all) {
      mean += residual / static_cast<double>(all.size());
    }
    Json json = verdict(rms_of(all), static_cast<int>(count));
    json["mean_px"] = {mean.x(), mean.y()};
    json["board_moved"] = is_by_poses() && count > 1 ? moved_json() : Json(nullptr);
    return json;
  }

  Json verdict(double rms, int pictures) const {
    Json json = {{"schema", 1},
                 {"status", "not_judged"},
                 {"by", is_by_poses() ? "prediction" : "reprojection"},
                 {"rms_px", rms},
                 {"expected_px", nullptr},
                 {"limit_px", nullptr},
                 {"drift_px", nullptr}};
    if (can_judge()) {
      const double expected = expected_px();
      const int freedoms = is_by_poses() ? kFreedomsByRobot : kFreedomsByFreePose;
      const double limit = drift_limit_px(expected, freedoms * pictures);
      json["status"] = rms <= limit ? "valid" : "drifted";
      json["expected_px"] = expected;
      json["limit_px"] = limit;
      json["drift_px"] = std::sqrt(std::max(0.0, rms * rms - expected * expected));
    }
    return json;
  }

  static PictureResiduals joined(const std::vector<std::optional<PictureResiduals>>& of_pictures) {
    PictureResiduals all;
    for (const auto& residuals : of_pictures) {
      if (residuals) {
        all.insert(all.end(), residuals->begin(), residuals->end());
      }
    }
    return all;
  }

  /// What would be if only the board had been moved: where the pictures see it, and the rms then.
  Json moved_json() const {
    std::vector<PosePair> pairs;
    for (std::size_t i = 0; i < input_.corners.size(); ++i) {
      const auto fitted =
          input_.corners[i].board_mm.empty() ? std::nullopt : fit_view(input_.corners[i], lens_);
      if (fitted) {
        pairs.push_back({.base_from_flange = robot_[i], .camera_from_board = upright(i, *fitted)});
      }
    }
    if (pairs.empty()) {
      return nullptr;
    }
    const Eigen::Isometry3d board = board_seen(*known_.mounting, known_.poses.hand_eye, pairs);
    std::vector<std::optional<PictureResiduals>> of_pictures;
    for (std::size_t i = 0; i < input_.corners.size(); ++i) {
      of_pictures.push_back(residuals(i, board));
    }
    const Eigen::Isometry3d step = known_.poses.board.inverse() * board;
    return {{"translation_mm", step.translation().norm()},
            {"rotation_deg", angle_rad(step.linear()) * kDegPerRad},
            {"rms_px", rms_of(joined(of_pictures))}};
  }

  /// camera_from_board of one picture, the board turned to where the calibration has it.
  Eigen::Isometry3d upright(std::size_t picture, const FittedView& fitted) const {
    const Eigen::Isometry3d seen = pose_of(camera_bundle(lens_, {}), fitted.view);
    const Eigen::Isometry3d computed =
        camera_from_board(*known_.mounting, known_.poses, robot_[picture]);
    Eigen::Isometry3d best = seen;
    for (int turn = 1; turn < symmetry_.turns; ++turn) {
      const Eigen::Isometry3d turned = seen * board_turn(symmetry_, turn);
      if (angle_rad(turned.linear().transpose() * computed.linear()) <
          angle_rad(best.linear().transpose() * computed.linear())) {
        best = turned;
      }
    }
    return best;
  }

  Json picture_json(std::size_t picture, const std::optional<PictureResiduals>& residuals) const {
    const BoardView& view = input_.views[picture];
    return {{"file", input_.names[picture]},
            {"accepted", residuals.has_value()},
            {"reason",
             residuals            ? std::string()
             : view.is_accepted() ? std::string("the board would lie behind the camera")
                                  : reason_of_view(view)},
            {"rms_px", residuals ? Json(rms_of(*residuals)) : Json(nullptr)}};
  }

  const KnownCalibration& known_;
  const CalibrateInput& input_;
  LensVector lens_;
  BoardSymmetry symmetry_;
  std::vector<Eigen::Isometry3d> robot_;  ///< base_from_flange of each picture; empty without poses
};

}  // namespace

Json check_calibration(const std::filesystem::path& calibration, const CalibrateOptions& options) {
  const KnownCalibration known = read_calibration(calibration);
  if (!options.poses.empty() && !known.mounting) {
    throw ConfigError(fmt::format("--poses: {} was made without poses", known.file.string()));
  }
  CalibrateOptions reading = options;
  reading.known_board = known.board;
  reading.known_given = known.given_board;
  ThreadPool pool(options.threads);
  const CalibrateInput input = read_calibrate_input(reading, pool);
  if (input.width_px != known.intrinsics.width_px ||
      input.height_px != known.intrinsics.height_px) {
    throw ConfigError(fmt::format("{}: is of a camera of {} x {} pixels, the pictures have {} x {}",
                                  known.file.string(),
                                  known.intrinsics.width_px,
                                  known.intrinsics.height_px,
                                  input.width_px,
                                  input.height_px));
  }
  return Check(known, input).result();
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is done beside calibrating a camera: checking a calibration, straight pictures, the sensor,
// a plan of poses, points drawn into pictures, where the part is.
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/commands.h"
#include "cli/shell/note_lines.h"
#include "cli/shell/placement_text.h"
#include "studies/calibrate/check_run.h"
#include "studies/calibrate/place_run.h"
#include "studies/calibrate/plan_run.h"
#include "studies/calibrate/points_run.h"
#include "studies/calibrate/undistort_run.h"
#include "studies/sensor_calibration/sensor_run.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

std::string check_text(const Json& result) {
  std::string text;
  for (const Json& picture : result["pictures"]) {
    const std::filesystem::path file = picture["file"].get<std::string>();
    text += fmt::format("  {:<28} ", file.filename().string());
    text += picture["accepted"].get<bool>()
                ? fmt::format("{:>8.3f} px\n", picture["rms_px"].get<double>())
                : fmt::format("not used: {}\n", picture["reason"].get<std::string>());
  }
  if (result["status"] == "not_judged") {
    return text +
           fmt::format("cannot be judged: {:.3g} px rms from the robot's poses alone\n",
                       result["rms_px"].get<double>()) +
           note_lines(result["notes"]);
  }
  const bool is_valid = result["status"] == "valid";
  const bool is_predicted = result["by"] == "prediction";
  text += fmt::format("{}: {:.3g} px rms {}, {:.3g} px expected, up to {:.3g} px allowed\n",
                      is_valid ? "still valid" : "drifted",
                      result["rms_px"].get<double>(),
                      is_predicted ? "from the robot's poses alone" : "with a free pose a picture",
                      result["expected_px"].get<double>(),
                      result["limit_px"].get<double>());
  if (!is_valid) {
    text += fmt::format("drift {:.3g} px; mean shift {:.3g}, {:.3g} px\n",
                        result["drift_px"].get<double>(),
                        result["mean_px"][0].get<double>(),
                        result["mean_px"][1].get<double>());
    const Json& moved = result["board_moved"];
    if (!moved.is_null() && moved["rms_px"].get<double>() < result["rms_px"].get<double>()) {
      text += fmt::format(
          "with the board moved by {:.3g} mm and {:.3g} degrees it would be {:.3g} px\n",
          moved["translation_mm"].get<double>(),
          moved["rotation_deg"].get<double>(),
          moved["rms_px"].get<double>());
    }
  }
  return text + note_lines(result["notes"]);
}

std::string sensor_text(const Json& result) {
  const Json& sensor = result["sensor"];
  const Json& linearity = result["linearity_error"];
  std::string text = fmt::format(
      "  gain          {:.4g} +- {:.2g} DN per electron (weighted affine fit)\n"
      "  full_well_e   {:.5g}\n  read_noise_e  {:.4g}\n  dark_e        {:.4g}\n"
      "  linearity     {}   PRNU {:.3g} %   DSNU {:.3g} e   largest SNR {:.4g}\n",
      result["gain_dn_per_e"].get<double>(),
      result["gain_sigma"].get<double>(),
      sensor["full_well_e"].get<double>(),
      sensor["read_noise_e"].get<double>(),
      sensor["dark_e"].get<double>(),
      linearity.is_number() ? fmt::format("{:.2g} %", 100.0 * linearity.get<double>())
                            : std::string("not known"),
      100.0 * result["prnu"].get<double>(),
      result["dsnu_e"].get<double>(),
      result["largest_snr"].get<double>());
  text += warning_lines(result["warnings"]);
  return text + fmt::format("report: {}\nsensor for scenes: {}/sensor.toml\n",
                            result["report"].get<std::string>(),
                            result["folder"].get<std::string>());
}

/// What so few poses leave open has a sigma beyond any use.
std::string hand_eye_promise(const Json& promised) {
  constexpr double kMaxUseful_mm = 1000.0;
  const double sigma_mm = promised["hand_eye_mm"].get<double>();
  if (!(sigma_mm < kMaxUseful_mm)) {
    return "no hand-eye: it needs at least 3 poses, turned about different axes";
  }
  return fmt::format("a hand-eye to {:.2g} mm and {:.2g} degrees",
                     sigma_mm,
                     promised["hand_eye_deg"].get<double>());
}

std::string pose_plan_text(const Json& plan) {
  const Json& promised = plan["promised"];
  return note_lines(plan["notes"]) +
         fmt::format(
             "{} poses of {}; they promise a focal length to {:.2g} px, the centre to {:.2g} px,\n"
             "{}\nposes: {}/poses.csv\n",
             plan["poses"].size(),
             plan["pose"].get<std::string>(),
             promised["focal_px"][0].get<double>(),
             promised["center_px"][0].get<double>(),
             hand_eye_promise(promised),
             plan["folder"].get<std::string>());
}

std::string points_text(const Json& result) {
  std::size_t seen = 0;
  for (const Json& picture : result["pictures"]) {
    for (const Json& point : picture["points"]) {
      seen += point["is_in_picture"].get<bool>() ? 1U : 0U;
    }
  }
  return fmt::format("{} crosses in {} pictures: {}\n",
                     seen,
                     result["pictures"].size(),
                     result["folder"].get<std::string>());
}

std::string place_text(const Json& result) {
  std::string text;
  for (const Json& placement : result["placements"]) {
    text += fmt::format(
        "  {:<28} by {}", placement["file"].get<std::string>(), placement["by"].get<std::string>());
    for (const char* unit : {"mm", "px"}) {
      const auto rms = placement.find(fmt::format("rms_{}", unit));
      if (rms != placement.end() && rms->is_number()) {
        text += fmt::format(", rms {:.3g} {}", rms->get<double>(), unit);
      }
    }
    text += "\n";
  }
  const char* name = result.contains("flange_from_part") ? "flange_from_part" : "base_from_part";
  return text +
         placed_part_text(result, name, result["folder"].get<std::string>() + "/placement.toml");
}

}  // namespace

int check_calibration_command(const CalibrateArguments& arguments, const CommonArguments& common) {
  const Json result = check_calibration(arguments.checked,
                                        {.pictures = arguments.pictures,
                                         .board = arguments.board,
                                         .poses = arguments.poses,
                                         .sets = key_values(arguments.sets),
                                         .threads = common.threads});
  print_result(common, result, check_text(result));
  return result["status"] == "valid" ? kExitDone : kExitNegative;
}

int sensor_command(const CalibrateArguments& arguments, const CommonArguments& common) {
  const Json result = calibrate_sensor({.folder = arguments.sensor,
                                        .out = arguments.out,
                                        .bits = arguments.bits,
                                        .threads = common.threads});
  print_result(common, result, sensor_text(result));
  return kExitDone;
}

int plan_command(const CalibrateArguments& arguments, const CommonArguments& common) {
  const Json plan = plan_poses({.count = *arguments.planned,
                                .board = arguments.board,
                                .camera = arguments.camera,
                                .out = arguments.out,
                                .sets = key_values(arguments.sets)});
  print_result(common, plan, pose_plan_text(plan));
  return kExitDone;
}

int points_command(const CalibrateArguments& arguments, const CommonArguments& common) {
  const Json result = draw_points(arguments.points,
                                  {.pictures = arguments.pictures,
                                   .poses = arguments.poses,
                                   .camera = arguments.camera,
                                   .out = arguments.out,
                                   .sets = key_values(arguments.sets),
                                   .threads = common.threads});
  print_result(common, result, points_text(result));
  return kExitDone;
}

int place_command(const CalibrateArguments& arguments, const CommonArguments& common) {
  std::vector<PlaceInput> inputs;
  for (const std::filesystem::path& file : arguments.placed) {
    inputs.push_back({.file = file});
  }
  const Json result = place_part(inputs,
                                 {.pictures = arguments.pictures,
                                  .board = arguments.board,
                                  .poses = arguments.poses,
                                  .camera = arguments.camera,
                                  .out = arguments.out,
                                  .sets = key_values(arguments.sets),
                                  .threads = common.threads});
  print_result(common, result, place_text(result));
  return kExitDone;
}

int undistort_command(const UndistortArguments& arguments, const CommonArguments& common) {
  const Json result = undistort_pictures({.pictures = arguments.pictures,
                                          .camera = arguments.camera,
                                          .out = arguments.out,
                                          .threads = common.threads});
  print_result(common,
               result,
               fmt::format("{} picture{}; {:.2g} % of their pixels show nothing\n"
                           "their camera: {}/camera.toml\n",
                           result["pictures"].size(),
                           result["pictures"].size() == 1 ? "" : "s",
                           100.0 * result["outside_share"].get<double>(),
                           result["folder"].get<std::string>()));
  return kExitDone;
}

}  // namespace glint

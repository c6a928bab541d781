// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/acquire/cell_calibration.h"
#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/shell/mode_options.h"
#include "cli/shell/note_lines.h"
#include "studies/calibrate/calibrate_run.h"
#include "studies/calibrate/print_board.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

std::string number_text(const Json& value, const char* unit) {
  return value.is_null() ? std::string("unknown")
                         : fmt::format("{:.4g}{}", value.get<double>(), unit);
}

std::string pictures_text(const Json& pictures) {
  std::size_t accepted = 0;
  std::string text = fmt::format("  {:<28} {:>8}\n", "picture", "rms px");
  for (const Json& picture : pictures) {
    const bool is_accepted = picture["accepted"].get<bool>();
    accepted += is_accepted ? 1 : 0;
    const std::filesystem::path file = picture["file"].get<std::string>();
    text += fmt::format("  {:<28} ", file.filename().string());
    text += is_accepted ? fmt::format("{:>8.3f}\n", picture["rms_px"].get<double>())
                        : fmt::format("rejected: {}\n", picture["reason"].get<std::string>());
  }
  return text + fmt::format("{} of {} pictures accepted\n", accepted, pictures.size());
}

/// A pair of numbers with their standard deviations.
std::string pair_text(const Json& intrinsics, const char* key) {
  const Json& value = intrinsics[key];
  const Json& sigma = intrinsics["sigma"][key];
  return fmt::format("{:.2f} +- {:.2g}, {:.2f} +- {:.2g} px",
                     value[0].get<double>(),
                     sigma[0].get<double>(),
                     value[1].get<double>(),
                     sigma[1].get<double>());
}

std::string camera_text(const Json& intrinsics) {
  const Json& radial = intrinsics["radial"];
  const Json& tangential = intrinsics["tangential"];
  return fmt::format("  focal length  {}\n  centre        {}\n",
                     pair_text(intrinsics, "focal_px"),
                     pair_text(intrinsics, "center_px")) +
         fmt::format("  distortion    k1 {:.4g}  k2 {:.4g}  k3 {:.4g}  p1 {:.3g}  p2 {:.3g}\n",
                     radial[0].get<double>(),
                     radial[1].get<double>(),
                     radial[2].get<double>(),
                     tangential[0].get<double>(),
                     tangential[1].get<double>());
}

std::string hand_eye_text(const Json& result) {
  const Json& pose = result["hand_eye"];
  const Json& turn = pose["rotation_vector_rad"];
  const Json& at = pose["translation_mm"];
  std::string text = fmt::format("  {}_from_camera, {}: {:.3f} {:.3f} {:.3f} mm +- {}\n",
                                 pose["to"].get<std::string>(),
                                 result["setup"].get<std::string>(),
                                 at[0].get<double>(),
                                 at[1].get<double>(),
                                 at[2].get<double>(),
                                 number_text(pose["sigma_mm"], " mm"));
  text += fmt::format("    rotation vector {:.5f} {:.5f} {:.5f} rad +- {}\n",
                      turn[0].get<double>(),
                      turn[1].get<double>(),
                      turn[2].get<double>(),
                      number_text(pose["sigma_deg"], " degrees"));
  text += fmt::format("    board's orientation: by the {}\n",
                      result["board"]["orientation"].get<std::string>());
  text += "  pictures left out are predicted to:";
  for (const Json& method : result["methods"]) {
    text +=
        fmt::format("  {} {}",
                    method["name"].get<std::string>(),
                    method["failed"].get<bool>() ? std::string("failed")
                                                 : number_text(method["prediction_rms_px"], " px"));
  }
  return text + "\n";
}

std::string calibration_text(const Json& result) {
  std::string text = pictures_text(result["pictures"]) + camera_text(result["intrinsics"]);
  if (!result["hand_eye"].is_null()) {
    text += hand_eye_text(result);
  }
  text += fmt::format("  rms {}", number_text(result["rms_px"], " px"));
  if (!result["prediction_rms_px"].is_null()) {
    text +=
        fmt::format(", of pictures left out {}", number_text(result["prediction_rms_px"], " px"));
  }
  text += "\n";
  text += warning_lines(result["warnings"]) + note_lines(result["notes"]);
  return text + fmt::format("report: {}\ncamera for scenes: {}/calibration.toml\n",
                            result["report"].get<std::string>(),
                            result["folder"].get<std::string>());
}

int print_command(const CalibrateArguments& arguments, const CommonArguments& common) {
  const Json result = print_board(arguments.printed, arguments.out);
  print_result(common,
               result,
               fmt::format("{} x {} corners, sheet of {:.4g} x {:.4g} mm; print it at 100 %\n"
                           "files: {}\n",
                           result["cols"].get<int>(),
                           result["rows"].get<int>(),
                           result["size_mm"][0].get<double>(),
                           result["size_mm"][1].get<double>(),
                           result["folder"].get<std::string>()));
  return kExitDone;
}

/// @throws ConfigError naming an option that the mode asked for does not take
void check_calibrate_options(const CalibrateArguments& arguments) {
  static const std::vector<OptionMode> modes = {
      {.option = "--cell",
       .takes = {"--board",
                 "--setup",
                 "--camera",
                 "--out",
                 "--move",
                 "--twin",
                 "--speed_share",
                 "--confirmed",
                 "--mounted",
                 "--target_px",
                 "--target_mm",
                 "--target_deg",
                 "--max_rounds",
                 "--part",
                 "--placements",
                 "--placed"}},
      {.option = "--print_board", .takes = {"--out"}},
      {.option = "--check", .takes = {"PICTURES", "--board", "--poses", "--set"}},
      {.option = "--sensor", .takes = {"--bits", "--out"}},
      {.option = "--plan", .takes = {"--board", "--camera", "--out", "--set"}},
      {.option = "--place",
       .takes = {"PICTURES", "--board", "--poses", "--camera", "--out", "--set"}},
      {.option = "--points", .takes = {"PICTURES", "--poses", "--camera", "--out", "--set"}},
      {.option = "",
       .takes = {"PICTURES",
                 "--from",
                 "--board",
                 "--poses",
                 "--camera",
                 "--out",
                 "--setup",
                 "--method",
                 "--set"}}};
  check_mode_options(arguments.given, modes);
}

int calibrate_from_files(const CalibrateArguments& arguments, const CommonArguments& common) {
  if (!arguments.printed.empty()) {
    return print_command(arguments, common);
  }
  if (!arguments.checked.empty()) {
    return check_calibration_command(arguments, common);
  }
  if (!arguments.sensor.empty()) {
    return sensor_command(arguments, common);
  }
  if (arguments.planned) {
    return plan_command(arguments, common);
  }
  if (!arguments.placed.empty()) {
    return place_command(arguments, common);
  }
  if (!arguments.points.empty()) {
    return points_command(arguments, common);
  }
  const Json result = calibrate_pictures({.pictures = arguments.pictures,
                                          .from = arguments.from,
                                          .board = arguments.board,
                                          .poses = arguments.poses,
                                          .camera = arguments.camera,
                                          .out = arguments.out,
                                          .setup = arguments.setup,
                                          .method = arguments.method,
                                          .sets = key_values(arguments.sets),
                                          .threads = common.threads});
  print_result(common, result, calibration_text(result));
  return kExitDone;
}

}  // namespace

int calibrate_command(const CommandLine& given) {
  check_calibrate_options(given.calibrate);
  if (given.cell_calibration.acquire.cell.empty()) {
    return calibrate_from_files(given.calibrate, given.common);
  }
  CellCalibrationArguments arguments = given.cell_calibration;
  arguments.board = given.calibrate.board;
  arguments.setup = given.calibrate.setup;
  arguments.camera = given.calibrate.camera;
  arguments.acquire.out = given.calibrate.out;
  arguments.threads = given.common.threads;
  const AcquireAnswer answer =
      run_cell_calibration(arguments, given.common.is_json || given.common.is_quiet);
  print_result(given.common, answer.json, answer.text);
  return answer.exit_code;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/acquire/cell_calibration.h"

#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "cli/acquire/driven_session.h"
#include "cli/shell/exit_codes.h"
#include "cli/shell/placement_text.h"
#include "core/error.h"
#include "studies/calibrate_cell/calibrate_cell_run.h"
#include "studies/calibrate_cell/place_part_run.h"
#include "studies/cell/typed_permit.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

std::string end_text(const Json& end) {
  return fmt::format("{}, the arm is at {}: {}\n",
                     end["how"].get<std::string>(),
                     end["where"].get<std::string>(),
                     end["text"].get<std::string>());
}

/// What the end of the rounds means.
std::string_view status_text(const std::string& status) {
  if (status == "good") {
    return "good";
  }
  if (status == "max_rounds") {
    return "all rounds are used up, further poses may help";
  }
  if (status == "no_picture") {
    return "all pictures of the last round were rejected; the folder of the round says why";
  }
  return status == "no_pose_reached" ? "the arm cannot take any pose that would help"
                                     : "no further pose helps";
}

/// A dash where it is not known.
std::string sigma_text(const Json& sigma, int digits) {
  return sigma.is_number() && std::isfinite(sigma.get<double>())
             ? fmt::format("{:.{}f}", sigma.get<double>(), digits)
             : std::string("-");
}

/// "0.300 px, 0.040 mm were asked for"
std::string targets_text(const Json& result) {
  std::string text = fmt::format("{:.3f} px", result["target_px"].get<double>());
  for (const auto& [name, unit] :
       {std::pair("target_mm", "mm"), std::pair("target_deg", "degrees")}) {
    if (const double target = result[name].get<double>(); target > 0.0) {
      text += fmt::format(", {:g} {}", target, unit);
    }
  }
  return text;
}

/// What a person has to do: put the part down, mount a prototype, or switch lights.
std::string next_text(const Json& next) {
  return next.contains("placement") ? fmt::format("{}; then the same command with --placed {}\n",
                                                  next["text"].get<std::string>(),
                                                  next["placement"].get<int>())
                                    : waiting_text(next, "the same command");
}

std::string rounds_text(const Json& result) {
  std::string text;
  for (const Json& round : result["rounds"]) {
    text += fmt::format(
        "round {}: {} pictures, a computed point is good to {:.3f} px, the hand-eye to {} mm and "
        "{} degrees\n",
        round["round"].get<int>(),
        round["pictures"].get<int>(),
        round["point_error_px"].get<double>(),
        sigma_text(round["hand_eye_sigma_mm"], 3),
        sigma_text(round["hand_eye_sigma_deg"], 4));
  }
  for (const Json& refused : result["refused"]) {
    text += fmt::format("pose {} is passed over, {}: {}\n",
                        refused["pose"].get<std::string>(),
                        refused["outcome"].get<std::string>(),
                        refused["reason"].get<std::string>());
  }
  if (result["status"] == "stopped") {
    return text + end_text(result["end"]);
  }
  if (result["status"] == "waiting") {
    return text + next_text(result["next"]);
  }
  text += fmt::format("{}: {} were asked for\n",
                      status_text(result["status"].get<std::string>()),
                      targets_text(result));
  return result["rounds"].empty() ? text : text + result["calibration"].get<std::string>() + "\n";
}

std::string part_text(const Json& result) {
  std::string text;
  for (const Json& placement : result["placements"]) {
    text += fmt::format("placement {}: {} pictures",
                        placement["placement"].get<int>(),
                        placement["pictures"].get<int>());
    text += placement.contains("rms_px")
                ? fmt::format(", edges are {:.3f} px off\n", placement["rms_px"].get<double>())
                : std::string("\n");
  }
  const std::string status = result["status"].get<std::string>();
  if (status == "placed") {
    return text +
           placed_part_text(result, "base_from_part", result["placement"].get<std::string>());
  }
  if (status == "waiting") {
    return text + next_text(result["next"]);
  }
  return text + (status == "stopped" ? end_text(result["end"])
                                     : "the part is seen in fewer than two pictures\n");
}

std::string text_of(const Json& result) {
  return (result.contains("rounds") ? rounds_text(result) : "") +
         (result.contains("part") ? part_text(result["part"]) : "");
}

int calibration_exit_code(const Json& result) {
  const Json& end = result.contains("part") ? result["part"]["end"] : result["end"];
  if (end.is_object() && end["cause"] == "interrupted") {
    return kExitInterrupted;
  }
  return result["ok"] == true ? kExitDone : kExitNegative;
}

/// The part after the board, by its calibration, or alone.
/// @param result  of the board, null without one
void add_part(const CellCalibrationArguments& arguments,
              const AcquireOptions& acquire,
              const MotionPermit& permit,
              Json& result) {
  if (result.is_object() && (result["status"] == "stopped" || result["status"] == "waiting" ||
                             result["rounds"].empty())) {
    return;  // without a calibration the part's place means nothing
  }
  PlacePartOptions options = {.acquire = acquire,
                              .scene = arguments.part,
                              .calibration = arguments.camera,
                              .placements = arguments.placements,
                              .placed = arguments.placed,
                              .threads = arguments.threads};
  options.acquire.out = calibration_folder(acquire);
  if (result.is_object()) {
    options.calibration = options.acquire.out / "calibration";
  }
  const Json part = place_part_in_cell(options, permit);
  if (!result.is_object()) {
    result = {{"schema", 1}, {"status", part["status"]}, {"ok", part["ok"]}};
  } else if (part["ok"] == false) {
    result["status"] = part["status"];
    result["ok"] = false;
  }
  result["part"] = part;
}

void check(const CellCalibrationArguments& arguments) {
  const bool has_part = !arguments.part.empty();
  if (!has_part && (arguments.placements != 1 || arguments.placed != 0)) {
    throw ConfigError("--placements, --placed: need --part, the scene of the part to be placed");
  }
  if (!has_part && !arguments.acquire.mounted.empty()) {
    throw ConfigError("--mounted: needs --part, with a scene that is a design of a run");
  }
  if (has_part && arguments.board.empty() == arguments.camera.empty()) {
    throw ConfigError(
        "--part: needs --board, which is calibrated first, or --camera, the folder of a "
        "calibration; one of them");
  }
}

}  // namespace

AcquireAnswer run_cell_calibration(const CellCalibrationArguments& arguments, bool is_silent) {
  const MotionPermit permit = typed_permit(arguments.acquire.is_move, "calibrate --cell");
  check(arguments);
  CalibrateCellOptions options = {.acquire = driven_options(arguments.acquire),
                                  .board = arguments.board,
                                  .targets = {.point_px = arguments.target_px,
                                              .hand_eye_mm = arguments.target_mm,
                                              .hand_eye_deg = arguments.target_deg,
                                              .max_rounds = arguments.max_rounds},
                                  .threads = arguments.threads};
  if (!arguments.setup.empty()) {
    options.setup = arguments.setup;
  }
  DrivenSession session(is_silent);
  session.attend(options.acquire);
  Json result;
  if (!arguments.board.empty() || arguments.part.empty()) {
    result = calibrate_cell(options, permit);
  }
  if (!arguments.part.empty()) {
    add_part(arguments, options.acquire, permit, result);
  }
  return {.json = result, .text = text_of(result), .exit_code = calibration_exit_code(result)};
}

}  // namespace glint

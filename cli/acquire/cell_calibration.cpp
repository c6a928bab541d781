// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/acquire/cell_calibration.h"

#include <string>

#include <fmt/format.h>

#include "cli/acquire/driven_session.h"
#include "cli/shell/exit_codes.h"
#include "studies/calibrate_cell/calibrate_cell_run.h"
#include "studies/cell/typed_permit.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

std::string text_of(const Json& result) {
  std::string text;
  for (const Json& round : result["rounds"]) {
    text += fmt::format("round {}: {} pictures, a computed point is good to {:.3f} px\n",
                        round["round"].get<int>(),
                        round["pictures"].get<int>(),
                        round["point_error_px"].get<double>());
  }
  if (result["status"] == "stopped") {
    const Json& end = result["end"];
    return text + fmt::format("{}, the arm is at {}: {}\n",
                              end["how"].get<std::string>(),
                              end["where"].get<std::string>(),
                              end["text"].get<std::string>());
  }
  return text + fmt::format("{}: {:.3f} px were asked for\n{}\n",
                            result["status"] == "good" ? "good" : "no further pose helps",
                            result["target_px"].get<double>(),
                            result["calibration"].get<std::string>());
}

int exit_code_of(const Json& result) {
  const Json& end = result["end"];
  if (end.is_object() && end["cause"] == "interrupted") {
    return kExitInterrupted;
  }
  return result["ok"] == true ? kExitDone : kExitNegative;
}

}  // namespace

AcquireAnswer run_cell_calibration(const CellCalibrationArguments& arguments, bool is_silent) {
  const MotionPermit permit = typed_permit(arguments.acquire.is_move, "calibrate --cell");
  CalibrateCellOptions options = {.acquire = driven_options(arguments.acquire),
                                  .board = arguments.board,
                                  .target_px = arguments.target_px,
                                  .threads = arguments.threads};
  DrivenSession session(is_silent);
  session.attend(options.acquire);
  const Json result = calibrate_cell(options, permit);
  return {.json = result, .text = text_of(result), .exit_code = exit_code_of(result)};
}

}  // namespace glint

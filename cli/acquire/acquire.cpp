// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/acquire/acquire.h"

#include <string>
#include <vector>

#include <fmt/format.h>

#include "cli/acquire/driven_session.h"
#include "cli/shell/exit_codes.h"
#include "core/shell_word.h"
#include "core/text.h"
#include "studies/acquire/acquire_run.h"
#include "studies/cell/typed_permit.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

/// "--mounted wide", and that another name which was typed has to go, or "--confirmed ring=on".
std::string confirming_text(const Json& next) {
  if (next.contains("lights")) {
    std::vector<std::string> options;
    for (const Json& light : next["confirm"]) {
      options.push_back("--confirmed " + shell_word(light.get<std::string>()));
    }
    return join(options, " ");
  }
  return fmt::format("--mounted {}{}",
                     shell_word(next["design"].get<std::string>()),
                     next["in_place_of"].empty() ? "" : " in the place of the other");
}

std::string dry_run_text(const Json& result) {
  std::string text =
      fmt::format("{} pictures from {} views, {:.0f} s of motion; nothing is moved\n",
                  result["pictures"].get<int>(),
                  result["views"].size(),
                  result["motion_s"].get<double>());
  for (const Json& view : result["views"]) {
    std::string names;
    for (const Json& light : view["lights"]) {
      names += " " + light.get<std::string>();
    }
    text += fmt::format("  {:<16} {} picture(s), {:.0f} us, lights:{}\n",
                        view["view"].get<std::string>(),
                        view["pictures"].get<int>(),
                        view["exposure_us"].get<double>(),
                        names.empty() ? " none" : names);
  }
  for (const Json& view : result["unplanned"]) {
    text += fmt::format("  {:<16} not taken, {}: {}\n",
                        view["view"].get<std::string>(),
                        view["outcome"].get<std::string>(),
                        view["reason"].get<std::string>());
  }
  if (const Json& next = result["next"]; !next.is_null()) {
    text += fmt::format(
        "  before it: {} ({})\n", next["text"].get<std::string>(), confirming_text(next));
  }
  return text;
}

std::string result_text(const Json& result) {
  const Json& counts = result["counts"];
  const Json& end = result["end"];
  std::string text = fmt::format("{}{}: {} of {} pictures, {} rejected; the arm is at {}\n",
                                 result["twin"].get<bool>() ? "twin: " : "",
                                 result["status"].get<std::string>(),
                                 counts["accepted"].get<int>(),
                                 counts["wanted"].get<int>(),
                                 counts["rejected_now"].get<int>(),
                                 end["where"].get<std::string>());
  if (end["cause"] != "none") {
    text += fmt::format("{}, {}: {}\n",
                        end["how"].get<std::string>(),
                        end["cause"].get<std::string>(),
                        end["text"].get<std::string>());
  }
  for (const Json& picture : result["pictures"]) {
    if (picture["accepted"] == false) {
      text += fmt::format(
          "  {}: {}\n", picture["file"].get<std::string>(), picture["reason"].get<std::string>());
    }
  }
  return text + fmt::format("pictures: {}/views\n", result["folder"].get<std::string>());
}

int exit_code_of(const Json& result) {
  const Json& end = result["end"];
  if (end.is_object() && end["cause"] == "interrupted") {
    return kExitInterrupted;
  }
  return result["ok"] == true ? kExitDone : kExitNegative;
}

}  // namespace

std::string waiting_text(const Json& next, const std::string& again) {
  return fmt::format("waiting: {}; then {} with {}\n",
                     next["text"].get<std::string>(),
                     again,
                     confirming_text(next));
}

AcquireAnswer acquire_answer(const Json& result, const std::string& again) {
  if (result["status"] == "waiting") {
    return {.json = result,
            .text = waiting_text(result["next"], again),
            .exit_code = exit_code_of(result)};
  }
  return {.json = result, .text = result_text(result), .exit_code = exit_code_of(result)};
}

AcquireAnswer run_acquire(const AcquireArguments& arguments, bool is_silent) {
  if (arguments.is_dry_run) {
    const Json result = describe_acquisition(driven_options(arguments));
    return {.json = result,
            .text = dry_run_text(result),
            .exit_code = result["ok"] == true ? kExitDone : kExitNegative};
  }
  const MotionPermit permit = typed_permit(arguments.is_move, "acquire");
  AcquireOptions options = driven_options(arguments);
  DrivenSession session(is_silent);
  session.attend(options);
  return acquire_answer(acquire_pictures(options, permit));
}

}  // namespace glint

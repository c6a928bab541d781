// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint cell`: the camera and the robot of a cell, and their twins.
#include <algorithm>
#include <array>
#include <charconv>
#include <iostream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "cli/cell.h"
#include "cli/shell/interrupts.h"
#include "studies/cell/cell_robot.h"
#include "studies/cell/ready_file.h"
#include "studies/cell/twin_process.h"
#include "studies/cell/typed_permit.h"
#include "studies/cell_camera/cell_camera.h"
#include "studies/twin_cell/cell_twins.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

std::string joined(const Json& numbers, const char* format) {
  std::string text;
  for (const Json& number : numbers) {
    text += fmt::format(fmt::runtime(format), number.get<double>());
  }
  return text;
}

std::string state_text(const Json& state) {
  return fmt::format("  robot mode    {}\n  safety mode   {}\n  program       {}\n",
                     state["robot_mode"].get<std::string>(),
                     state["safety_mode"].get<std::string>(),
                     state["program"].get<std::string>()) +
         fmt::format("  joints        {} degrees\n", joined(state["joints_deg"], " {:9.3f}")) +
         fmt::format("  TCP           {} mm\n",
                     joined(state["base_from_tcp"]["translation_mm"], " {:9.3f}"));
}

std::string status_text(const Json& status) {
  std::string text = fmt::format("{} at {:.0f} Hz, controller {}\n",
                                 status["twin"].get<bool>() ? "twin of a robot" : "robot",
                                 status["rate_hz"].get<double>(),
                                 status["controller"].get<std::string>());
  text += state_text(status["robot"]);
  return text + (status["movable"].get<bool>()
                     ? std::string("  may be moved\n")
                     : fmt::format("  may not be moved: {}\n",
                                   status["not_movable_because"].get<std::string>()));
}

std::string move_text(const Json& result) {
  const std::string outcome = result["outcome"].get<std::string>();
  const std::string why = result["text"].get<std::string>();
  return fmt::format("{} {}{}{}\n",
                     result["twin"].get<bool>() ? "twin:" : "robot:",
                     outcome,
                     why.empty() ? "" : ": ",
                     why);
}

std::string replies_text(const Json& result) {
  std::string text;
  for (const Json& reply : result["replies"]) {
    text += fmt::format(
        "{}: {}\n", reply["command"].get<std::string>(), reply["reply"].get<std::string>());
  }
  return text;
}

int exit_code(const Json& result) {
  return result.value("ok", true) ? kExitDone : kExitNegative;
}

Cell cell_of(const CellArguments& arguments, DrivenDevices driven = DrivenDevices::kRobot) {
  Cell cell = read_cell(the_word(arguments, "the cell's file"));
  return arguments.twin.empty() ? cell : with_ports(std::move(cell), arguments.twin, driven);
}

std::string list_text(const Json& list) {
  std::string text;
  for (const Json& camera : list["cameras"]) {
    text += fmt::format("camera {:<24} {:<16} {} {}{}\n",
                        camera["id"].get<std::string>(),
                        camera["address"].get<std::string>(),
                        camera["vendor"].get<std::string>(),
                        camera["model"].get<std::string>(),
                        camera["twin"].get<bool>() ? ", a twin" : "");
  }
  for (const Json& robot : list["robots"]) {
    text += fmt::format("robot  twin at {} port {}\n",
                        robot["address"].get<std::string>(),
                        robot["rtde_port"].get<int>());
  }
  return text.empty() ? "nothing answers; robots other than twins are not found by the network\n"
                      : text;
}

std::string grab_text(const Json& result) {
  std::string text = fmt::format("{} of {} pictures, {:.1f} a second\n",
                                 result["complete"].get<int>(),
                                 result["count"].get<int>(),
                                 result["frames_per_second"].get<double>());
  for (const Json& frame : result["frames"]) {
    if (frame["status"] != "complete") {
      text += fmt::format(
          "{}: {}\n", frame["status"].get<std::string>(), frame["what"].get<std::string>());
    }
  }
  return text + fmt::format("pictures: {}/sequence\n", result["folder"].get<std::string>());
}

int list_action(const CellArguments& arguments, const CommonArguments& common) {
  if (!arguments.words.empty()) {
    throw ConfigError("glint cell list: takes no file, it asks the network");
  }
  const Json result = list_cameras();
  print_result(common, result, list_text(result));
  return kExitDone;
}

int grab_action(const CellArguments& arguments, const CommonArguments& common) {
  const Json result = grab_pictures(cell_of(arguments, DrivenDevices::kCamera),
                                    {.count = arguments.count, .out = arguments.out});
  print_result(common, result, grab_text(result));
  return result["ok"].get<bool>() ? kExitDone : kExitNegative;
}

int status_action(const CellArguments& arguments, const CommonArguments& common) {
  const Json result = robot_status(cell_of(arguments));
  print_result(common, result, status_text(result));
  return exit_code(result);
}

int watch_action(const CellArguments& arguments, const CommonArguments& common) {
  const bool is_text = !common.is_json && !common.is_quiet;
  const Json result =
      watch_robot(cell_of(arguments), arguments.duration_s, 0.5, [is_text](const Json& state) {
        if (is_text) {
          std::cout << state_text(state) << std::flush;
        }
        return true;
      });
  print_result(common, result, move_text(result));
  return exit_code(result);
}

MotionPermit permit_of(const CellArguments& arguments) {
  return typed_permit(arguments.is_move, "cell " + arguments.action);
}

int move_to(const Cell& cell,
            const CellPosition& position,
            const CellArguments& arguments,
            const CommonArguments& common,
            const MotionPermit& permit) {
  keep_attending();
  const Json result = move_robot(cell,
                                 position,
                                 {.share = arguments.speed_share,
                                  .is_line = arguments.is_line,
                                  .interrupt = &take_interrupts()},
                                 permit);
  print_result(common, result, move_text(result));
  return result["status"] == "interrupted" ? kExitInterrupted : exit_code(result);
}

int move_action(const CellArguments& arguments, const CommonArguments& common) {
  const MotionPermit permit = permit_of(arguments);
  const Cell cell = cell_of(arguments);
  if (arguments.view.empty()) {
    throw ConfigError("glint cell move: needs --view with a name or number of a [[view]]");
  }
  return move_to(cell, view_of(cell, arguments.view), arguments, common, permit);
}

int safe_action(const CellArguments& arguments, const CommonArguments& common) {
  const MotionPermit permit = permit_of(arguments);
  const Cell cell = cell_of(arguments);
  return move_to(cell, safe_position_of(cell, arguments.view), arguments, common, permit);
}

int unlock_action(const CellArguments& arguments, const CommonArguments& common) {
  const MotionPermit permit = permit_of(arguments);
  const Json result = unlock_robot(cell_of(arguments), permit);
  print_result(common, result, replies_text(result) + move_text(result));
  return exit_code(result);
}

int power_action(const CellArguments& arguments, const CommonArguments& common) {
  const MotionPermit permit = permit_of(arguments);
  const Json result = power_robot(cell_of(arguments), !arguments.is_off, permit);
  print_result(common, result, replies_text(result) + move_text(result));
  return exit_code(result);
}

std::string twins_text(const Json& ready) {
  std::string text = fmt::format("twins serve, process {}\n", ready["pid"].get<int>());
  for (const Json& twin : ready["twins"]) {
    text += fmt::format("  {} {}\n", twin["kind"].get<std::string>(), twin.dump());
  }
  return text;
}

int twin_stop(const CellArguments& arguments, const CommonArguments& common) {
  if (arguments.words.size() != 2) {
    throw ConfigError("glint cell twin stop: needs the file of --ready_file");
  }
  const Json result = stop_twins(arguments.words[1]);
  print_result(
      common,
      result,
      result["was_running"].get<bool>() ? "twins ended\n" : "the twins had ended already\n");
  return kExitDone;
}

int twin_place(const CellArguments& arguments, const CommonArguments& common) {
  const std::string number = arguments.words.size() == 3 ? arguments.words[2] : "";
  int placement = 0;
  const char* const end = number.data() + number.size();
  const auto [rest, error] = std::from_chars(number.data(), end, placement);
  if (number.empty() || error != std::errc() || rest != end || placement < 1) {
    throw ConfigError(
        "glint cell twin place: needs the file of --ready_file and the number of the placement, "
        "from "
        "1 on");
  }
  const Json result = place_in_twins(arguments.words[1], placement);
  print_result(
      common, result, fmt::format("the part has been put down: placement {}\n", placement));
  return kExitDone;
}

int twin_light(const CellArguments& arguments, const CommonArguments& common) {
  const std::string how = arguments.words.size() == 4 ? arguments.words[3] : "";
  if (how != "on" && how != "off") {
    throw ConfigError(
        "glint cell twin light: needs the file of --ready_file, the name of a light that a person "
        "switches, and on or off");
  }
  const std::string& light = arguments.words[2];
  const Json result = switch_light_in_twins(arguments.words[1], light, how == "on");
  print_result(common, result, fmt::format("light {} has been switched {}\n", light, how));
  return kExitDone;
}

ServingTwins twins_of(const std::string& kind,
                      const Cell& cell,
                      const CellArguments& arguments,
                      int threads) {
  if (kind == "both") {
    return both_twins_of(cell, arguments.port, arguments.has_cable, threads);
  }
  if (kind == "camera") {
    return camera_twin_of(
        cell, {.is_free = arguments.port == 0, .has_cable = arguments.has_cable}, threads);
  }
  ServingTwins twins;
  twins.push_back(robot_twin_of(cell, arguments.port));
  return twins;
}

/// @throws ConfigError for a port that no twin of this kind would listen at
void check_twin_port(const std::string& kind, const Cell& cell, const CellArguments& arguments) {
  if (kind == "camera" && arguments.port.value_or(0) != 0) {
    throw ConfigError(
        fmt::format("glint cell twin camera: --port {}: every camera listens at port 3956, each at "
                    "an address of its own; --port 0 takes a free address",
                    *arguments.port));
  }
  if (kind != "camera") {
    check_robot_twin_port(cell, arguments.port);
  }
}

int twin_action(const CellArguments& arguments, const CommonArguments& common) {
  if (!arguments.words.empty() && arguments.words[0] == "stop") {
    return twin_stop(arguments, common);
  }
  if (!arguments.words.empty() && arguments.words[0] == "place") {
    return twin_place(arguments, common);
  }
  if (!arguments.words.empty() && arguments.words[0] == "light") {
    return twin_light(arguments, common);
  }
  if (arguments.words.size() != 2) {
    throw ConfigError(
        "glint cell twin: needs camera, robot or both and the cell's file, or stop, place or light "
        "and a ready file");
  }
  const std::string& kind = arguments.words[0];
  if (kind != "camera" && kind != "robot" && kind != "both") {
    throw ConfigError(fmt::format(
        "glint cell twin {}: there are camera, robot, both, stop, place and light", kind));
  }
  const Cell cell = read_cell(arguments.words[1]);
  check_twin_port(kind, cell, arguments);
  serve_twins([&] { return twins_of(kind, cell, arguments, common.threads); },
              {.is_detached = arguments.is_detached, .ready_file = arguments.ready_file},
              [&common](const Json& ready) { print_result(common, ready, twins_text(ready)); });
  return kExitDone;
}

}  // namespace

std::span<const CellAction> cell_actions() {
  static constexpr std::array<CellAction, 9> kActions = {{
      {"list", false, list_action},
      {"grab", false, grab_action},
      {"status", false, status_action},
      {"watch", false, watch_action},
      {"move", true, move_action},
      {"safe", true, safe_action},
      {"unlock", true, unlock_action},
      {"power", true, power_action},
      {"twin", false, twin_action},
  }};
  return kActions;
}

std::filesystem::path the_word(const CellArguments& arguments, const std::string& what) {
  if (arguments.words.size() != 1) {
    throw ConfigError(fmt::format("glint cell {}: needs {}", arguments.action, what));
  }
  return arguments.words[0];
}

int cell_command(const CellArguments& arguments, const CommonArguments& common) {
  const std::span<const CellAction> actions = cell_actions();
  const auto action =
      std::ranges::find(actions, std::string_view(arguments.action), &CellAction::name);
  if (action == actions.end()) {
    std::string names;
    for (const CellAction& known : actions) {
      names += fmt::format("{}{}", names.empty() ? "" : ", ", known.name);
    }
    throw ConfigError(fmt::format("glint cell {}: there are {}", arguments.action, names));
  }
  if (action->may_move) {
    permit_of(arguments);  // before any file is read and any address is looked up
  }
  return action->run(arguments, common);
}

}  // namespace glint

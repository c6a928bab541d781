// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cell/cell_robot.h"

#include <algorithm>
#include <chrono>
#include <initializer_list>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/units.h"
#include "core/wall_clock.h"
#include "hardware/robot/dashboard.h"
#include "hardware/robot/protocol/dashboard_text.h"
#include "hardware/robot/ur_robot.h"
#include "studies/cell/ready_file.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDashboardS = 2.0;
constexpr double kStillS = 3.0;
constexpr double kPowerS = 30.0;
constexpr double kOldS = 1.0;  ///< of a state that tells nothing of now

Json numbers(const auto& vector, double factor) {
  Json list = Json::array();
  for (const double value : vector) {
    list.push_back(value * factor);
  }
  return list;
}

Json pose_json(const Eigen::Isometry3d& pose) {
  const JointVector six = pose_difference(pose, Eigen::Isometry3d::Identity());
  return {{"translation_mm", numbers(Eigen::Vector3d(six.head<3>()), 1.0)},
          {"rotation_vector_rad", numbers(Eigen::Vector3d(six.tail<3>()), 1.0)}};
}

Json state_json(const RobotState& state) {
  return {{"timestamp_s", state.timestamp_s},
          {"age_s", state.age_s},
          {"robot_mode", name_of(state.robot_mode)},
          {"safety_mode", name_of(state.safety_mode)},
          {"program", name_of(state.runtime_state)},
          {"speed_scaling", state.speed_scaling},
          {"joints_deg", numbers(state.actual_q_rad, kDegPerRad)},
          {"base_from_tcp", pose_json(state.base_from_tcp)},
          {"tool_speed_mm_s", state.tool_speed_mm_s},
          {"digital_outputs", state.digital_outputs}};
}

Json result_json(const MotionResult& result) {
  return {{"ok", result.is_done()}, {"outcome", name_of(result.outcome)}, {"text", result.text}};
}

Json still_json(const StillPose& pose) {
  return {{"timestamp_s", pose.timestamp_s},
          {"packages", pose.packages},
          {"joints_deg", numbers(pose.joints_rad, kDegPerRad)},
          {"base_from_tcp", pose_json(pose.base_from_tcp)}};
}

/// Asks, and says what went wrong instead of throwing: the rest of a status is of use without it.
std::string asked(Dashboard& dashboard, const char* query) {
  try {
    return value_of_reply(dashboard.ask(query));
  } catch (const IoError& error) {
    return error.what();
  }
}

Json dashboard_json(const UrSettings& settings) {
  try {
    Dashboard dashboard(settings.host, settings.dashboard_port, kDashboardS);
    Json json = {{"model", asked(dashboard, "get robot model")},
                 {"serial_number", asked(dashboard, "get serial number")},
                 {"program", asked(dashboard, "programState")}};
    if (!is_cb3(settings.model)) {
      json["remote_control"] = asked(dashboard, "is in remote control");
    }
    return json;
  } catch (const IoError& error) {
    return {{"error", error.what()}};
  }
}

JointVector joints_of(const CellPosition& position) {
  return Eigen::Map<const JointVector>(position.joints_rad.data());
}

/// Commands of the dashboard one after the other, until one fails.
Json command_all(const UrSettings& settings,
                 const std::vector<std::string>& commands,
                 const MotionPermit& permit) {
  Dashboard dashboard(settings.host, settings.dashboard_port, kDashboardS);
  Json json = {{"ok", true}, {"replies", Json::array()}};
  for (const std::string& command : commands) {
    const std::string reply = dashboard.command(command, permit);
    json["replies"].push_back({{"command", command}, {"reply", reply}});
    if (!is_success(reply)) {
      json["ok"] = false;
      return json;
    }
  }
  return json;
}

/// Waits for a mode of the robot, by states that are new.
/// @param is_on  a robot that is stopped is not waited for
/// @return done, or why it has not come
MotionResult wait_for(const UrRobot& robot, bool is_on, std::initializer_list<RobotMode> wanted) {
  using enum MotionOutcome;
  const auto start = std::chrono::steady_clock::now();
  while (seconds_since(start) < kPowerS) {
    const auto halted = robot.halted();
    if (halted && (is_on || halted->outcome == kLost)) {
      return *halted;
    }
    const RobotState state = robot.state().value();
    if (state.age_s > kOldS) {
      return {.outcome = kLost, .text = fmt::format("no new package for {:.1f} s", state.age_s)};
    }
    if (std::ranges::find(wanted, state.robot_mode) != wanted.end()) {
      return {.outcome = kDone, .text = ""};
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return {.outcome = kTimeout,
          .text = fmt::format(
              "robot mode {} after {:.0f} s", name_of(robot.state().value().robot_mode), kPowerS)};
}

/// @param replies  to the commands, one after the other
MotionResult change_power(const UrRobot& robot,
                          const UrSettings& settings,
                          bool is_on,
                          const MotionPermit& permit,
                          Json& replies) {
  using enum MotionOutcome;
  const auto send = [&](const char* command) -> MotionResult {
    const Json sent = command_all(settings, {command}, permit);
    const Json& reply = replies.emplace_back(sent["replies"][0]);
    return sent["ok"] == true ? MotionResult{.outcome = kDone, .text = ""}
                              : MotionResult{.outcome = kRefused, .text = reply["reply"]};
  };
  MotionResult result = send(is_on ? "power on" : "power off");
  if (result.is_done() && is_on) {
    result = wait_for(robot, is_on, {RobotMode::kIdle, RobotMode::kRunning});
  }
  if (result.is_done() && is_on) {
    result = send("brake release");
  }
  return result.is_done()
             ? wait_for(robot, is_on, {is_on ? RobotMode::kRunning : RobotMode::kPowerOff})
             : result;
}

/// What an arm that has arrived says of its standstill, or why nothing can be said of it.
Json standstill_json(UrRobot& robot, const ArmWithTool& arm, const UrSettings& settings) {
  if (const auto pose = robot.still_pose(kStillS)) {
    return {{"still", still_json(*pose)}};
  }
  MotionResult result = {.outcome = MotionOutcome::kTimeout,
                         .text = "the arm arrived, but does not stand still"};
  if (const auto halted = robot.halted()) {
    result = *halted;
  } else if (const std::string why = motion_refusal(robot.state().value(), arm, settings);
             !why.empty()) {
    result.text += ": " + why;
  }
  Json json = result_json(result);
  json["still"] = nullptr;
  return json;
}

/// Waits until a protective stop that the dashboard has released is gone.
/// @return done, or what the robot is stopped by
MotionResult wait_for_release(const UrRobot& robot) {
  using enum MotionOutcome;
  constexpr double kReleaseS = 5.0;
  const auto start = std::chrono::steady_clock::now();
  RobotState state = robot.state().value();
  while (state.safety_mode == SafetyMode::kProtectiveStop && seconds_since(start) < kReleaseS) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    state = robot.state().value();
  }
  if (state.age_s > kOldS) {
    return {.outcome = kLost, .text = fmt::format("no new package for {:.1f} s", state.age_s)};
  }
  const MotionOutcome outcome = stop_of(state.safety_mode);
  return {
      .outcome = outcome,
      .text = outcome == kDone ? "" : fmt::format("safety mode {}", name_of(state.safety_mode))};
}

/// Why the controller would take no script for what it says on its dashboard; empty: it would.
std::string script_refusal(const Json& dashboard) {
  if (dashboard.contains("error")) {
    return dashboard["error"].get<std::string>();
  }
  if (!dashboard.contains("remote_control")) {
    return {};
  }
  return remote_control_problem(dashboard["remote_control"].get<std::string>());
}

Json head_json(const Cell& cell, bool is_twin) {
  return {{"schema", 1}, {"cell", cell.file.string()}, {"twin", is_twin}};
}

}  // namespace

Json robot_status(const Cell& cell) {
  const UrSettings& settings = robot_of(cell);
  const bool is_twin = is_robot_twin(cell);
  const ArmWithTool arm = arm_with_tool(settings, cell.limits);
  const UrRobot robot(settings, arm);
  const RobotState state = *robot.state();
  Json json = head_json(cell, is_twin);
  json["status"] = "done";
  json["ok"] = true;
  json["controller"] = robot.controller().text();
  json["rate_hz"] = robot.rate_hz();
  json["robot"] = state_json(state);
  json["dashboard"] = dashboard_json(settings);
  std::string refusal = motion_refusal(state, arm, settings);
  if (refusal.empty() && !is_cb3(settings.model)) {
    refusal = script_refusal(json["dashboard"]);
  }
  json["movable"] = refusal.empty();
  json["not_movable_because"] = refusal;
  json["outside_box"] = outside_box(arm, state.actual_q_rad, 0.0);
  return json;
}

Json watch_robot(const Cell& cell,
                 double duration_s,
                 double every_s,
                 const std::function<bool(const Json&)>& tell) {
  const UrSettings& settings = robot_of(cell);
  const bool is_twin = is_robot_twin(cell);
  const UrRobot robot(settings, arm_with_tool(settings, cell.limits));
  const auto start = std::chrono::steady_clock::now();
  int count = 0;
  while (tell(state_json(*robot.state()))) {
    ++count;
    if (robot.halted() || seconds_since(start) >= duration_s) {
      break;
    }
    std::this_thread::sleep_for(std::chrono::duration<double>(every_s));
  }
  Json json = head_json(cell, is_twin);
  const auto halted = robot.halted();
  json["status"] = "done";
  json["ok"] = !halted.has_value();
  json["states"] = count;
  json["packages"] = robot.num_packages();
  json["outcome"] = halted ? name_of(halted->outcome) : "done";
  json["text"] = halted ? halted->text : "";
  return json;
}

Json move_robot(const Cell& cell,
                const CellPosition& position,
                const CellMotion& motion,
                const MotionPermit& permit) {
  const UrSettings& settings = robot_of(cell);
  const bool is_twin = is_robot_twin(cell);
  const ArmWithTool arm = arm_with_tool(settings, cell.limits);
  const JointVector goal_rad = joints_of(position);
  UrRobot robot(settings, arm);
  if (motion.interrupt != nullptr) {
    robot.set_interrupt(*motion.interrupt);
  }
  robot.allow_motion(permit);
  const auto start = std::chrono::steady_clock::now();
  const MotionResult result = motion.is_line
                                  ? robot.move_line(arm.base_from_tcp(goal_rad), motion.share)
                                  : robot.move_joints(goal_rad, motion.share);
  const bool is_interrupted =
      !result.is_done() && motion.interrupt != nullptr && *motion.interrupt > 0;
  Json json = head_json(cell, is_twin);
  json["status"] = is_interrupted ? "interrupted" : "done";
  json.update(result_json(result));
  json["position"] = position.name;
  json["duration_s"] = seconds_since(start);
  if (result.is_done()) {
    json.update(standstill_json(robot, arm, settings));
  }
  return json;
}

Json unlock_robot(const Cell& cell, const MotionPermit& permit) {
  const UrSettings& settings = robot_of(cell);
  Json json = head_json(cell, is_robot_twin(cell));
  const UrRobot robot(settings, arm_with_tool(settings, cell.limits));
  json["status"] = "done";
  const SafetyMode mode = robot.state().value().safety_mode;
  MotionResult result = {
      .outcome = MotionOutcome::kRefused,
      .text = fmt::format("there is no protective stop to release: safety mode {}", name_of(mode))};
  Json sent = {{"replies", Json::array()}};
  if (mode == SafetyMode::kProtectiveStop) {
    sent = command_all(settings, {"close safety popup", "unlock protective stop"}, permit);
    result.text = sent["replies"].back()["reply"].get<std::string>();
    result = sent["ok"] == true ? wait_for_release(robot) : result;
  }
  json.update(result_json(result));
  json["replies"] = sent["replies"];
  return json;
}

Json power_robot(const Cell& cell, bool is_on, const MotionPermit& permit) {
  const UrSettings& settings = robot_of(cell);
  Json json = head_json(cell, is_robot_twin(cell));
  const UrRobot robot(settings, arm_with_tool(settings, cell.limits));
  Json replies = Json::array();
  json["status"] = "done";
  json.update(result_json(change_power(robot, settings, is_on, permit, replies)));
  json["replies"] = replies;
  json["robot"] = state_json(*robot.state());
  return json;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/ur_settings.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace glint {
namespace {

/// Where controllers run what they are sent: primary, secondary, real-time, interpreter.
constexpr std::array<int, 4> kScriptPorts = {30001, 30002, 30003, 30020};

}  // namespace

bool takes_scripts(int port) {
  return std::ranges::find(kScriptPorts, port) != kScriptPorts.end();
}

std::optional<WrongPort> wrong_port(const UrSettings& settings) {
  for (const auto& [key, port] : {std::pair("rtde_port", settings.rtde_port),
                                  std::pair("dashboard_port", settings.dashboard_port)}) {
    if (takes_scripts(port)) {
      return WrongPort{.key = key,
                       .text = fmt::format("is {}, where controllers take programs; what only asks "
                                           "is written to this port, too",
                                           port)};
    }
    if (port == settings.primary_port || port == settings.secondary_port) {
      return WrongPort{.key = key,
                       .text = fmt::format("is {}, as primary_port or secondary_port, which take "
                                           "programs; must be another one",
                                           port)};
    }
  }
  if (settings.rtde_port == settings.dashboard_port) {
    return WrongPort{
        .key = "dashboard_port",
        .text = fmt::format("is {}, as rtde_port; must be another one", settings.dashboard_port)};
  }
  return std::nullopt;
}

void visit_keys(KeyVisitor& keys, UrSettings& settings) {
  const Range port = Range::between(1, 65535);
  keys.choice("model", settings.model, kArmModels, "the arm");
  keys.text("host", settings.host, "name or address of the controller");
  keys.integer("rtde_port", settings.rtde_port, port, "of RTDE");
  keys.integer("primary_port", settings.primary_port, port, "that scripts are sent to");
  keys.integer("secondary_port", settings.secondary_port, port, "of the secondary interface");
  keys.integer("dashboard_port", settings.dashboard_port, port, "of the dashboard server");
  keys.file("arm_deltas", settings.arm_deltas, "TOML file with the arm's calibration");
  keys.numbers("flange_from_tcp",
               settings.flange_from_tcp,
               {.min = 6, .max = 6},
               Range::between(-2000, 2000),
               "the pendant's TCP: x y z in mm, rotation vector in rad");
  keys.number("tool_radius_mm",
              settings.tool_radius_mm,
              Range::between(0, 500),
              "room that the tool takes about the line from the flange to its tip");
  keys.number("payload_kg", settings.payload_kg, Range::between(0, 20), "the pendant's payload");
  keys.numbers("payload_cog_mm",
               settings.payload_cog_mm,
               {.min = 3, .max = 3},
               Range::between(-1000, 1000),
               "the pendant's centre of gravity");
  keys.integer("ack_register",
               settings.ack_register,
               Range::between(0, 23),
               "output_int_register that scripts write when they begin and end");
  for (const std::string_view key :
       {"model", "host", "flange_from_tcp", "tool_radius_mm", "payload_kg"}) {
    keys.require(keys.is_given(key), key, "is missing");
  }
  keys.require(!keys.is_given("host") || !settings.host.empty(), "host", "must not be empty");
  if (const auto wrong = wrong_port(settings)) {
    keys.require(false, wrong->key, wrong->text);
  }
}

Eigen::Isometry3d pose_of_six(const std::vector<double>& six) {
  GLINT_CHECK(six.size() == 6, "a pose of six numbers");
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d(six[0], six[1], six[2]);
  const Eigen::Vector3d turn(six[3], six[4], six[5]);
  if (turn.norm() != 0.0) {  // what is no number gives a pose that is none
    pose.linear() = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
  }
  return pose;
}

ArmWithTool arm_with_tool(const UrSettings& settings, const MotionLimits& limits) {
  ArmDeltas deltas;
  if (!settings.arm_deltas.empty()) {
    deltas = read_arm_deltas(settings.arm_deltas);
    if (deltas.model != settings.model) {
      throw ConfigError(fmt::format("{}: arm_deltas.model: is that of another arm, must be {}",
                                    settings.arm_deltas.string(),
                                    kArmModels.at(static_cast<std::size_t>(settings.model))));
    }
  }
  return {.arm = Arm(settings.model, deltas),
          .flange_from_tcp = pose_of_six(settings.flange_from_tcp),
          .tool_radius_mm = settings.tool_radius_mm,
          .limits = limits};
}

}  // namespace glint

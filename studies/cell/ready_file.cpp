// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cell/ready_file.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "hardware/robot/twin_proof.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

bool is_twin_object(const Json& twin) {
  return twin.is_object() && twin.contains("kind") && twin["kind"].is_string();
}

/// A twin as one file describes it.
class ReadyTwin {
 public:
  ReadyTwin(const std::filesystem::path& file, const Json& twin) : file_(file), twin_(twin) {}

  [[noreturn]] void refuse(std::string_view key, const std::string& why) const {
    throw ConfigError(fmt::format(
        "{}: {} of the twin \"{}\": {}", file_.string(), key, twin_.value("kind", ""), why));
  }

  std::string text(const std::string& key) const {
    if (!twin_.contains(key) || !twin_[key].is_string()) {
      refuse(key, "must be a text");
    }
    return twin_[key].get<std::string>();
  }

  int port(const std::string& key) const {
    const bool is_number = twin_.contains(key) && twin_[key].is_number_unsigned();
    const std::uint64_t port = is_number ? twin_[key].get<std::uint64_t>() : 0;
    if (port < 1 || port > 65535) {
      refuse(key, "must be a port, from 1 to 65535");
    }
    return static_cast<int>(port);
  }

  /// The number by which a twin is told from one that took its port later.
  std::uint64_t token() const {
    if (!twin_.contains("token") || !twin_["token"].is_number_unsigned()) {
      refuse("token", "must be the number that the twin was given when it began to serve");
    }
    return twin_["token"].get<std::uint64_t>();
  }

  std::string address() const {
    constexpr std::uint32_t kLoopback = 127;
    std::string address = text("address");
    in_addr number = {};
    if (::inet_pton(AF_INET, address.c_str(), &number) != 1 ||
        ntohl(number.s_addr) >> 24U != kLoopback) {
      refuse("address", fmt::format("is {}, twins of Glint serve 127.0.0.0/8 alone", address));
    }
    return address;
  }

 private:
  const std::filesystem::path& file_;
  const Json& twin_;
};

void take_robot(const ReadyTwin& twin, UrSettings& robot) {
  robot.host = twin.address();
  robot.rtde_port = twin.port("rtde_port");
  robot.primary_port = twin.port("primary_port");
  robot.secondary_port = twin.port("secondary_port");
  robot.dashboard_port = twin.port("dashboard_port");
  if (const auto wrong = wrong_port(robot)) {
    twin.refuse(wrong->key, wrong->text);
  }
}

void take_camera(const ReadyTwin& twin, CellCamera& camera) {
  camera.address = twin.address();
}

void take_stage(const ReadyTwin& twin, CellStage& stage) {
  stage.host = twin.address();
  stage.device.clear();
  stage.port = twin.port("port");
}

/// A ready file, and the devices of a cell that are taken to its twins.
class TwinsOfFile {
 public:
  explicit TwinsOfFile(const std::filesystem::path& file) : file_(file), ready_(read_ready(file)) {}

  std::optional<std::uint64_t> robot_token() const {
    const Json* robot = twin_of_kind(ready_, "robot");
    return robot == nullptr ? std::nullopt : std::optional(ReadyTwin(file_, *robot).token());
  }

  /// @param is_driven  else a device without a twin is left out
  template <class Device>
  void take(std::string_view kind,
            bool is_driven,
            void (*take_device)(const ReadyTwin&, Device&),
            std::optional<Device>& device) const {
    if (!device) {
      return;
    }
    const Json* twin = twin_of_kind(ready_, kind);
    if (twin != nullptr) {
      take_device({file_, *twin}, *device);
    } else if (is_driven) {
      throw ConfigError(
          fmt::format("{}: has no twin of the cell's {}; with --twin nothing but twins is driven: "
                      "glint cell twin both serves robot, camera and linear stage",
                      file_.string(),
                      kind));
    } else {
      device.reset();
    }
  }

 private:
  const std::filesystem::path& file_;
  Json ready_;
};

}  // namespace

Json read_ready(const std::filesystem::path& file) {
  Json json = Json::parse(read_file(file), nullptr, false);
  if (!json.is_object() || !json.contains("pid") || !json.contains("twins") ||
      !json["pid"].is_number_integer() || !json["twins"].is_array() ||
      !std::ranges::all_of(json["twins"], is_twin_object)) {
    throw ConfigError(fmt::format("{}: is no ready file of twins", file.string()));
  }
  return json;
}

const Json* twin_of_kind(const Json& ready, std::string_view kind) {
  for (const Json& twin : ready["twins"]) {
    if (twin.value("kind", "") == kind) {
      return &twin;
    }
  }
  return nullptr;
}

std::filesystem::path side_channel_in(const std::filesystem::path& file, const Json& twin) {
  return ReadyTwin(file, twin).text("side_channel");
}

Cell with_ports(Cell cell, const std::filesystem::path& ready_file, DrivenDevices driven) {
  const TwinsOfFile twins(ready_file);
  const bool is_all = driven == DrivenDevices::kAll;
  twins.take("robot", is_all || driven == DrivenDevices::kRobot, take_robot, cell.robot);
  twins.take("camera", is_all || driven == DrivenDevices::kCamera, take_camera, cell.camera);
  if (cell.stage && cell.stage->kind == CellStage::Kind::kGrbl) {  // the others move nothing
    twins.take("stage", is_all, take_stage, cell.stage);
  }
  if (cell.robot) {
    cell.twin_token = twins.robot_token();
  }
  cell.twins = ready_file;
  return cell;
}

bool is_robot_twin(const Cell& cell) {
  constexpr int kTries = 3;  // of a twin on a busy machine, whose proof may be late
  const UrSettings& robot = robot_of(cell);
  const bool must_be_twin = !cell.twins.empty();
  std::optional<std::uint64_t> token;
  for (int i = 0; !token && i < (must_be_twin ? kTries : 1); ++i) {
    token = proven_token(robot.host, robot.rtde_port);
  }
  if (must_be_twin && (!token || token != cell.twin_token)) {
    throw IoError(fmt::format(
        "{}: what is at {}:{} {}; with --twin nothing else is driven, and nothing was sent to it "
        "that moves or changes it",
        cell.twins.string(),
        robot.host,
        robot.rtde_port,
        token ? "is another twin than the file's: its token differs"
              : "does not prove that it is a twin of yours"));
  }
  return token.has_value();
}

}  // namespace glint

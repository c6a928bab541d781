// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cell/ready_file.h"

#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "hardware/robot/twin_proof.h"
#include "hardware/twin/side_channel/side_channel.h"

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

  /// @param is_driven  else a device without a twin is left out
  /// @return the twin's token; none: the cell has no such device, or it is left out
  template <class Device>
  std::optional<std::uint64_t> take(std::string_view kind,
                                    bool is_driven,
                                    void (*take_device)(const ReadyTwin&, Device&),
                                    std::optional<Device>& device) const {
    if (!device) {
      return std::nullopt;
    }
    if (const Json* twin = twin_of_kind(ready_, kind)) {
      const ReadyTwin described(file_, *twin);
      take_device(described, *device);
      return described.token();
    }
    if (is_driven) {
      throw ConfigError(
          fmt::format("{}: has no twin of the cell's {}; with --twin nothing but twins is driven: "
                      "glint cell twin both serves robot, camera and linear stage",
                      file_.string(),
                      kind));
    }
    device.reset();
    return std::nullopt;
  }

 private:
  const std::filesystem::path& file_;
  Json ready_;
};

/// The text that a stage's controller keeps, where the side channel at its port tells the same.
std::optional<std::string> proven_stage_token(const CellStage& stage) {
  constexpr std::chrono::milliseconds kConnect{1000};
  const auto told = ask_side_channel(stage_twin_socket(stage.port), "token");
  try {
    TextLink link = TextLink::tcp(stage.host, stage.port, kConnect);
    return told && kept_text(link) == *told ? told : std::nullopt;
  } catch (const IoError&) {
    return std::nullopt;
  }
}

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

std::uint64_t token_in(const std::filesystem::path& file, const Json& twin) {
  return ReadyTwin(file, twin).token();
}

Cell with_ports(Cell cell, const std::filesystem::path& ready_file, DrivenDevices driven) {
  const TwinsOfFile twins(ready_file);
  const bool is_all = driven == DrivenDevices::kAll;
  cell.twin_tokens.robot =
      twins.take("robot", is_all || driven == DrivenDevices::kRobot, take_robot, cell.robot);
  cell.twin_tokens.camera =
      twins.take("camera", is_all || driven == DrivenDevices::kCamera, take_camera, cell.camera);
  if (cell.stage && cell.stage->kind == CellStage::Kind::kGrbl) {  // the others move nothing
    cell.twin_tokens.stage = twins.take("stage", is_all, take_stage, cell.stage);
  }
  cell.twins = ready_file;
  return cell;
}

void check_twin_token(const Cell& cell,
                      const std::string& place,
                      std::optional<std::uint64_t> token,
                      const std::function<std::optional<std::string>()>& prove) {
  constexpr int kTries = 3;  // of a twin on a busy machine, whose proof may be late
  std::optional<std::string> proven;
  for (int i = 0; !proven && i < kTries; ++i) {
    proven = prove();
  }
  if (!token || proven != std::to_string(*token)) {
    throw IoError(fmt::format(
        "{}: what is at {} {}; with --twin nothing else is driven, and nothing was sent to it "
        "that moves or changes it",
        cell.twins.string(),
        place,
        proven ? "is another twin than the file's: its token differs"
               : "does not prove that it is a twin of yours"));
  }
}

bool is_robot_twin(const Cell& cell) {
  const UrSettings& robot = robot_of(cell);
  const auto prove = [&robot] {
    const auto token = proven_token(robot.host, robot.rtde_port);
    return token ? std::optional(std::to_string(*token)) : std::nullopt;
  };
  if (cell.twins.empty()) {
    return prove().has_value();
  }
  check_twin_token(
      cell, fmt::format("{}:{}", robot.host, robot.rtde_port), cell.twin_tokens.robot, prove);
  return true;
}

void check_stage_twin(const Cell& cell) {
  if (cell.twins.empty() || !cell.stage || cell.stage->kind != CellStage::Kind::kGrbl) {
    return;
  }
  const CellStage& stage = *cell.stage;
  check_twin_token(
      cell, fmt::format("{}:{}", stage.host, stage.port), cell.twin_tokens.stage, [&stage] {
        return proven_stage_token(stage);
      });
}

}  // namespace glint

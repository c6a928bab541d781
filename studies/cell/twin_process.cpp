// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cell/twin_process.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <future>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/wall_clock.h"
#include "hardware/robot/twin_proof.h"
#include "studies/cell/ready_file.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kReadyS = 60.0;
constexpr double kEndS = 10.0;
constexpr auto kLongestEnd = std::chrono::seconds(3);
constexpr auto kPoll = std::chrono::milliseconds(20);

std::atomic<bool> interrupted = false;

void on_signal(int) {
  interrupted = true;
}

class RobotTwin final : public ServingTwin {
 public:
  explicit RobotTwin(TwinServerSettings settings) : server_(std::move(settings)) {}

  Json description() const override { return robot_twin_description(server_); }

  bool has_ended() const override { return server_.is_stop_asked(); }

 private:
  TwinServer server_;
};

/// A twin ends when it is destroyed. What still renders a picture then is not waited for: the
/// process ends.
void end_twins(ServingTwins twins, const std::filesystem::path& ready_file) {
  std::packaged_task<void()> task([ending = std::move(twins)]() mutable { ending.clear(); });
  const std::future<void> ended = task.get_future();
  std::thread(std::move(task)).detach();
  if (ended.wait_for(kLongestEnd) == std::future_status::ready) {
    return;
  }
  std::error_code ignored;
  std::filesystem::remove(ready_file, ignored);
  std::fflush(nullptr);
  std::_Exit(0);
}

/// Serves in this process. @return the ready file's object
Json serve_here(const std::function<ServingTwins()>& make,
                const std::filesystem::path& ready_file,
                const std::function<void(const Json&)>& tell) {
  interrupted = false;
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  ServingTwins twins = make();
  Json ready = {{"schema", 1}, {"status", "done"}, {"pid", ::getpid()}, {"twins", Json::array()}};
  for (const auto& twin : twins) {
    ready["twins"].push_back(twin->description());
  }
  if (!ready_file.empty()) {
    write_file(ready_file, ready.dump(2) + "\n");
  }
  tell(ready);
  const auto is_over = [&twins] {
    return interrupted ||
           std::ranges::any_of(twins, [](const auto& twin) { return twin->has_ended(); });
  };
  while (!is_over()) {
    std::this_thread::sleep_for(kPoll);
  }
  end_twins(std::move(twins), ready_file);
  return ready;
}

/// In the child: no terminal, no output; what goes wrong is left where the parent looks for it.
[[noreturn]] void serve_as_child(const std::function<ServingTwins()>& make,
                                 const std::filesystem::path& ready_file,
                                 const std::filesystem::path& error_file) {
  int code = 0;
  ::setsid();
  const bool has_no_terminal = std::freopen("/dev/null", "r", stdin) != nullptr &&
                               std::freopen("/dev/null", "w", stdout) != nullptr &&
                               std::freopen("/dev/null", "w", stderr) != nullptr;
  try {
    if (!has_no_terminal) {
      throw IoError("/dev/null: " + last_system_error());
    }
    serve_here(make, ready_file, [](const Json&) {});
  } catch (const std::exception& error) {
    code = 1;
    try {
      write_file(error_file, error.what());
    } catch (const std::exception&) {
      code = 2;
    }
  }
  std::error_code ignored;
  std::filesystem::remove(ready_file, ignored);
  std::_Exit(code);
}

/// Where twins serve in the foreground, the ready file of earlier ones may be written anew; every
/// other file is the user's.
void check_ready_file(const std::filesystem::path& file) {
  if (file.empty() || !is_there(file)) {
    return;
  }
  try {
    read_ready(file);
  } catch (const ConfigError&) {
    throw ConfigError(fmt::format(
        "{}: exists and is no ready file of twins; give --ready_file another name", file.string()));
  }
}

Json wait_until_ready(pid_t child,
                      const std::filesystem::path& ready_file,
                      const std::filesystem::path& error_file) {
  const auto start = std::chrono::steady_clock::now();
  while (seconds_since(start) < kReadyS) {
    if (std::filesystem::exists(ready_file)) {
      return read_ready(ready_file);
    }
    int status = 0;
    if (::waitpid(child, &status, WNOHANG) == child) {
      std::string why = "the twins ended before they were ready";
      if (std::filesystem::exists(error_file)) {
        why = read_file(error_file);
        std::filesystem::remove(error_file);
      }
      throw IoError(why);
    }
    std::this_thread::sleep_for(kPoll);
  }
  ::kill(child, SIGTERM);
  throw IoError(fmt::format("the twins were not ready within {:.0f} s", kReadyS));
}

bool is_alive(pid_t pid) {
  return ::kill(pid, 0) == 0 || errno == EPERM;
}

/// Tells one twin to end. @return it was there, and the same
bool tell_to_stop(const Json& twin) {
  if (!twin.contains("side_channel") || !twin["side_channel"].is_string() ||
      !twin.contains("token") || !twin["token"].is_number_unsigned()) {
    return false;
  }
  const std::filesystem::path socket = twin["side_channel"].get<std::string>();
  const auto token = ask_side_channel(socket, "token");
  return token && *token == fmt::format("{}", twin["token"].get<std::uint64_t>()) &&
         ask_side_channel(socket, "stop").has_value();
}

/// @throws IoError when the camera's twin does not answer ok
void tell_camera_twin(const std::filesystem::path& ready_file, const std::string& line) {
  const Json ready = read_ready(ready_file);
  const Json* camera = twin_of_kind(ready, "camera");
  if (camera == nullptr) {
    throw ConfigError(fmt::format("{}: has no twin of a camera", ready_file.string()));
  }
  const std::filesystem::path socket = side_channel_in(ready_file, *camera);
  const std::string token = std::to_string(token_in(ready_file, *camera));
  if (ask_side_channel(socket, "token").value_or(token) != token) {
    throw IoError(fmt::format("{}: another twin of a camera has the address of the file's",
                              ready_file.string()));
  }
  const auto reply = ask_side_channel(socket, line);
  if (reply.value_or("") != "ok") {
    throw IoError(fmt::format(
        "{}: the twin of the camera says {}", ready_file.string(), reply.value_or("nothing")));
  }
}

TwinPorts ports_of_twin(const UrSettings& robot, std::optional<int> port) {
  if (!port) {
    return {.rtde = robot.rtde_port,
            .primary = robot.primary_port,
            .secondary = robot.secondary_port,
            .dashboard = robot.dashboard_port};
  }
  const auto at = [&port](int offset) { return *port == 0 ? 0 : *port + offset; };
  return {.rtde = at(0), .primary = at(1), .secondary = at(2), .dashboard = at(3)};
}

}  // namespace

Json robot_twin_description(const TwinServer& server) {
  const TwinPorts& ports = server.ports();
  return {{"kind", "robot"},
          {"address", "127.0.0.1"},
          {"rtde_port", ports.rtde},
          {"primary_port", ports.primary},
          {"secondary_port", ports.secondary},
          {"dashboard_port", ports.dashboard},
          {"side_channel", server.side_channel().string()},
          {"token", server.token()}};
}

Json serve_twins(const std::function<ServingTwins()>& make,
                 const TwinProcessOptions& options,
                 const std::function<void(const Json&)>& tell) {
  if (!options.is_detached) {
    check_ready_file(options.ready_file);
    Json ready = serve_here(make, options.ready_file, tell);
    std::error_code ignored;
    std::filesystem::remove(options.ready_file, ignored);
    return ready;
  }
  if (options.ready_file.empty()) {
    throw ConfigError("--detach needs --ready_file, which glint cell twin stop ends them by");
  }
  if (std::filesystem::exists(options.ready_file)) {
    throw ConfigError(fmt::format(
        "{}: is there already; glint cell twin stop ends the twins it names, or remove the file",
        options.ready_file.string()));
  }
  if (options.ready_file.has_parent_path()) {
    make_folder(options.ready_file.parent_path());
  }
  const std::filesystem::path error_file = options.ready_file.string() + ".error";
  const pid_t child = ::fork();
  if (child < 0) {
    throw IoError("no process for the twins: " + last_system_error());
  }
  if (child == 0) {
    serve_as_child(make, options.ready_file, error_file);
  }
  Json ready = wait_until_ready(child, options.ready_file, error_file);
  tell(ready);
  return ready;
}

Json stop_twins(const std::filesystem::path& ready_file) {
  const Json ready = read_ready(ready_file);
  const auto pid = ready["pid"].get<pid_t>();
  bool was_told = false;
  for (const Json& twin : ready["twins"]) {
    was_told = tell_to_stop(twin) || was_told;
  }
  const auto start = std::chrono::steady_clock::now();
  while (was_told && is_alive(pid) && seconds_since(start) < kEndS) {
    std::this_thread::sleep_for(kPoll);
  }
  if (was_told && is_alive(pid)) {
    throw IoError(fmt::format("the twins (process {}) do not end", pid));
  }
  std::error_code ignored;
  std::filesystem::remove(ready_file, ignored);
  return {{"schema", 1}, {"status", "done"}, {"pid", pid}, {"was_running", was_told}};
}

Json place_in_twins(const std::filesystem::path& ready_file, int placement) {
  tell_camera_twin(ready_file, fmt::format("placement {}", placement));
  return {{"schema", 1}, {"status", "done"}, {"placement", placement}};
}

Json switch_light_in_twins(const std::filesystem::path& ready_file,
                           const std::string& light,
                           bool is_on) {
  tell_camera_twin(ready_file, fmt::format("light {} {}", light, is_on ? "on" : "off"));
  return {{"schema", 1}, {"status", "done"}, {"light", light}, {"on", is_on}};
}

void check_robot_twin_port(const Cell& cell, std::optional<int> port) {
  if (!cell.robot || port.value_or(0) == 0) {
    return;
  }
  const TwinPorts ports = ports_of_twin(*cell.robot, port);
  UrSettings served = *cell.robot;
  served.rtde_port = ports.rtde;
  served.primary_port = ports.primary;
  served.secondary_port = ports.secondary;
  served.dashboard_port = ports.dashboard;
  if (const auto wrong = wrong_port(served)) {
    throw ConfigError(fmt::format(
        "--port {}: {} of the robot's twin {}", *port, std::string(wrong->key), wrong->text));
  }
}

TwinServerSettings robot_twin_settings(const Cell& cell, std::optional<int> port) {
  const UrSettings& robot = robot_of(cell);
  const ArmWithTool arm = arm_with_tool(robot, cell.limits);
  const CellPosition& start = safe_position_of(cell, "");
  return {
      .twin = {.arm = arm.arm,
               .start_rad = Eigen::Map<const JointVector>(start.joints_rad.data()),
               .flange_from_tcp = arm.flange_from_tcp,
               .payload_kg = robot.payload_kg,
               .payload_cog_mm = Eigen::Map<const Eigen::Vector3d>(robot.payload_cog_mm.data())},
      .address = "127.0.0.1",
      .ports = ports_of_twin(robot, port),
      .speedup = cell.motion_speedup};
}

std::unique_ptr<ServingTwin> robot_twin_of(const Cell& cell, std::optional<int> port) {
  return std::make_unique<RobotTwin>(robot_twin_settings(cell, port));
}

}  // namespace glint

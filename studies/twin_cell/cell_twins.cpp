// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/twin_cell/cell_twins.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/thread_pool.h"
#include "hardware/gige/udp_socket.h"
#include "hardware/twin/camera/camera_twin.h"
#include "hardware/twin/robot/twin_server.h"
#include "hardware/twin/side_channel/side_channel.h"
#include "studies/twin_cell/cell_pictures.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using std::chrono::milliseconds;

constexpr milliseconds kBetweenLooks{4};

RigidTransform transform_of(const Eigen::Isometry3d& pose) {
  return {.rotation = pose.linear(), .translation_mm = pose.translation()};
}

/// What is on when the controller's outputs are so.
std::vector<std::string> lights_on(const Cell& cell, std::uint64_t outputs) {
  std::vector<std::string> names;
  for (const CellLight& light : cell.lights) {
    const bool is_manual = light.kind == CellLight::Kind::kManual;
    if (is_manual || ((outputs >> static_cast<unsigned>(light.output)) & 1U) != 0) {
      names.push_back(light.name);
    }
  }
  return names;
}

std::vector<std::string> all_lights(const Cell& cell) {
  std::vector<std::string> names;
  std::ranges::transform(cell.lights, std::back_inserter(names), &CellLight::name);
  return names;
}

/// Where the camera of a cell without a robot stands: the flange that shows the scene as the
/// scene's own viewpoint does.
CellState state_at_viewpoint(const Cell& cell, const Truth& truth) {
  const RigidTransform camera_from_scene = camera_from_world(truth.scene.viewpoint());
  return {.base_from_flange = truth.base_from_scene() * inverse(camera_from_scene) *
                              inverse(truth.flange_from_camera()),
          .lights = all_lights(cell)};
}

/// The camera's twin with its renderer; with a robot, what follows it.
class CameraServing final : public ServingTwin {
 public:
  CameraServing(const Cell& cell,
                const Truth& truth,
                std::uint32_t address,
                const CellState& state,
                int threads)
      : token_(fresh_token() % 1'000'000'000'000'000),
        pool_(threads),
        renderer_(truth, pool_),
        pictures_(renderer_, state),
        camera_({.address = address,
                 .serial = "TWIN-" + cell.file.parent_path().filename().string().substr(0, 10),
                 .user_name = std::to_string(token_),
                 .sensor_width_px = renderer_.width_px(),
                 .sensor_height_px = renderer_.height_px()},
                pictures_),
        address_(ipv4_text(address)),
        side_(camera_twin_socket(address_),
              [this](const std::string& line) { return answer(line); }) {}

  Json description() const override {
    return {{"kind", "camera"},
            {"address", address_},
            {"port", kGvcpPort},
            {"side_channel", side_.path().string()},
            {"token", token_}};
  }

  bool has_ended() const override { return is_stop_asked_; }

  CellPictures& pictures() { return pictures_; }

 private:
  /// "token", "state", "stop".
  std::string answer(const std::string& line) {
    if (line == "token") {
      return std::to_string(token_);
    }
    if (line == "stop") {
      is_stop_asked_ = true;
      return "ok";
    }
    if (line == "state") {
      const CameraTwinCounts counts = camera_.counts();
      return Json{{"frames", counts.frames},
                  {"refused", counts.refused},
                  {"last_refusal", name_of(counts.last_refusal)},
                  {"resent_packets", counts.resent_packets},
                  {"rendered", pictures_.num_rendered()},
                  {"error", pictures_.error()}}
          .dump();
    }
    return "error: there are token, state, stop";
  }

  std::uint64_t token_ = 0;  ///< the camera tells it as the name that a user gave it: 15 digits
  std::atomic<bool> is_stop_asked_ = false;
  ThreadPool pool_;
  CellRenderer renderer_;
  CellPictures pictures_;
  CameraTwin camera_;
  std::string address_;
  SideChannel side_;
};

/// Tells the camera's pictures where the arm is, and holds the arm until the picture of its goal is
/// finished.
class Follower {
 public:
  Follower(const Cell& cell, TwinServer& robot, CellPictures& pictures)
      : cell_(cell),
        arm_(arm_with_tool(robot_of(cell), cell.limits).arm),
        robot_(robot),
        pictures_(pictures),
        thread_([this](const std::stop_token& stop) {
          while (!stop.stop_requested()) {
            look();
            std::this_thread::sleep_for(kBetweenLooks);
          }
        }) {}

  CellState state_of(const JointVector& joints_rad, std::uint64_t outputs) const {
    return {.base_from_flange = transform_of(arm_.forward(joints_rad)),
            .lights = lights_on(cell_, outputs)};
  }

 private:
  void look() {
    const TwinView view = robot_.view();
    if (view.is_still) {
      const std::string key = key_of(state_of(view.joints_rad, view.digital_outputs));
      if (was_moving_ || key != key_) {
        pictures_.arrive(state_of(view.joints_rad, view.digital_outputs));
        key_ = key;
        was_moving_ = false;
      }
      return;
    }
    pictures_.leave();
    was_moving_ = true;
    if (!view.goal_rad) {
      return;  // along a line: it is rendered for when the arm arrives
    }
    const CellState goal = state_of(*view.goal_rad, view.digital_outputs);
    if (key_of(goal) != announced_) {
      announced_ = key_of(goal);
      robot_.hold_motion(true);
      pictures_.announce(goal);
      pictures_.wait_until_finished(milliseconds(120'000));
      robot_.hold_motion(false);
    }
  }

  const Cell cell_;
  Arm arm_;
  TwinServer& robot_;
  CellPictures& pictures_;
  bool was_moving_ = false;
  std::string key_;
  std::string announced_;
  std::jthread thread_;
};

/// The robot's twin; owned by both of the twins that need it.
class RobotServing final : public ServingTwin {
 public:
  explicit RobotServing(std::shared_ptr<TwinServer> server) : server_(std::move(server)) {}

  Json description() const override { return robot_twin_description(*server_); }

  bool has_ended() const override { return server_->is_stop_asked(); }

 private:
  std::shared_ptr<TwinServer> server_;
};

/// The camera of a cell with a robot. Members end in the opposite order: first what follows the
/// arm.
class FollowingCamera final : public ServingTwin {
 public:
  FollowingCamera(const Cell& cell,
                  std::unique_ptr<CameraServing> camera,
                  std::shared_ptr<TwinServer> robot)
      : robot_(std::move(robot)),
        camera_(std::move(camera)),
        follower_(cell, *robot_, camera_->pictures()) {}

  Json description() const override { return camera_->description(); }

  bool has_ended() const override { return camera_->has_ended(); }

 private:
  std::shared_ptr<TwinServer> robot_;
  std::unique_ptr<CameraServing> camera_;
  Follower follower_;
};

std::uint32_t address_of(const Cell& cell, bool is_free_address) {
  const std::string& text = camera_of(cell).address;
  if (is_free_address || text.empty()) {
    return free_camera_address();
  }
  const auto address = parse_ipv4(text);
  if (!address || !is_loopback(*address)) {
    throw ConfigError("camera.address",
                      fmt::format("is {}, a twin listens in 127.0.0.0/8 alone", text));
  }
  return *address;
}

CellState first_state(const Cell& cell, const Truth& truth) {
  if (!cell.robot) {
    return state_at_viewpoint(cell, truth);
  }
  const ArmWithTool arm = arm_with_tool(robot_of(cell), cell.limits);
  const CellPosition& start = safe_position_of(cell, "");
  const JointVector joints_rad = Eigen::Map<const JointVector>(start.joints_rad.data());
  return {.base_from_flange = transform_of(arm.arm.forward(joints_rad)),
          .lights = all_lights(cell)};
}

}  // namespace

std::filesystem::path truth_file_of(const Cell& cell) {
  if (cell.truth.empty()) {
    throw ConfigError(
        fmt::format("{}: twin.truth: is missing: the scene that the twin of the camera shows",
                    cell.file.string()));
  }
  return cell.truth;
}

ServingTwins camera_twin_of(const Cell& cell, bool is_free_address, int threads) {
  const Truth truth = read_truth(truth_file_of(cell));
  ServingTwins twins;
  twins.push_back(std::make_unique<CameraServing>(
      cell, truth, address_of(cell, is_free_address), first_state(cell, truth), threads));
  return twins;
}

ServingTwins both_twins_of(const Cell& cell, std::optional<int> port, int threads) {
  const Truth truth = read_truth(truth_file_of(cell));
  CellState state = first_state(cell, truth);
  state.lights = lights_on(cell, 0);
  auto camera =
      std::make_unique<CameraServing>(cell, truth, address_of(cell, port == 0), state, threads);
  auto robot = std::make_shared<TwinServer>(robot_twin_settings(cell, port));
  ServingTwins twins;
  twins.push_back(std::make_unique<FollowingCamera>(cell, std::move(camera), robot));
  twins.push_back(std::make_unique<RobotServing>(robot));
  return twins;
}

}  // namespace glint

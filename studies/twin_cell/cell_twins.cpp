// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/twin_cell/cell_twins.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hardware/gige/packets.h"
#include "hardware/gige/udp_socket.h"
#include "hardware/twin/camera/camera_twin.h"
#include "hardware/twin/robot/twin_server.h"
#include "studies/twin_cell/camera_serving.h"
#include "studies/twin_cell/stage_serving.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using std::chrono::milliseconds;

constexpr milliseconds kBetweenLooks{4};

/// What is on when the controller's outputs are so and no person has switched anything off.
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
TwinCellState state_at_viewpoint(const Truth& truth, const std::vector<std::string>& lights) {
  const RigidTransform camera_from_scene = camera_from_world(truth.scene.viewpoint());
  return {.base_from_flange = truth.base_from_flange(inverse(camera_from_scene)), .lights = lights};
}

/// What of the twins changes a picture, as it is now.
class CellWatch {
 public:
  /// @param stage  may be absent; all outlive the calls
  CellWatch(const Cell& cell,
            const TwinServer& robot,
            const StageServing* stage,
            const CameraServing& camera,
            const TruthSettings& truth)
      : cell_(cell),
        truth_(truth),
        arm_(arm_with_tool(robot_of(cell), cell.limits).arm),
        robot_(robot),
        stage_(stage),
        camera_(camera) {}

  /// Empty: the arm or the stage moves.
  std::optional<TwinCellState> now() const {
    const TwinView view = robot_.view();
    const auto place = stage_place();
    return view.is_still && place
               ? std::optional(state_of(view.joints_rad, view.digital_outputs, *place))
               : std::nullopt;
  }

  /// Where a held motion leads, before a scan that begins as the last one did; empty: none is held.
  std::optional<TwinCellState> goal() const {
    const TwinView view = robot_.view();
    StagePlace place = stage_place().value_or(StagePlace{});
    place.position = 0;
    return view.is_held && view.goal_rad
               ? std::optional(state_of(*view.goal_rad, view.digital_outputs, place))
               : std::nullopt;
  }

 private:
  TwinCellState state_of(const JointVector& joints_rad,
                         std::uint64_t outputs,
                         const StagePlace& place) const {
    const std::vector<std::string> lights = camera_.shining(lights_on(cell_, outputs));
    const RigidTransform joint_error = joint_error_of(truth_, arm_, joints_rad, lights);
    return {.base_from_flange = transform_of(arm_.forward(joints_rad)),
            .lights = lights,
            .stage_position = place.position,
            .stage_shift_mm = place.shift_mm,
            .placement = camera_.placement(),
            .joint_error = joint_error};
  }

  std::optional<StagePlace> stage_place() const {
    return stage_ != nullptr ? stage_->place() : StagePlace{};
  }

  const Cell cell_;
  const TruthSettings truth_;
  Arm arm_;
  const TwinServer& robot_;
  const StageServing* stage_;
  const CameraServing& camera_;
};

/// Tells the camera's pictures where the arm is. Each motion waits at its start for the picture of
/// its goal.
class Follower {
 public:
  /// All outlive this.
  Follower(const CellWatch& watch, TwinServer& robot, CellPictures& pictures)
      : watch_(watch),
        robot_(robot),
        pictures_(pictures),
        thread_([this](const std::stop_token& stop) {
          while (!stop.stop_requested()) {
            look(stop);
            std::this_thread::sleep_for(kBetweenLooks);
          }
        }) {}

 private:
  void look(const std::stop_token& stop) {
    if (const auto state = watch_.now()) {
      look_at_standstill(*state);
      return;
    }
    pictures_.leave();
    key_.clear();
    if (const auto goal = watch_.goal()) {
      pictures_.announce(*goal);
      pictures_.wait_until_finished(kLongestPicture, stop);
      robot_.hold_motion(false);
    }
  }

  /// A picture of other lights is begun only when they stay so for a moment: as a rule the arm is
  /// about to leave.
  void look_at_standstill(const TwinCellState& state) {
    const std::string key = key_of(state);
    if (key == key_) {
      return;
    }
    const bool is_arrival = key_.empty();
    const auto now = std::chrono::steady_clock::now();
    if (!is_arrival && key != coming_) {
      pictures_.leave();
      coming_ = key;
      coming_since_ = now;
    }
    const StagePlace place = {.position = state.stage_position, .shift_mm = state.stage_shift_mm};
    const bool has_moved = place != stage_place_;
    if (is_arrival || has_moved || now - coming_since_ > kLightsStay) {
      pictures_.arrive(state);
      key_ = key;
      stage_place_ = place;
      coming_.clear();
    }
  }

  static constexpr milliseconds kLongestPicture{120'000};
  static constexpr milliseconds kLightsStay{400};

  const CellWatch& watch_;
  TwinServer& robot_;
  CellPictures& pictures_;
  std::string key_;     ///< of the standstill that the pictures know of; empty: none
  std::string coming_;  ///< of another one, of the same pose
  std::chrono::steady_clock::time_point coming_since_;
  StagePlace stage_place_;
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

/// The stage beside them; it ends with the others.
class ServedStage final : public ServingTwin {
 public:
  explicit ServedStage(std::shared_ptr<StageServing> stage) : stage_(std::move(stage)) {}

  Json description() const override { return stage_->description(); }

  bool has_ended() const override { return false; }

 private:
  std::shared_ptr<StageServing> stage_;
};

/// The camera of a cell with a robot. Members end in the opposite order: first what follows the
/// arm.
class FollowingCamera final : public ServingTwin {
 public:
  FollowingCamera(const Cell& cell,
                  std::unique_ptr<CameraServing> camera,
                  std::shared_ptr<TwinServer> robot,
                  std::shared_ptr<StageServing> stage,
                  const TruthSettings& truth)
      : robot_(std::move(robot)),
        stage_(std::move(stage)),
        watch_(cell, *robot_, stage_.get(), *camera, truth),
        camera_(std::move(camera)),
        follower_(watch_, *robot_, camera_->pictures()) {
    camera_->pictures().set_live([this] { return watch_.now(); });
  }

  Json description() const override { return camera_->description(); }

  bool has_ended() const override { return camera_->has_ended(); }

 private:
  std::shared_ptr<TwinServer> robot_;
  std::shared_ptr<StageServing> stage_;
  CellWatch watch_;  ///< outlives the camera, which asks it at each trigger
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

TwinCellState first_state(const Cell& cell,
                          const Truth& truth,
                          const std::vector<std::string>& lights) {
  if (!cell.robot) {
    return state_at_viewpoint(truth, lights);
  }
  const ArmWithTool arm = arm_with_tool(robot_of(cell), cell.limits);
  const CellPosition& start = safe_position_of(cell, "");
  const JointVector joints_rad = Eigen::Map<const JointVector>(start.joints_rad.data());
  const RigidTransform joint_error = joint_error_of(truth.settings, arm.arm, joints_rad, lights);
  return {.base_from_flange = transform_of(arm.arm.forward(joints_rad)),
          .lights = lights,
          .joint_error = joint_error};
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

ServingTwins camera_twin_of(const Cell& cell, CameraPlace place, int threads) {
  const Truth truth = read_truth(truth_file_of(cell));
  const TwinCellState state = first_state(cell, truth, all_lights(cell));
  auto camera = std::make_unique<CameraServing>(
      cell, truth, address_of(cell, place.is_free), state, place.has_cable, threads);
  camera->stay_at([cell, truth, &serving = *camera] {
    return first_state(cell, truth, serving.shining(all_lights(cell)));
  });
  ServingTwins twins;
  twins.push_back(std::move(camera));
  return twins;
}

ServingTwins both_twins_of(const Cell& cell, std::optional<int> port, bool has_cable, int threads) {
  const Truth truth = read_truth(truth_file_of(cell));
  const TwinCellState state = first_state(cell, truth, lights_on(cell, 0));
  auto camera = std::make_unique<CameraServing>(
      cell, truth, address_of(cell, port == 0), state, has_cable, threads);
  TwinServerSettings settings = robot_twin_settings(cell, port);
  settings.twin.holds_motions = true;
  auto robot = std::make_shared<TwinServer>(std::move(settings));
  std::shared_ptr<StageServing> stage;
  if (cell.stage && cell.stage->kind == CellStage::Kind::kGrbl) {
    stage = std::make_shared<StageServing>(*cell.stage, camera->renderer(), port);
  }
  ServingTwins twins;
  twins.push_back(
      std::make_unique<FollowingCamera>(cell, std::move(camera), robot, stage, truth.settings));
  twins.push_back(std::make_unique<RobotServing>(robot));
  if (stage) {
    twins.push_back(std::make_unique<ServedStage>(stage));
  }
  return twins;
}

}  // namespace glint

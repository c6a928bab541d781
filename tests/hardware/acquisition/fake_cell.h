// SPDX-License-Identifier: GPL-3.0-or-later
//
// A robot, a camera, lights and a stage that remember what they were told, and fail when they are
// asked to.
#pragma once

#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "hardware/acquisition/acquisition.h"

namespace glint {

/// What goes wrong, at which call of all devices.
enum class FakeFault {
  kNone,
  kCameraTimeout,
  kCameraRefusesOnce,
  kCameraLost,
  kCameraComesBack,
  kLight,
  kStage,
  kSink,
  kProgram,  ///< an exception of no kind of ours, out of the sink's place
  kInterrupt,
  kProtectiveStop,
  kEmergencyStop,
  kSilence,     ///< no states any more
  kPushed,      ///< the arm is moved by somebody
  kUnreachable  ///< the motion is refused
};

inline bool is_of_arm(FakeFault fault) {
  return fault >= FakeFault::kProtectiveStop;
}

/// One world: the arm stands at the tour's first point.
class FakeCell {
 public:
  explicit FakeCell(Tour tour) : tour_(std::move(tour)), joints_(tour_.front().joints_rad) {}

  /// A device was called. @return the fault acts now
  bool call(FakeFault kind) {
    ++calls;
    if (calls >= fault_at && fault == kind && !has_acted) {
      has_acted = true;
      return true;
    }
    if (calls >= fault_at && !has_acted && is_of_arm(fault)) {
      act_on_arm();
    }
    if (calls >= fault_at && !has_acted && fault == FakeFault::kInterrupt) {
      has_acted = true;
      ++interrupt;
    }
    return false;
  }

  void act_on_arm() {
    if (fault == FakeFault::kUnreachable) {
      return;  // acts in the next motion
    }
    has_acted = true;
    safety = fault == FakeFault::kProtectiveStop  ? SafetyMode::kProtectiveStop
             : fault == FakeFault::kEmergencyStop ? SafetyMode::kRobotEmergencyStop
                                                  : SafetyMode::kNormal;
    is_silent = fault == FakeFault::kSilence;
    if (fault == FakeFault::kPushed) {
      joints_[2] += 0.05;
    }
  }

  Tour tour_;
  JointVector joints_;
  SafetyMode safety = SafetyMode::kNormal;
  bool is_silent = false;
  FakeFault fault = FakeFault::kNone;
  int fault_at = 0;
  bool has_acted = false;
  int calls = 0;
  std::atomic<int> interrupt = 0;
  int motions_after_fault = 0;
  int motions = 0;
  std::optional<MotionResult> halted = {};     ///< a stop, which may have been reset
  std::function<void()> during_exposure = {};  ///< of each picture
  std::function<void(RobotState&)> told = [](RobotState&) {
  };  ///< what the controller tells besides
  std::set<std::string> on;
  int stage_position = -1;
  std::vector<std::string> events;  ///< "move", "light ring on", "stage 2", "picture"
};

class FakeRobot final : public Robot {
 public:
  explicit FakeRobot(FakeCell& cell) : cell_(cell) {}

  std::optional<RobotState> state() const override {
    if (cell_.is_silent) {
      return std::nullopt;
    }
    RobotState state;
    state.actual_q_rad = state.target_q_rad = cell_.joints_;
    state.safety_mode = cell_.safety;
    state.robot_mode = RobotMode::kRunning;
    state.base_from_tcp.translation() = cell_.joints_.head<3>();
    cell_.told(state);
    return state;
  }

  MotionResult move_joints(const JointVector& goal_rad, double) override {
    ++cell_.motions;
    if (cell_.has_acted && is_of_arm(cell_.fault)) {
      ++cell_.motions_after_fault;
    }
    if (cell_.call(FakeFault::kUnreachable)) {
      return {.outcome = MotionOutcome::kUnreachable, .text = "beyond a limit"};
    }
    if (cell_.has_acted && is_of_arm(cell_.fault)) {  // half way
      cell_.joints_ = 0.5 * (cell_.joints_ + goal_rad);
      return {.outcome = cell_.is_silent ? MotionOutcome::kLost : MotionOutcome::kProtectiveStop,
              .text = "stopped"};
    }
    cell_.joints_ = goal_rad;
    cell_.events.emplace_back("move");
    return {.outcome = MotionOutcome::kDone, .text = ""};
  }

  MotionResult move_line(const Eigen::Isometry3d&, double) override { return {}; }

  MotionResult stop() override { return {}; }

  std::optional<MotionResult> halted() const override { return cell_.halted; }

  std::optional<StillPose> still_pose(double) override {
    cell_.call(FakeFault::kNone);
    if (cell_.is_silent || !allows_motion(cell_.safety)) {
      return std::nullopt;
    }
    return StillPose{.joints_rad = cell_.joints_, .packages = 25};
  }

 private:
  FakeCell& cell_;
};

class FakeLight final : public Light {
 public:
  FakeLight(std::string name, FakeCell& cell) : name_(std::move(name)), cell_(cell) {}

  const std::string& name() const override { return name_; }

  void set(bool is_on) override {
    if (cell_.call(FakeFault::kLight)) {
      throw IoError("the light does not follow");
    }
    if (is_on) {
      cell_.on.insert(name_);
    } else {
      cell_.on.erase(name_);
    }
    cell_.events.push_back("light " + name_ + (is_on ? " on" : " off"));
  }

  bool is_on() const override { return cell_.on.contains(name_); }

 private:
  std::string name_;
  FakeCell& cell_;
};

class FakeStage final : public Stage {
 public:
  FakeStage(int positions, FakeCell& cell) : positions_(positions), cell_(cell) {}

  int num_positions() const override { return positions_; }

  void go_to(int position) override {
    if (cell_.call(FakeFault::kStage)) {
      throw IoError("the stage is in alarm");
    }
    cell_.stage_position = position;
    cell_.events.push_back("stage " + std::to_string(position));
  }

  int position() const override { return cell_.stage_position; }

 private:
  int positions_;
  FakeCell& cell_;
};

/// Pictures of 16 x 12 pixels that are lit when a light is on.
class FakeCamera final : public Camera {
 public:
  explicit FakeCamera(FakeCell& cell) : cell_(cell) {}

  CameraState state() const override { return state_; }

  const CameraDescription& description() const override { return description_; }

  void configure(const CameraConfiguration& configuration) override {
    if (cell_.fault == FakeFault::kCameraComesBack && cell_.call(FakeFault::kCameraComesBack)) {
      state_ = CameraState::kLost;
      throw IoError("the camera does not answer while it is configured");
    }
    if (cell_.call(FakeFault::kCameraTimeout)) {
      throw IoError("the camera does not answer");
    }
    configuration_ = configuration;
    state_ = CameraState::kReady;
  }

  void start() override {
    state_ = CameraState::kAcquiring;
    cell_.events.push_back("camera starts");
  }

  Frame capture() override {
    Frame frame;
    frame.exposure_us = configuration_.exposure_us;
    frame.frame_id = ++frames_;
    for (const auto& [fault, status] :
         std::map<FakeFault, FrameStatus>{{FakeFault::kCameraTimeout, FrameStatus::kTimeout},
                                          {FakeFault::kCameraRefusesOnce, FrameStatus::kRefused},
                                          {FakeFault::kCameraLost, FrameStatus::kLost},
                                          {FakeFault::kCameraComesBack, FrameStatus::kLost}}) {
      if (cell_.fault == fault && cell_.call(fault)) {
        frame.status = status;
        return frame;
      }
    }
    cell_.call(FakeFault::kNone);
    if (cell_.during_exposure) {
      cell_.during_exposure();
    }
    frame.status = FrameStatus::kComplete;
    cell_.events.emplace_back("picture");
    const double edge_px = frames_ == 1 && first_edge_px_ > 0.0 ? first_edge_px_ : edge_px_;
    if (edge_px > 0.0) {
      frame.codes = soft_square(edge_px);
      return frame;
    }
    frame.codes = Image<std::uint16_t>(16, 12);
    for (int y = 0; y < 12; ++y) {
      for (int x = 0; x < 16; ++x) {
        frame.codes(x, y) = static_cast<std::uint16_t>(cell_.on.empty() ? 2
                                                       : dim_           ? 3
                                                              : 60 + 100 * ((x / 4 + y / 4) % 2));
      }
    }
    return frame;
  }

  void stop() override { state_ = CameraState::kReady; }

  bool reopen(std::chrono::milliseconds) override {
    if (state_ == CameraState::kLost) {
      state_ = CameraState::kReady;
      ++lost_while_configured_;
    }
    return cell_.fault != FakeFault::kCameraLost;
  }

  void close() override { state_ = CameraState::kClosed; }

  int lost_while_configured_ = 0;
  bool dim_ = false;
  double edge_px_ = 0.0;        ///< > 0: pictures of a bright square with edges of that sigma
  double first_edge_px_ = 0.0;  ///< > 0: those of the first picture

 private:
  static Image<std::uint16_t> soft_square(double edge_px) {
    const auto step = [edge_px](double from_px) {
      return 0.5 * (1.0 + std::erf(from_px / (std::sqrt(2.0) * edge_px)));
    };
    Image<std::uint16_t> codes(200, 160);
    for (int y = 0; y < codes.height(); ++y) {
      for (int x = 0; x < codes.width(); ++x) {
        const double inside = step(x - 50.0) * step(150.0 - x) * step(y - 40.0) * step(120.0 - y);
        codes(x, y) = static_cast<std::uint16_t>(std::lround(20.0 + 140.0 * inside));
      }
    }
    return codes;
  }

  FakeCell& cell_;
  CameraState state_ = CameraState::kReady;
  CameraDescription description_;
  CameraConfiguration configuration_;
  std::uint64_t frames_ = 0;
};

}  // namespace glint

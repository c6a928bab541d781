// SPDX-License-Identifier: GPL-3.0-or-later
//
// A camera's driver that does what a script says.
#pragma once

#include <condition_variable>
#include <deque>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "hardware/camera/supervised_camera.h"

namespace glint {

/// What a trigger leads to.
struct Step {
  enum class Kind { kWhole, kIncomplete, kNothing, kMissed, kHangs, kRefused, kWithLate };
  Kind kind = Kind::kWhole;
};

/// Shared by all drivers that are opened one after the other.
struct Script {
  enum class Call { kNone, kStart, kStop, kClose };

  std::mutex mutex;
  std::deque<Step::Kind> steps;  ///< of the coming triggers; then all are whole
  std::uint64_t next_id = 100;
  bool answers = true;
  int refused_opens = 0;
  int opened = 0;
  int closed = 0;
  int streams = 0;
  std::vector<CameraConfiguration> configurations;
  std::vector<std::chrono::steady_clock::time_point> opens;  ///< tries, refused ones too
  Call hanging = Call::kNone;                                ///< does not come back
  std::condition_variable changed;

  /// Blocks while calls of that kind hang. @param lock  of the mutex
  void pass(Call call, std::unique_lock<std::mutex>& lock) {
    changed.wait(lock, [&] { return hanging != call; });
  }

  void hang(Call call) {
    const std::scoped_lock lock(mutex);
    hanging = call;
    changed.notify_all();
  }

  /// Lets go of what hangs. @return all drivers were closed within 5 s
  bool ends() {
    hang(Call::kNone);
    std::unique_lock lock(mutex);
    return changed.wait_for(lock, std::chrono::seconds(5), [&] { return closed == opened; });
  }
};

class ScriptedDriver final : public CameraDriver {
 public:
  explicit ScriptedDriver(std::shared_ptr<Script> script) : script_(std::move(script)) {}

  ~ScriptedDriver() override {
    std::unique_lock lock(script_->mutex);
    script_->pass(Script::Call::kClose, lock);
    ++script_->closed;
    script_->changed.notify_all();
  }

  CameraDescription describe() override {
    return {.id = "scripted", .has_gain = true, .is_gain_in_db = true};
  }

  DriverSettings configure(const CameraConfiguration& configuration) override {
    if (configuration.exposure_us < 10.0) {
      throw ConfigError("exposure_us", "is too short");
    }
    const std::scoped_lock lock(script_->mutex);
    script_->configurations.push_back(configuration);
    return {.description = describe(),
            .exposure_us = configuration.exposure_us,
            .gain = configuration.gain_db.value_or(3.0),
            .others = {{"BlackLevel", "12"}}};
  }

  void start() override {
    std::unique_lock lock(script_->mutex);
    script_->pass(Script::Call::kStart, lock);
    ++script_->streams;
    coming_.clear();
  }

  void stop() override {
    std::unique_lock lock(script_->mutex);
    script_->pass(Script::Call::kStop, lock);
  }

  void trigger() override {
    Step::Kind kind = Step::Kind::kWhole;
    {
      const std::scoped_lock lock(script_->mutex);
      if (!script_->steps.empty()) {
        kind = script_->steps.front();
        script_->steps.pop_front();
      }
    }
    if (kind == Step::Kind::kRefused) {
      throw TriggerRefused("busy");
    }
    if (kind == Step::Kind::kHangs) {
      std::this_thread::sleep_for(std::chrono::milliseconds(700));
    }
    // A call that was given up may still run beside the next one.
    const std::scoped_lock lock(script_->mutex);
    if (kind == Step::Kind::kWithLate) {
      coming_.push_back(frame(script_->next_id - 1, true));
    }
    if (kind == Step::Kind::kMissed) {
      return;
    }
    const std::uint64_t id = script_->next_id++;
    if (kind != Step::Kind::kNothing) {
      coming_.push_back(frame(id, kind != Step::Kind::kIncomplete));
    }
  }

  std::optional<DriverFrame> next_frame(std::chrono::milliseconds within) override {
    if (coming_.empty()) {
      std::this_thread::sleep_for(within);
      return std::nullopt;
    }
    DriverFrame next = coming_.front();
    coming_.pop_front();
    return next;
  }

  bool answers() override {
    const std::scoped_lock lock(script_->mutex);
    return script_->answers;
  }

  bool has_lost_control() const override { return false; }

 private:
  static DriverFrame frame(std::uint64_t id, bool is_complete) {
    return {.is_complete = is_complete,
            .what = is_complete ? "" : "packets are missing",
            .codes = Image<std::uint16_t>(1, 1, static_cast<std::uint16_t>(id)),
            .frame_id = id};
  }

  std::shared_ptr<Script> script_;
  std::deque<DriverFrame> coming_;
};

inline constexpr CameraDeadlines kBrief = {.frame = std::chrono::milliseconds(60),
                                           .answer = std::chrono::milliseconds(60),
                                           .settings = std::chrono::milliseconds(300),
                                           .close = std::chrono::milliseconds(100),
                                           .first_pause = std::chrono::milliseconds(5),
                                           .longest_pause = std::chrono::milliseconds(20)};

/// Configured for exposures of 1 ms and started.
inline std::unique_ptr<SupervisedCamera> started(const std::shared_ptr<Script>& script,
                                                 const CameraDeadlines& deadlines = kBrief) {
  auto camera = std::make_unique<SupervisedCamera>(
      [script]() -> std::unique_ptr<CameraDriver> {
        const std::scoped_lock lock(script->mutex);
        script->opens.push_back(std::chrono::steady_clock::now());
        if (script->refused_opens > 0) {
          --script->refused_opens;
          throw IoError("there is no camera");
        }
        ++script->opened;
        return std::make_unique<ScriptedDriver>(script);
      },
      deadlines);
  camera->configure({.exposure_us = 1000.0});
  camera->start();
  return camera;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Deadlines, retakes and losses with a driver that does what a script says.
#include "hardware/camera/supervised_camera.h"

#include <gmock/gmock.h>

#include <deque>
#include <mutex>
#include <thread>

namespace glint {
namespace {

using std::chrono::milliseconds;
using testing::HasSubstr;

/// What a trigger leads to.
struct Step {
  enum class Kind { kWhole, kIncomplete, kNothing, kMissed, kHangs, kRefused, kWithLate };
  Kind kind = Kind::kWhole;
};

/// Shared by all drivers that are opened one after the other.
struct Script {
  std::mutex mutex;
  std::deque<Step::Kind> steps;  ///< of the coming triggers; then all are whole
  std::uint64_t next_id = 100;
  bool answers = true;
  int refused_opens = 0;
  int opened = 0;
  int closed = 0;
  int streams = 0;
};

class ScriptedDriver final : public CameraDriver {
 public:
  explicit ScriptedDriver(std::shared_ptr<Script> script) : script_(std::move(script)) {}

  ~ScriptedDriver() override {
    const std::scoped_lock lock(script_->mutex);
    ++script_->closed;
  }

  CameraDescription describe() override { return {.id = "scripted"}; }

  DriverSettings configure(const CameraConfiguration& configuration) override {
    if (configuration.exposure_us < 10.0) {
      throw ConfigError("exposure_us", "is too short");
    }
    return {.description = describe(), .exposure_us = configuration.exposure_us, .gain = 3.0};
  }

  void start() override {
    const std::scoped_lock lock(script_->mutex);
    ++script_->streams;
    coming_.clear();
  }

  void stop() override {}

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
      std::this_thread::sleep_for(milliseconds(700));
    }
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

  std::optional<DriverFrame> next_frame(milliseconds within) override {
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

constexpr CameraDeadlines kBrief = {.frame = milliseconds(60),
                                    .answer = milliseconds(60),
                                    .settings = milliseconds(300),
                                    .close = milliseconds(100),
                                    .first_pause = milliseconds(5),
                                    .longest_pause = milliseconds(20)};

std::unique_ptr<SupervisedCamera> started(const std::shared_ptr<Script>& script) {
  auto camera = std::make_unique<SupervisedCamera>(
      [script]() -> std::unique_ptr<CameraDriver> {
        const std::scoped_lock lock(script->mutex);
        if (script->refused_opens > 0) {
          --script->refused_opens;
          throw IoError("there is no camera");
        }
        ++script->opened;
        return std::make_unique<ScriptedDriver>(script);
      },
      kBrief);
  camera->configure({.exposure_us = 1000.0});
  camera->start();
  return camera;
}

TEST(SupervisedCamera, GoesThroughItsStates) {
  const auto script = std::make_shared<Script>();
  const auto camera = started(script);
  EXPECT_EQ(camera->state(), CameraState::kAcquiring);
  EXPECT_EQ(camera->description().id, "scripted");
  camera->stop();
  EXPECT_EQ(camera->state(), CameraState::kReady);
  camera->close();
  EXPECT_EQ(camera->state(), CameraState::kClosed);
  EXPECT_EQ(script->closed, 1);
}

TEST(SupervisedCamera, TellsWithEachFrameHowItWasTaken) {
  const auto script = std::make_shared<Script>();
  const auto camera = started(script);
  const Frame frame = camera->capture();
  EXPECT_TRUE(frame.is_complete());
  EXPECT_EQ(frame.frame_id, 100U);
  EXPECT_EQ(frame.exposure_us, 1000.0);
  EXPECT_EQ(frame.gain, 3.0);
  EXPECT_EQ(frame.retakes, 0);
  EXPECT_EQ(frame.codes(0, 0), 100);
}

TEST(SupervisedCamera, TakesIncompleteFramesAgainThreeTimesAtMost) {
  using enum Step::Kind;
  const auto script = std::make_shared<Script>();
  const auto camera = started(script);
  script->steps = {kIncomplete, kIncomplete, kIncomplete};
  const Frame third = camera->capture();
  EXPECT_TRUE(third.is_complete());
  EXPECT_EQ(third.retakes, 3);
  script->steps = {kIncomplete, kIncomplete, kIncomplete, kIncomplete};
  const Frame none = camera->capture();
  EXPECT_EQ(none.status, FrameStatus::kIncomplete);
  EXPECT_THAT(none.what, HasSubstr("packets are missing"));
  EXPECT_EQ(camera->state(), CameraState::kAcquiring);
  EXPECT_TRUE(camera->capture().is_complete());
}

TEST(SupervisedCamera, ThrowsAwayTheLatePictureOfAnOlderTrigger) {
  using enum Step::Kind;
  const auto script = std::make_shared<Script>();
  const auto camera = started(script);
  EXPECT_TRUE(camera->capture().is_complete());
  script->steps = {kNothing, kWithLate};  // 101 comes with 102
  const Frame frame = camera->capture();
  EXPECT_TRUE(frame.is_complete());
  EXPECT_EQ(frame.frame_id, 102U);
  EXPECT_EQ(frame.late_frames, 1);
  EXPECT_EQ(frame.retakes, 1);
}

// The camera did not see a trigger: its ids lag behind, and only a new stream sets that right.
TEST(SupervisedCamera, CountsAnewAfterATriggerThatTheCameraMissed) {
  using enum Step::Kind;
  const auto script = std::make_shared<Script>();
  const auto camera = started(script);
  EXPECT_TRUE(camera->capture().is_complete());
  script->steps = {kMissed};
  const Frame frame = camera->capture();
  EXPECT_TRUE(frame.is_complete());
  EXPECT_EQ(frame.retakes, 2);
  EXPECT_EQ(script->streams, 2);
}

TEST(SupervisedCamera, NamesARefusedTrigger) {
  const auto script = std::make_shared<Script>();
  const auto camera = started(script);
  script->steps = {Step::Kind::kRefused};
  const Frame frame = camera->capture();
  EXPECT_EQ(frame.status, FrameStatus::kRefused);
  EXPECT_EQ(frame.what, "busy");
  EXPECT_TRUE(camera->capture().is_complete());
}

// The camera is still at the picture whose packets did not come when it is asked for the next one.
TEST(SupervisedCamera, TakesAPictureAgainInANewStreamWhenARetakeIsRefused) {
  using enum Step::Kind;
  for (const Step::Kind first : {kIncomplete, kNothing}) {
    const auto script = std::make_shared<Script>();
    const auto camera = started(script);
    EXPECT_TRUE(camera->capture().is_complete());
    script->steps = {first, kRefused};
    const Frame frame = camera->capture();
    EXPECT_TRUE(frame.is_complete()) << frame.what;
    EXPECT_EQ(frame.retakes, 2);
    EXPECT_EQ(frame.frame_id, 102U);
    EXPECT_EQ(script->streams, 2);
    script->steps = {first, kRefused, kRefused, kRefused};
    EXPECT_EQ(camera->capture().status, FrameStatus::kRefused) << "three retakes at most";
    EXPECT_TRUE(camera->capture().is_complete());
  }
}

TEST(SupervisedCamera, IsLostWhenNothingComesAndNobodyAnswersAndComesBack) {
  const auto script = std::make_shared<Script>();
  const auto camera = started(script);
  script->steps = {Step::Kind::kNothing};
  script->answers = false;
  EXPECT_EQ(camera->capture().status, FrameStatus::kLost);
  EXPECT_EQ(camera->state(), CameraState::kLost);
  EXPECT_EQ(camera->capture().status, FrameStatus::kLost);
  script->answers = true;
  script->refused_opens = 3;
  EXPECT_TRUE(camera->reopen(milliseconds(2000)));
  EXPECT_EQ(camera->state(), CameraState::kAcquiring);
  EXPECT_EQ(script->opened, 2);
  EXPECT_TRUE(camera->capture().is_complete());
}

// The trigger comes back after 0.7 s, the camera is lost after 0.12 s: its call is left alone.
TEST(SupervisedCamera, AbandonsACallThatDoesNotComeBack) {
  const auto script = std::make_shared<Script>();
  auto camera = started(script);
  script->steps = {Step::Kind::kHangs};
  EXPECT_EQ(camera->capture().status, FrameStatus::kLost);
  EXPECT_EQ(script->closed, 0);
  EXPECT_TRUE(camera->reopen(milliseconds(2000)));
  EXPECT_TRUE(camera->capture().is_complete());
  std::this_thread::sleep_for(milliseconds(900));
  const std::scoped_lock lock(script->mutex);
  EXPECT_EQ(script->closed, 1);  // the first driver, on its own thread
}

TEST(SupervisedCamera, GivesUpToReopenInTime) {
  const auto script = std::make_shared<Script>();
  const auto camera = started(script);
  script->steps = {Step::Kind::kNothing};
  script->answers = false;
  EXPECT_EQ(camera->capture().status, FrameStatus::kLost);
  script->refused_opens = 1000;
  EXPECT_FALSE(camera->reopen(milliseconds(100)));
  EXPECT_EQ(camera->state(), CameraState::kLost);
}

TEST(SupervisedCamera, RefusesAConfigurationAndStaysReady) {
  const auto script = std::make_shared<Script>();
  const auto camera = started(script);
  camera->stop();
  EXPECT_THROW(camera->configure({.exposure_us = 1.0}), ConfigError);
  EXPECT_EQ(camera->state(), CameraState::kReady);
}

}  // namespace
}  // namespace glint

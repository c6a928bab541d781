// SPDX-License-Identifier: GPL-3.0-or-later
//
// Deadlines, retakes and losses with a driver that does what a script says.
#include "hardware/camera/supervised_camera.h"

#include <gmock/gmock.h>

#include <thread>

#include "core/wall_clock.h"
#include "tests/hardware/camera/scripted_driver.h"

namespace glint {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using testing::HasSubstr;

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

// Without power a camera forgets what nobody but itself had told it.
TEST(SupervisedCamera, RestoresWhatTheConfigurationLeftToTheCamera) {
  const auto script = std::make_shared<Script>();
  const auto camera = started(script);
  for (int losses = 0; losses < 2; ++losses) {
    script->steps = {Step::Kind::kNothing};
    script->answers = false;
    EXPECT_EQ(camera->capture().status, FrameStatus::kLost);
    script->answers = true;
    ASSERT_TRUE(camera->reopen(milliseconds(2000)));
  }
  ASSERT_EQ(script->configurations.size(), 3U);
  EXPECT_FALSE(script->configurations[0].gain_db.has_value());
  for (const std::size_t i : {1U, 2U}) {
    EXPECT_EQ(script->configurations[i].gain_db, 3.0);
    EXPECT_EQ(script->configurations[i].exposure_us, 1000.0);
    EXPECT_EQ(script->configurations[i].restored, NamedFeatures({{"BlackLevel", "12"}}));
  }
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

TEST(SupervisedCamera, TriesToReopenWithPausesThatGrow) {
  const auto script = std::make_shared<Script>();
  CameraDeadlines deadlines = kBrief;
  deadlines.first_pause = milliseconds(20);
  deadlines.longest_pause = milliseconds(80);
  const auto camera = started(script, deadlines);
  script->steps = {Step::Kind::kNothing};
  script->answers = false;
  EXPECT_EQ(camera->capture().status, FrameStatus::kLost);
  script->opens.clear();
  script->refused_opens = 6;
  ASSERT_TRUE(camera->reopen(milliseconds(10000)));
  ASSERT_EQ(script->opens.size(), 7U);
  std::vector<Clock::duration> pauses;
  for (std::size_t i = 1; i < script->opens.size(); ++i) {
    pauses.push_back(script->opens[i] - script->opens[i - 1]);
  }
  for (const std::size_t i : {0U, 1U, 2U}) {
    EXPECT_GE(pauses[i], milliseconds(20 << i));
  }
  // The shortest: the machine may be busy at one of them.
  EXPECT_GE(*std::min_element(pauses.begin() + 3, pauses.end()), milliseconds(80));
  EXPECT_LT(*std::min_element(pauses.begin() + 3, pauses.end()), milliseconds(160))
      << "no more than the longest";
}

/// Settings may take as long as they do in the product.
CameraDeadlines patient_settings() {
  CameraDeadlines deadlines = kBrief;
  deadlines.settings = CameraDeadlines{}.settings;
  return deadlines;
}

// After a picture that was not complete a new stream is begun. A camera that dies there is lost as
// early as one that dies in a picture: 0.12 s here.
TEST(SupervisedCamera, IsLostAsEarlyInTheNewStreamAfterAnIncompletePicture) {
  using enum Step::Kind;
  for (const Script::Call call : {Script::Call::kStop, Script::Call::kStart}) {
    const auto script = std::make_shared<Script>();
    const auto camera = started(script, patient_settings());
    script->steps = {kIncomplete, kIncomplete, kIncomplete, kIncomplete};
    EXPECT_EQ(camera->capture().status, FrameStatus::kIncomplete);
    script->hang(call);
    const auto died = Clock::now();
    EXPECT_EQ(camera->capture().status, FrameStatus::kLost);
    EXPECT_LT(seconds_since(died), 1.5);
    EXPECT_EQ(camera->state(), CameraState::kLost);
    script->hang(Script::Call::kNone);
    EXPECT_TRUE(camera->reopen(milliseconds(2000)));
    EXPECT_EQ(camera->state(), CameraState::kAcquiring);
    camera->close();
    EXPECT_TRUE(script->ends());
  }
}

// What the product waits for: a camera that is lost within exposure + 2 s and free 3 s later.
TEST(SupervisedCamera, WaitsNoLongerThanItSays) {
  const CameraDeadlines deadlines;
  EXPECT_LE(deadlines.frame + deadlines.answer, milliseconds(1950));
  EXPECT_LE(deadlines.close, milliseconds(2900));
}

TEST(SupervisedCamera, IsFreeInTimeWhateverHangsWhileItIsClosed) {
  for (const Script::Call call : {Script::Call::kStop, Script::Call::kClose}) {
    for (const bool is_destroyed : {false, true}) {
      const auto script = std::make_shared<Script>();
      auto camera = started(script, patient_settings());
      script->hang(call);
      const auto begin = Clock::now();
      if (is_destroyed) {
        camera.reset();
      } else {
        camera->close();
        EXPECT_EQ(camera->state(), CameraState::kClosed);
      }
      EXPECT_LT(seconds_since(begin), 1.5) << "0.1 s are allowed";
      EXPECT_EQ(script->closed, 0) << "it hangs";
      EXPECT_TRUE(script->ends());
    }
  }
}

// A lost camera's handle stays with its thread: nobody waits for it.
TEST(SupervisedCamera, ALostCameraIsFreeAtOnceThoughItsDriverHangs) {
  const auto script = std::make_shared<Script>();
  auto camera = started(script, patient_settings());
  script->hang(Script::Call::kClose);
  script->steps = {Step::Kind::kNothing};
  script->answers = false;
  EXPECT_EQ(camera->capture().status, FrameStatus::kLost);
  const auto lost = Clock::now();
  camera->close();
  camera.reset();
  EXPECT_LT(seconds_since(lost), 1.5);
  EXPECT_EQ(script->closed, 0);
  EXPECT_TRUE(script->ends());
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

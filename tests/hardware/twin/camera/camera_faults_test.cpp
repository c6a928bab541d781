// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cameras that freeze, die and come back.
#include <gmock/gmock.h>

#include <thread>

#include "core/wall_clock.h"
#include "tests/hardware/twin/camera/started_camera.h"
#include "tests/hardware/twin/camera/twin_process.h"

namespace glint {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

TEST(LostCamera, IsNoticedLeftAndFoundAgain) {
  TwinProcess process(test_address(23));
  const auto camera = started_camera(test_address(23));
  EXPECT_TRUE(camera->capture().is_complete());
  process.kill();
  const auto killed = Clock::now();
  EXPECT_EQ(camera->capture().status, FrameStatus::kLost);
  EXPECT_LT(seconds_since(killed),
            2.001 + 0.5);  // exposure + 2 s, and half a second of a busy machine
  EXPECT_EQ(camera->state(), CameraState::kLost);
  process.start();
  const auto returned = Clock::now();
  ASSERT_TRUE(camera->reopen(milliseconds(20000)));
  const Frame frame = camera->capture();
  EXPECT_TRUE(frame.is_complete()) << frame.what;
  EXPECT_LT(seconds_since(returned), 8.0);
}

TEST(FrozenCamera, OfOneAndAHalfSecondsGoesOn) {
  TwinProcess process(test_address(24));
  const auto camera = started_camera(test_address(24));
  EXPECT_TRUE(camera->capture().is_complete());
  process.freeze();
  std::jthread thaw([&] {
    std::this_thread::sleep_for(milliseconds(1500));
    process.thaw();
  });
  const Frame frame = camera->capture();
  EXPECT_TRUE(frame.is_complete()) << name_of(frame.status) << ": " << frame.what;
  EXPECT_TRUE(camera->capture().is_complete());
}

#ifdef GLINT_MANY_FRAMES
TEST(FrozenCamera, OfSixSecondsIsLostAndComesBack) {
  TwinProcess process(test_address(25));
  const auto camera = started_camera(test_address(25));
  process.freeze();
  std::jthread thaw([&] {
    std::this_thread::sleep_for(milliseconds(6000));
    process.thaw();
  });
  EXPECT_EQ(camera->capture().status, FrameStatus::kLost);
  ASSERT_TRUE(camera->reopen(milliseconds(20000)));
  EXPECT_TRUE(camera->capture().is_complete());
}
#endif

}  // namespace
}  // namespace glint

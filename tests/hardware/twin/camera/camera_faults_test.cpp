// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cameras that freeze, die and come back.
#include <gmock/gmock.h>

#include <thread>

#include "core/wall_clock.h"
#include "hardware/twin/camera/test_pattern.h"
#include "tests/hardware/twin/camera/started_camera.h"
#include "tests/hardware/twin/camera/twin_process.h"

namespace glint {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// A part of 12-bit pictures.
CameraConfiguration small_configuration() {
  return {.format = PixelFormat::kMono12,
          .region = SensorRegion{.x_px = 16, .y_px = 8, .width_px = 64, .height_px = 48},
          .exposure_us = 1234.0,
          .packet_size = 4000};
}

/// Somebody sets gain and black level, which stay in the camera.
void set_gain_and_black_level(std::uint32_t address) {
  AravisCamera camera(ipv4_text(address));
  CameraConfiguration once = small_configuration();
  once.gain_db = 6.25;
  once.features = {{"BlackLevel", "32.5"}};
  camera.configure(once);
}

// The process that takes the place of the one that was killed knows nothing of what was set, as a
// camera that was without power.
TEST(LostCamera, IsNoticedLeftAndFoundAgainWithSettingsThatNobodyNames) {
  const std::uint32_t address = test_address(23);
  TwinProcess process(address, 1);
  set_gain_and_black_level(address);
  AravisCamera camera(ipv4_text(address));
  camera.configure(small_configuration());
  camera.start();
  EXPECT_EQ(camera.capture().gain, 6.25);
  process.kill();
  const auto killed = Clock::now();
  EXPECT_EQ(camera.capture().status, FrameStatus::kLost);
  EXPECT_LT(seconds_since(killed),
            2.001 + 0.5);  // exposure + 2 s, and half a second of a busy machine
  EXPECT_EQ(camera.state(), CameraState::kLost);
  process.start();
  const auto returned = Clock::now();
  ASSERT_TRUE(camera.reopen(milliseconds(20000)));
  const Frame frame = camera.capture();
  ASSERT_TRUE(frame.is_complete()) << frame.what;
  EXPECT_LT(seconds_since(returned), 8.0);
  EXPECT_EQ(frame.gain, 6.25);
  EXPECT_EQ(frame.exposure_us, 1234.0);
  EXPECT_EQ(frame.codes(0, 0), test_pattern(kTwinWidth, kTwinHeight, 12, 0)(16, 8));
  EXPECT_EQ(camera.description().packet_size, 4000);
  camera.close();
  // What the camera itself says, in which the last one left it.
  const auto driver = open_aravis_driver(ipv4_text(address));
  EXPECT_EQ(driver->configure(small_configuration()).others,
            NamedFeatures(
                {{"BinningHorizontal", "1"}, {"BinningVertical", "1"}, {"BlackLevel", "32.5"}}));
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

TEST(FrozenCamera, OfSixSecondsIsLostAndComesBack) {
  TwinProcess process(test_address(25));
  const auto camera = started_camera(test_address(25));
  const auto frozen = Clock::now();
  process.freeze();
  std::jthread thaw([&] {
    std::this_thread::sleep_for(milliseconds(6000));
    process.thaw();
  });
  EXPECT_EQ(camera->capture().status, FrameStatus::kLost);
  ASSERT_TRUE(camera->reopen(milliseconds(20000)));
  EXPECT_TRUE(camera->capture().is_complete());
  EXPECT_LT(seconds_since(frozen), 6.0 + 8.0);
}

}  // namespace
}  // namespace glint

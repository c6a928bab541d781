// SPDX-License-Identifier: GPL-3.0-or-later
//
// With the camera that Aravis simulates within a process: no network, and the older names of the
// features (ExposureTimeAbs, GainRaw). Over the wire: tests/hardware/twin/camera.
#include "hardware/camera/aravis_camera.h"

#include <gmock/gmock.h>

/// Aravis' own, whose header only the sources of the room include.
extern "C" void arv_enable_interface(const char* name);

namespace glint {
namespace {

using testing::HasSubstr;

std::unique_ptr<AravisCamera> simulated_by_aravis() {
  arv_enable_interface("Fake");
  return std::make_unique<AravisCamera>("Fake_1");
}

std::string configure_error(Camera& camera, const CameraConfiguration& configuration) {
  try {
    camera.configure(configuration);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

TEST(AravisCamera, DrivesACameraWithTheOlderNames) {
  const auto opened = simulated_by_aravis();
  AravisCamera& camera = *opened;
  EXPECT_EQ(camera.state(), CameraState::kReady);
  EXPECT_EQ(camera.description().sensor_width_px, 2048);
  EXPECT_TRUE(camera.description().has_gain);
  EXPECT_FALSE(camera.description().is_gain_in_db);
  camera.configure({.region = SensorRegion{.x_px = 0, .y_px = 0, .width_px = 64, .height_px = 48},
                    .exposure_us = 500.0,
                    .gain_raw = 2.0});
  camera.start();
  const Frame frame = camera.capture();
  ASSERT_TRUE(frame.is_complete()) << frame.what;
  EXPECT_EQ(frame.codes.width(), 64);
  EXPECT_EQ(frame.codes.height(), 48);
  EXPECT_EQ(frame.exposure_us, 500.0);
  EXPECT_EQ(frame.gain, 2.0);
}

// Aravis takes 5 us and gain 20 without a word unless its range check is on.
TEST(AravisCamera, RefusesWhatTheCameraDoesNotAllow) {
  const auto opened = simulated_by_aravis();
  AravisCamera& camera = *opened;
  EXPECT_THAT(configure_error(camera, {.exposure_us = 5.0}),
              HasSubstr("exposure_us: is 5, this camera allows 10 to "));
  EXPECT_THAT(configure_error(camera, {.gain_raw = 20.0}),
              HasSubstr("gain_raw: is 20, this camera allows 0 to 10"));
  EXPECT_THAT(
      configure_error(camera, {.gain_db = 2.0}),
      HasSubstr("gain_db: this camera's gain is in steps of its own: give gain_raw, 0 to 10"));
  EXPECT_THAT(configure_error(
                  camera, {.region = SensorRegion{.x_px = 2000, .width_px = 100, .height_px = 9}}),
              HasSubstr("region_px: 100 x 9 pixels from (2000, 0) do not lie on the sensor"));
  EXPECT_THAT(configure_error(camera, {.features = {{"NoSuchFeature", "1"}}}),
              HasSubstr("features.NoSuchFeature"));
  EXPECT_THAT(configure_error(camera, {.format = PixelFormat::kMono12Packed}),
              HasSubstr("pixel_format: "));
  EXPECT_EQ(camera.state(), CameraState::kReady);
}

TEST(AravisCamera, KeepsItsGainWhenNoneIsGiven) {
  const auto opened = simulated_by_aravis();
  opened->configure({.gain_raw = 3.0});
  opened->configure({});
  opened->start();
  EXPECT_EQ(opened->capture().gain, 3.0);
}

TEST(AravisCamera, NamesACameraThatIsNotThere) {
  EXPECT_THROW(AravisCamera("NoSuchVendor-1"), IoError);
}

}  // namespace
}  // namespace glint

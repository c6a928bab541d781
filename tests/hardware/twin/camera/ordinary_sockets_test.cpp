// SPDX-License-Identifier: GPL-3.0-or-later
//
// A camera on a machine that allows no packet sockets.
#include <chrono>
#include <thread>

#include <gmock/gmock.h>

#include "core/wall_clock.h"
#include "hardware/camera/aravis_camera.h"
#include "hardware/gige/udp_socket.h"
#include "hardware/twin/camera/test_pattern.h"
#include "tests/hardware/twin/camera/twin_process.h"
#include "tests/support/count_from.h"

namespace glint {
namespace {

/// A quarter of the sensor, 25 MB a second: a whole one takes longer than a twentieth of a second.
CameraConfiguration quarter_through_ordinary_sockets() {
  return {.region = SensorRegion{.width_px = kTwinWidth / 2, .height_px = kTwinHeight / 2},
          .exposure_us = 1000.0,
          .packet_size = 9000,
          .uses_packet_sockets = false};
}

TEST(OrdinarySockets, LoseNoFrameAtTwentyASecond) {
  const bool is_alone = count_from("GLINT_MANY_FRAMES", 0) > 0;
  const int frames = is_alone ? 100 : 60;
  const TwinProcess process(test_address(9), 1);
  AravisCamera camera(ipv4_text(test_address(9)));
  const CameraConfiguration configuration = quarter_through_ordinary_sockets();
  camera.configure(configuration);
  camera.start();
  TestPatternSource patterns(configuration.region->width_px, configuration.region->height_px);
  int lost = 0;
  int retakes = 0;
  int wrong = 0;
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < frames; ++i) {
    std::this_thread::sleep_until(begin + i * std::chrono::milliseconds(50));
    const Frame frame = camera.capture();
    lost += frame.is_complete() ? 0 : 1;
    retakes += frame.retakes;
    const auto shot = static_cast<std::uint64_t>(i + retakes);
    wrong += frame.codes == *patterns.finished({.bits = 8}, shot) ? 0 : 1;
  }
  std::printf("%.1f frames per second, %d taken again\n", frames / seconds_since(begin), retakes);
  EXPECT_EQ(lost, 0);
  EXPECT_EQ(wrong, 0);
  EXPECT_TRUE(retakes == 0 || !is_alone) << retakes << " taken again: Aravis gives up after 0.2 s";
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures of a simulated cell that the product's camera takes over the wire, pose after pose.
#include <unistd.h>

#include <gmock/gmock.h>

#include "hardware/camera/aravis_camera.h"
#include "hardware/gige/udp_socket.h"
#include "hardware/twin/camera/camera_twin.h"
#include "studies/twin_cell/cell_pictures.h"
#include "tests/studies/twin_cell/small_cell.h"

namespace glint {
namespace {

constexpr std::chrono::milliseconds kRendering{60000};  ///< at most
constexpr int kPoses = 50;
constexpr double kSpan_mm = 16.0;  ///< the camera goes so far aside

// Each is the picture that is rendered for its pose, and no other one's.
TEST(PicturesOverTheWire, BelongToTheirPoses) {
  ThreadPool pool(2);
  CellRenderer renderer(truth_of(kSmallTruth), pool);
  CellPictures pictures(renderer, state_above(0, {"ring"}));
  const std::uint32_t address =
      0x7f000003U | (static_cast<std::uint32_t>(::getpid() & 0xffff) << 8U);
  const CameraTwin twin({.address = address,
                         .sensor_width_px = renderer.width_px(),
                         .sensor_height_px = renderer.height_px()},
                        pictures);
  AravisCamera camera(ipv4_text(address));
  camera.configure({.exposure_us = 5000.0, .packet_size = 9000});
  camera.start();
  for (int pose = 0; pose < kPoses; ++pose) {
    const TwinCellState state = state_above(kSpan_mm * pose / kPoses, {"ring"});
    pictures.leave();
    pictures.announce(state);
    ASSERT_TRUE(pictures.wait_until_finished(kRendering));
    pictures.arrive(state);
    const Frame frame = camera.capture();
    ASSERT_TRUE(frame.is_complete()) << frame.what;
    EXPECT_EQ(frame.codes, renderer.render(state, {.exposure_us = 5000.0})) << pose;
  }
  EXPECT_EQ(twin.counts().refused, 0U);
}

}  // namespace
}  // namespace glint

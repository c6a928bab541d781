// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `glint cell grab` tells of pictures that did not come.
#include <unistd.h>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "hardware/gige/udp_socket.h"
#include "hardware/twin/camera/bad_cable.h"
#include "hardware/twin/camera/camera_twin.h"
#include "hardware/twin/camera/test_pattern.h"
#include "studies/cell_camera/cell_camera.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using testing::HasSubstr;
using testing::Not;

/// An address of this process alone. @param last  its last byte
std::uint32_t own_address(std::uint32_t last) {
  return 0x7f000000U | (static_cast<std::uint32_t>(::getpid() & 0xffff) << 8U) | last;
}

// Some hundred packets, of which none is sent again: nearly every try lacks one.
TEST(GrabbedFrames, HaveNoTimesWhereNoPictureCame) {
  const CameraTwinSettings settings = {.address = own_address(4)};
  TestPatternSource source(settings.sensor_width_px, settings.sensor_height_px);
  const CameraTwin twin(settings, source);
  BadCable cable(settings.address, own_address(5));
  const TemporaryFolder folder;
  Cell cell;
  cell.camera =
      CellCamera{.address = ipv4_text(own_address(5)), .exposure_s = 0.001, .packet_bytes = 9000};
  const auto result =
      grab_pictures(cell, {.count = 2, .out = folder / "grab"}, [&cable](int number, const Frame&) {
        if (number == 0) {
          cable.set_faults({.dropped = 0.05, .answers_resend = false});
        }
      });
  const auto& frames = result["frames"];
  ASSERT_EQ(frames[0]["status"], "complete");
  EXPECT_THAT(frames[0]["host_time"].get<std::string>(), HasSubstr("T"));
  EXPECT_GT(frames[0]["camera_time_ns"], 0);
  ASSERT_EQ(frames[1]["status"], "incomplete");
  EXPECT_TRUE(frames[1]["host_time"].is_null());
  EXPECT_TRUE(frames[1]["camera_time_ns"].is_null());
  const std::string table = read_file(folder / "grab/frames.csv");
  EXPECT_THAT(table, HasSubstr("incomplete,"));
  EXPECT_THAT(table, Not(HasSubstr("1970")));
}

}  // namespace
}  // namespace glint

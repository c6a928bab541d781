// SPDX-License-Identifier: GPL-3.0-or-later
//
// What `glint cell grab` tells of pictures that did not come, and what a camera's twin without its
// robot shows.
#include <unistd.h>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "hardware/camera/aravis_camera.h"
#include "hardware/gige/udp_socket.h"
#include "hardware/robot/twin_proof.h"
#include "hardware/robot/ur_settings.h"
#include "hardware/twin/camera/bad_cable.h"
#include "hardware/twin/camera/camera_twin.h"
#include "hardware/twin/camera/test_pattern.h"
#include "studies/cell_camera/cell_camera.h"
#include "studies/twin_cell/cell_renderer.h"
#include "studies/twin_cell/cell_twins.h"
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

// The camera of this address does not answer: nothing is asked of it.
TEST(GrabbedFrames, OfAnEarlierCallAreKept) {
  const TemporaryFolder folder;
  Cell cell;
  cell.camera = CellCamera{.address = "127.99.99.99"};
  const auto problem = [&](const char* out) {
    return text_thrown_by<ConfigError>([&] { grab_pictures(cell, {.out = folder / out}); });
  };
  make_folder(folder / "grab/sequence");
  write_file(folder / "grab/run.json", R"({"verb": "cell grab"})");
  EXPECT_THAT(problem("grab"), HasSubstr("grab: holds pictures that were grabbed before; choose"));
  make_folder(folder / "mine/sequence");
  EXPECT_THAT(problem("mine"),
              HasSubstr("mine: holds a sequence that is not of `glint cell grab`"));
}

/// The gallery's cell with an arm whose joints are off by 0.05 degree: some pixels.
Cell cell_with_joint_errors(const TemporaryFolder& folder) {
  const auto gallery = std::filesystem::path(GLINT_SOURCE_DIR) / "studies/gallery/twin_cell";
  write_file(folder / "truth.toml",
             read_file(gallery / "truth.toml") + "\njoint_noise_deg = 0.05\n");
  write_file(folder / "cell.toml",
             fmt::format("include = [\"{}\"]\n[twin]\ntruth = \"{}\"\n",
                         (gallery / "cell.toml").string(),
                         (folder / "truth.toml").string()));
  return read_cell(folder / "cell.toml");
}

// Only the bar is on when the ring has been switched off, and the error of the joints is drawn by
// that.
TEST(CameraTwinAlone, HasTheJointErrorOfTheLightsThatAreOn) {
  const TemporaryFolder folder;
  const Cell cell = cell_with_joint_errors(folder);
  const ServingTwins twins = camera_twin_of(cell, {.is_free = true}, 2);
  const auto described = twins.front()->description();
  ASSERT_EQ(ask_side_channel(described["side_channel"].get<std::string>(), "light ring off"), "ok");
  AravisCamera camera(described["address"].get<std::string>());
  camera.configure({.exposure_us = 5000.0, .packet_size = 9000});
  camera.start();
  const Frame frame = camera.capture();
  ASSERT_TRUE(frame.is_complete()) << frame.what;
  const Truth truth = read_truth(truth_file_of(cell));
  const Arm arm = arm_with_tool(robot_of(cell), cell.limits).arm;
  const JointVector joints_rad =
      Eigen::Map<const JointVector>(safe_position_of(cell, "").joints_rad.data());
  ThreadPool pool(2);
  CellRenderer renderer(truth, pool);
  const auto with_error_under = [&](const std::vector<std::string>& lights) {
    return renderer.render({.base_from_flange = transform_of(arm.forward(joints_rad)),
                            .lights = {"bar"},
                            .joint_error = joint_error_of(truth.settings, arm, joints_rad, lights)},
                           {.exposure_us = 5000.0});
  };
  EXPECT_EQ(frame.codes, with_error_under({"bar"}));
  EXPECT_NE(frame.codes, with_error_under({"ring", "bar"}));
}

}  // namespace
}  // namespace glint

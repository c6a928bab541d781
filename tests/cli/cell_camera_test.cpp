// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint cell` with the twins of a camera and a robot, from beginning to end.
#include <chrono>
#include <filesystem>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "hardware/robot/twin_proof.h"
#include "hardware/twin/side_channel/side_channel.h"
#include "tests/cli/counting_peer.h"
#include "tests/cli/program.h"
#include "tests/cli/served_twins.h"
#include "tests/support/loopback_listener.h"
#include "tests/support/process_sockets.h"

namespace glint::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const std::filesystem::path kGallery =
    std::filesystem::path(GLINT_SOURCE_DIR) / "studies/gallery/twin_cell";

/// A call on the twins of a folder.
json call(const TemporaryFolder& folder, Arguments arguments) {
  for (const char* word : {"--twin", "twin.json"}) {
    arguments.emplace_back(word);
  }
  return json_of(folder, arguments);
}

/// Sockets that nobody else on the network can reach.
/// @param udp, listening  how many there are
void expect_loopback_alone(const ServedTwins& twins, int udp, int listening) {
  for (const ProcessSocket& socket : sockets_of(twins.process())) {
    EXPECT_TRUE(socket.is_on_loopback()) << socket.text();
    udp -= socket.table == "udp" ? 1 : 0;
    listening -= socket.is_listening ? 1 : 0;
  }
  EXPECT_EQ(udp, 0) << "fewer or more";
  EXPECT_EQ(listening, 0) << "fewer or more";
}

/// What reads pictures has nothing to say to a robot, though the cell has one. Features of the cell
/// file reach the camera, which stays a twin when they give it another name.
/// @param mean_grey  of the picture without them
void expect_list_and_grab_call_no_robot(const TemporaryFolder& folder,
                                        const std::string& cell,
                                        const ServedTwins& twins,
                                        double mean_grey) {
  const CountingRobot counted;
  const std::string camera_address = twins.of("camera")["address"];
  write_file(folder / "counted.toml",
             fmt::format("include = [\"{}\"]\n[camera]\naddress = \"{}\"\n"
                         "[camera.features]\nBlackLevel = 220.75\n"
                         "DeviceUserID = \"line 3\"\n[robot]\nrtde_port = {}\n"
                         "primary_port = {}\nsecondary_port = {}\ndashboard_port = {}\n",
                         cell,
                         camera_address,
                         counted.rtde.port(),
                         counted.primary.port(),
                         counted.secondary.port(),
                         counted.dashboard.port()));
  const json grabbed = json_of(folder, {"cell", "grab", "counted.toml", "--out", "counted"});
  EXPECT_EQ(grabbed["complete"], 1);
  EXPECT_NEAR(grabbed["frames"][0]["mean_grey"].get<double>(), mean_grey + 0.05, 0.005);
  const int closed = LoopbackListener().port();
  const SideChannel alone(twin_socket_path(closed), [](const std::string&) { return "5"; });
  const json list = json_of(folder, {"cell", "list"});
  bool is_listed = false;
  for (const json& camera : list["cameras"]) {
    is_listed = is_listed || (camera["address"] == camera_address &&
                              camera["user_name"] == "line 3" && camera["twin"] == true);
  }
  EXPECT_TRUE(is_listed) << list;
  const json robot = {
      {"address", "127.0.0.1"}, {"rtde_port", twins.of("robot")["rtde_port"]}, {"twin", true}};
  EXPECT_THAT(list["robots"], testing::Contains(robot));
  const json unproven = {{"address", "127.0.0.1"}, {"rtde_port", closed}, {"twin", true}};
  EXPECT_THAT(list["robots"], testing::Not(testing::Contains(unproven)));
  counted.expect_not_called();
}

/// A ready file of the same twins, of which this one is another process's.
std::string ready_with_another(const TemporaryFolder& folder, const std::string& kind) {
  json ready = json::parse(read_file(folder / "twin.json"));
  for (json& twin : ready["twins"]) {
    twin["token"] = twin["token"].get<std::uint64_t>() - (twin["kind"] == kind ? 1U : 0U);
  }
  write_file(folder / (kind + ".json"), ready.dump());
  return kind + ".json";
}

Arguments acquired_by(const std::string& cell, const std::string& twins, const std::string& out) {
  return {
      "acquire", "--cell", cell, "--twin", twins, "--move", "--out", out, "--confirmed", "ring"};
}

// As ready files of twins that have ended, whose addresses others have taken.
void expect_other_twins_are_left_alone(const TemporaryFolder& folder, const std::string& cell) {
  const std::string camera = ready_with_another(folder, "camera");
  const std::string stage = ready_with_another(folder, "stage");
  const std::vector<ProgramResult> results = glint_at_once(
      folder,
      std::vector<Arguments>{{"cell", "grab", cell, "--twin", camera, "--out", "none"},
                             acquired_by(cell, camera, "none"),
                             acquired_by(cell, stage, "nothing"),
                             {"cell", "twin", "light", camera, "ring", "off"}});
  for (const ProgramResult& result : results) {
    EXPECT_EQ(result.code, 3) << result.out << result.err;
    EXPECT_THAT(result.err, HasSubstr("another twin"));
  }
}

std::string told(const ServedTwins& twins, const std::string& line) {
  return ask_side_channel(twins.of("camera")["side_channel"].get<std::string>(), line)
      .value_or("nothing");
}

/// A person switches the ring off, and the camera has a picture of that.
/// @return the mean grey of one
double mean_grey_without_ring(const TemporaryFolder& folder,
                              const ServedTwins& twins,
                              const std::string& cell) {
  const auto rendered = [&twins] { return json::parse(told(twins, "state"))["rendered"]; };
  const json before = rendered();
  const json result = json_of(folder, {"cell", "twin", "light", "twin.json", "ring", "off"});
  EXPECT_EQ(result["on"], false);
  for (int i = 0; i < 3000 && rendered() == before; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const json grabbed = call(folder, {"cell", "grab", cell, "--out", "without_ring"});
  EXPECT_EQ(grabbed["complete"], 1);
  return grabbed["frames"][0]["mean_grey"];
}

TEST(CellCamera, SeesWhatAPersonSwitches) {
  const TemporaryFolder folder;
  const std::string cell = kGallery / "cell.toml";
  const ServedTwins twins(folder, "both", cell);
  const json with_ring = call(folder, {"cell", "grab", cell, "--out", "with_ring"});
  EXPECT_LT(mean_grey_without_ring(folder, twins, cell), with_ring["frames"][0]["mean_grey"]);
  EXPECT_EQ(json_of(folder, {"cell", "twin", "light", "twin.json", "ring", "on"})["on"], true);
  EXPECT_EQ(call(folder, {"cell", "grab", cell, "--out", "again"})["complete"], 1);
  const auto picture = [&](const std::string& grab) {
    return read_file(folder / (grab + "/sequence/frame_000.png"));
  };
  EXPECT_EQ(picture("again"), picture("with_ring"));
  EXPECT_THAT(told(twins, "light bar off"), HasSubstr("no person switches a light named bar"));
  EXPECT_THAT(told(twins, "light ring dim"), HasSubstr("on or off"));
}

TEST(CellCamera, IsListedGrabbedFromAndFollowsTheArm) {
  const TemporaryFolder folder;
  const std::string cell = "cell.toml";
  write_file(folder / cell,
             fmt::format("include = [\"{0}/cell.toml\"]\n[twin]\ntruth = \"{0}/truth.toml\"\n"
                         "motion_speedup = 10\n[stage]\nhost = \"127.0.0.1\"\n",
                         kGallery.string()));
  const ServedTwins twins(folder, "both", cell);
  expect_loopback_alone(twins, 2, 5);  // of the camera; four of the robot, one of the stage
  const json above = call(folder, {"cell", "grab", cell, "--count", "3", "--out", "above"});
  EXPECT_EQ(above["complete"], 3);
  EXPECT_GT(above["frames"][0]["mean_grey"], 0.05);
  const auto picture = [&](const std::string& file) {
    return read_file(folder / (file + "/sequence/frame_000.png"));
  };
  EXPECT_EQ(picture("above"), read_file(folder / "above/sequence/frame_002.png"));
  EXPECT_EQ(call(folder, {"cell", "move", cell, "--view", "left", "--move"})["outcome"], "done");
  const json left = call(folder, {"cell", "grab", cell, "--out", "left"});
  EXPECT_EQ(left["complete"], 1);
  EXPECT_NE(picture("above"), picture("left"));
  expect_list_and_grab_call_no_robot(folder, cell, twins, left["frames"][0]["mean_grey"]);
  expect_other_twins_are_left_alone(folder, cell);
}

TEST(CellCamera, AloneStandsAtTheFirstSafePosition) {
  const TemporaryFolder folder;
  const std::string cell = kGallery / "cell.toml";
  const ServedTwins twins(folder, "camera", cell);
  const json grabbed = call(folder, {"cell", "grab", cell, "--count", "2", "--out", "grab"});
  EXPECT_EQ(grabbed["complete"], 2);
  EXPECT_EQ(grabbed["camera"]["sensor_px"], json::array({408, 342}));
  EXPECT_TRUE(std::filesystem::exists(folder / "grab/frames.csv"));
  for (const char* format : {"mono10p", "mono12p"}) {
    write_file(folder / "packed.toml",
               fmt::format("include = [\"{}\"]\n[camera]\npixel_format = \"{}\"\n", cell, format));
    const json packed = call(folder, {"cell", "grab", "packed.toml", "--out", format});
    EXPECT_EQ(packed["complete"], 1);
    EXPECT_NEAR(packed["frames"][0]["mean_grey"].get<double>(),
                grabbed["frames"][0]["mean_grey"].get<double>(),
                0.005);
  }
  EXPECT_LT(mean_grey_without_ring(folder, twins, cell), grabbed["frames"][0]["mean_grey"]);
}

TEST(CellCamera, ItsCableIsMadeBadByItsSideChannel) {
  const TemporaryFolder folder;
  const std::string cell = kGallery / "cell.toml";
  const ServedTwins twins(folder, "camera", cell, {"--cable"});
  EXPECT_EQ(told(twins, "cable dropped=0.05 delay_ms=1"), "ok");
  EXPECT_THAT(told(twins, "cable dropped=2"), HasSubstr("error"));
  expect_loopback_alone(twins, 6, 0);  // two of the camera, four of the cable
  const json grabbed = call(folder, {"cell", "grab", cell, "--count", "3", "--out", "grab"});
  EXPECT_EQ(grabbed["complete"], 3);
  EXPECT_GT(json::parse(told(twins, "state"))["cable_dropped"], 0);
}

// The file's own folder, however it is named.
TEST(CellCamera, PicturesOfACellGoWhereItsFolderIsNamed) {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder / "mine/out/mine/grab/sequence");
  write_file(folder / "mine/cell.toml", "[camera]\naddress = \"127.99.99.99\"\n");
  write_file(folder / "mine/out/mine/grab/sequence/frame_000.png", "taken before");
  const ProgramResult result = Program(folder / "mine", {"cell", "grab", "cell.toml"}).wait();
  EXPECT_EQ(result.code, 2);
  EXPECT_THAT(result.err, HasSubstr("out/mine/grab: holds"));
}

TEST(CellCamera, SlipsAreNamed) {
  const TemporaryFolder folder;
  write_file(folder / "cell.toml", "[camera]\naddress = \"127.99.99.99\"\n");
  const std::vector<ProgramResult> results = glint_at_once(
      folder,
      std::vector<Arguments>{{"cell", "grab", "cell.toml"},
                             {"cell", "twin", "camera", "cell.toml"},
                             {"cell", "list", "cell.toml"},
                             {"cell", "twin", "clock", "cell.toml"},
                             {"cell", "twin", "camera", "cell.toml", "--port", "4000"},
                             {"cell", "twin", "light", "twin.json", "ring", "dim"},
                             {"cell", "twin", "both", "cell.toml", "--port", "65532"}});
  EXPECT_EQ(results[0].code, 3);
  EXPECT_THAT(results[1].err, HasSubstr("twin.truth"));
  EXPECT_THAT(results[2].err, HasSubstr("takes no file"));
  EXPECT_THAT(results[3].err, HasSubstr("camera, robot, both, stop, place and light"));
  EXPECT_EQ(results[4].code, 2);
  EXPECT_THAT(results[4].err, HasSubstr("--port 4000: every camera listens at port 3956"));
  EXPECT_THAT(results[5].err, HasSubstr("a light that a person switches, and on or off"));
  EXPECT_EQ(results[6].code, 2);
  EXPECT_THAT(results[6].err, HasSubstr("65531"))
      << "the stage listens at the fourth port after it";
}

}  // namespace
}  // namespace glint::test

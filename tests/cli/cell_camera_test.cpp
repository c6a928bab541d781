// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint cell` with the twins of a camera and a robot, from beginning to end.
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/cli/program.h"
#include "tests/cli/served_twins.h"

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

TEST(CellCamera, IsListedGrabbedFromAndFollowsTheArm) {
  const TemporaryFolder folder;
  const std::string cell = "cell.toml";
  write_file(folder / cell,
             fmt::format("include = [\"{0}/cell.toml\"]\n[twin]\ntruth = \"{0}/truth.toml\"\n"
                         "motion_speedup = 10\n",
                         kGallery.string()));
  const ServedTwins twins(folder, "both", cell);
  const std::string address = twins.of("camera")["address"];
  const json list = json_of(folder, {"cell", "list"});
  bool is_listed = false;
  for (const json& camera : list["cameras"]) {
    is_listed = is_listed || (camera["address"] == address && camera["twin"] == true);
  }
  EXPECT_TRUE(is_listed) << list;
  const json above = call(folder, {"cell", "grab", cell, "--count", "3", "--out", "above"});
  EXPECT_EQ(above["complete"], 3);
  EXPECT_GT(above["frames"][0]["mean_grey"], 0.05);
  const auto picture = [&](const std::string& file) {
    return read_file(folder / (file + "/sequence/frame_000.png"));
  };
  EXPECT_EQ(picture("above"), read_file(folder / "above/sequence/frame_002.png"));
  EXPECT_EQ(call(folder, {"cell", "move", cell, "--view", "left", "--move"})["outcome"], "done");
  EXPECT_EQ(call(folder, {"cell", "grab", cell, "--out", "left"})["complete"], 1);
  EXPECT_NE(picture("above"), picture("left"));
}

TEST(CellCamera, AloneStandsAtTheFirstSafePosition) {
  const TemporaryFolder folder;
  const std::string cell = kGallery / "cell.toml";
  const ServedTwins twins(folder, "camera", cell);
  const json grabbed = call(folder, {"cell", "grab", cell, "--count", "2", "--out", "grab"});
  EXPECT_EQ(grabbed["complete"], 2);
  EXPECT_EQ(grabbed["camera"]["sensor_px"], json::array({408, 342}));
  EXPECT_TRUE(std::filesystem::exists(folder / "grab/frames.csv"));
}

TEST(CellCamera, SlipsAreNamed) {
  const TemporaryFolder folder;
  write_file(folder / "cell.toml", "[camera]\naddress = \"127.99.99.99\"\n");
  const std::vector<ProgramResult> results =
      glint_at_once(folder,
                    std::vector<Arguments>{{"cell", "grab", "cell.toml"},
                                           {"cell", "twin", "camera", "cell.toml"},
                                           {"cell", "list", "cell.toml"},
                                           {"cell", "twin", "clock", "cell.toml"}});
  EXPECT_EQ(results[0].code, 3);
  EXPECT_THAT(results[1].err, HasSubstr("twin.truth"));
  EXPECT_THAT(results[2].err, HasSubstr("takes no file"));
  EXPECT_THAT(results[3].err, HasSubstr("camera, robot, both, stop and place"));
}

}  // namespace
}  // namespace glint::test

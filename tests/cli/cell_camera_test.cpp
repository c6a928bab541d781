// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint cell` with the twins of a camera and a robot, from beginning to end.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/cli/program.h"

namespace glint::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

const std::filesystem::path kGallery =
    std::filesystem::path(GLINT_SOURCE_DIR) / "studies/gallery/twin_cell";

/// Serves twins on free ports and addresses until the end of a test.
class Twins {
 public:
  explicit Twins(const std::string& kind)
      : ready_(json_of(folder,
                       {"cell",
                        "twin",
                        kind,
                        kGallery / "cell.toml",
                        "--port",
                        "0",
                        "--detach",
                        "--ready_file",
                        "twin.json"})) {}

  ~Twins() { glint_in(folder, {"cell", "twin", "stop", "twin.json"}); }

  Twins(const Twins&) = delete;
  Twins& operator=(const Twins&) = delete;

  const json& of(const std::string& kind) const {
    for (const json& twin : ready_["twins"]) {
      if (twin["kind"] == kind) {
        return twin;
      }
    }
    return ready_;
  }

  json call(Arguments arguments) const {
    for (const char* word : {"--twin", "twin.json"}) {
      arguments.emplace_back(word);
    }
    return json_of(folder, arguments);
  }

  TemporaryFolder folder;

 private:
  json ready_;
};

TEST(CellCamera, IsListedGrabbedFromAndFollowsTheArm) {
  const Twins twins("both");
  const std::string address = twins.of("camera")["address"];
  const json list = json_of(twins.folder, {"cell", "list"});
  bool is_listed = false;
  for (const json& camera : list["cameras"]) {
    is_listed = is_listed || (camera["address"] == address && camera["twin"] == true);
  }
  EXPECT_TRUE(is_listed) << list;
  const std::string cell = kGallery / "cell.toml";
  const json above = twins.call({"cell", "grab", cell, "--count", "3", "--out", "above"});
  EXPECT_EQ(above["complete"], 3);
  EXPECT_GT(above["frames"][0]["mean_grey"], 0.05);
  const auto picture = [&](const std::string& file) {
    return read_file(twins.folder / (file + "/sequence/frame_000.png"));
  };
  EXPECT_EQ(picture("above"), read_file(twins.folder / "above/sequence/frame_002.png"));
  EXPECT_EQ(twins.call({"cell", "move", cell, "--view", "left", "--move"})["outcome"], "done");
  EXPECT_EQ(twins.call({"cell", "grab", cell, "--out", "left"})["complete"], 1);
  EXPECT_NE(picture("above"), picture("left"));
}

TEST(CellCamera, AloneStandsAtTheFirstSafePosition) {
  const Twins twins("camera");
  const std::string cell = kGallery / "cell.toml";
  const json grabbed = twins.call({"cell", "grab", cell, "--count", "2", "--out", "grab"});
  EXPECT_EQ(grabbed["complete"], 2);
  EXPECT_EQ(grabbed["camera"]["sensor_px"], json::array({408, 342}));
  EXPECT_TRUE(std::filesystem::exists(twins.folder / "grab/frames.csv"));
}

TEST(CellCamera, SlipsAreNamed) {
  const TemporaryFolder folder;
  write_file(folder / "cell.toml", "[camera]\naddress = \"127.99.99.99\"\n");
  EXPECT_EQ(glint_in(folder, {"cell", "grab", "cell.toml"}).code, 3);
  EXPECT_THAT(glint_in(folder, {"cell", "twin", "camera", "cell.toml"}).err,
              HasSubstr("twin.truth"));
  EXPECT_THAT(glint_in(folder, {"cell", "list", "cell.toml"}).err, HasSubstr("takes no file"));
  EXPECT_THAT(glint_in(folder, {"cell", "twin", "clock", "cell.toml"}).err,
              HasSubstr("camera, robot, both, stop and place"));
}

}  // namespace
}  // namespace glint::test

// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint acquire` of a scene that lies in the cell: pictures that are kept, and those that are not.
#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/cli/acquire/gallery_cell.h"
#include "tests/cli/program.h"
#include "tests/cli/served_twins.h"

namespace glint::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
namespace fs = std::filesystem;

class ScenePictures : public testing::Test {
 protected:
  /// The gallery's part under its ring.
  /// @param limit  a key of [acquisition]
  /// @param place  where the part really lies [mm]
  json acquired(const std::string& limit, const std::string& place = "280, -120, 20") {
    const std::string truth = edited(small_truth(), {{"280, -120, 20", place}});
    const std::size_t bar = truth.find("[lighting.bar]");
    const std::size_t render = truth.find("[render.paths]");
    const std::string scene =
        truth.substr(0, bar) + truth.substr(render, truth.find("[truth]") - render);
    write_file(folder_ / "scene.toml",
               scene +
                   "[calibration.flange_from_camera]\ntranslation_mm = [0, 50, 30]\n"
                   "sigma_mm = [0.5, 0.5, 0.5]\nsigma_deg = [0.5, 0.5, 0.5]\n"
                   "[cell.base_from_part]\ntranslation_mm = [280, -120, 20]\n"
                   "sigma_mm = [0.5, 0.5, 0.5]\n");
    write_file(folder_ / "truth.toml", truth);
    write_file(folder_ / "cell.toml",
               edited(fast_cell(),
                      {{"[lights.ring]",
                        "[acquisition]\nmost_retakes = 1\n" + limit + "\n\n[lights.ring]"}}));
    const ServedTwins twins(folder_, "both", "cell.toml");
    const ProgramResult result =
        glint_in(folder_, driving({"acquire", "scene.toml", "--out", "out"}));
    EXPECT_THAT(result.code, testing::AnyOf(0, 1)) << result.err;
    EXPECT_THAT(result.err, HasSubstr("most_retakes is called max_retakes now"));
    return json::parse(read_file(folder_ / "out/acquired.json"));
  }

  /// The picture and its retake lie apart.
  void expect_rejected(const json& told, const std::string& reason) {
    EXPECT_EQ(told["status"], "partial");
    EXPECT_EQ(told["counts"]["accepted"], 0);
    EXPECT_EQ(told["counts"]["rejected_now"], 2) << "one and a retake";
    ASSERT_EQ(told["pictures"].size(), 2U);
    for (const json& picture : told["pictures"]) {
      EXPECT_EQ(picture["accepted"], false);
      EXPECT_THAT(picture["reason"].get<std::string>(), HasSubstr(reason));
      const std::string file = picture["file"].get<std::string>();
      EXPECT_TRUE(file.starts_with("rejected/")) << file;
      EXPECT_TRUE(fs::exists(folder_ / "out" / file)) << file;
    }
    EXPECT_EQ(read_file(folder_ / "out/poses.csv").find("rejected"), std::string::npos);
  }

  TemporaryFolder folder_;
};

TEST_F(ScenePictures, AreAllKeptWhereThePartIsInItsPlace) {
  const json told = acquired("");
  EXPECT_EQ(told["status"], "complete");
  EXPECT_EQ(told["counts"]["accepted"], 1);
  EXPECT_EQ(told["counts"]["rejected_now"], 0) << told["pictures"];
  EXPECT_FALSE(fs::exists(folder_ / "out/rejected"));
}

TEST_F(ScenePictures, ThatAreTooDarkLieApartWithTheReason) {
  expect_rejected(acquired("min_bright = 0.999"), "too dark");
}

// A hand's breadth from its place the camera sees an edge of it, two hands further nothing.
TEST_F(ScenePictures, OfAPartThatLiesElsewhereAreRejected) {
  expect_rejected(acquired("min_bright = 0", "280, -80, 20"), "the part is not in view");
}

TEST_F(ScenePictures, OfNoPartAreRejected) {
  expect_rejected(acquired("", "280, 180, 20"), "too dark");
}

}  // namespace
}  // namespace glint::test

// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint compare`: pictures drawn here, and views that the program rendered.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/cli/program.h"
#include "tests/studies/compare/compare_fixture.h"

namespace glint::test {
namespace {

using Json = nlohmann::json;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;

class CompareVerb : public ::testing::Test {
 protected:
  void draw(const std::string& name, const BladeDrawing& drawing) const {
    const std::filesystem::path path = folder_ / name;
    std::filesystem::create_directories(path.parent_path());
    write_png(path, drawn_blade(drawing), PixelDepth::k16Bit);
  }

  TemporaryFolder folder_;
};

TEST_F(CompareVerb, PrintsWhatItFoundAndWritesAPage) {
  draw("simulated.png", {});
  draw("real.png", {.shift_x_px = 0.5, .gain = 1.2, .index = 1});
  const Json result = json_of(folder_, {"compare", "simulated.png", "real.png", "--out", "out"});
  EXPECT_EQ(result["status"], "done");
  ASSERT_EQ(result["pairs"].size(), 1U);
  const Json& pair = result["pairs"][0];
  EXPECT_EQ(pair["simulated"], "simulated");
  EXPECT_EQ(pair["real"], "real");
  EXPECT_GT(pair["iou"].get<double>(), 0.98);
  EXPECT_NEAR(pair["mean_distance_px"].get<double>(), 0.5 * 0.6, 0.15);
  EXPECT_NEAR(pair["exposure"]["gain"].get<double>(), 1.2, 0.02);
  EXPECT_TRUE(result["yardstick"].is_null());
  EXPECT_THAT(result["verdict"].get<std::string>(), HasSubstr("silhouettes overlap"));
  // The gain is a cause that pictures alone can tell.
  ASSERT_EQ(pair["causes"].size(), 1U);
  EXPECT_EQ(pair["causes"][0]["name"], "gain");
  EXPECT_THAT(read_file(folder_ / "out/report.html"), HasSubstr("Photograph minus simulated"));
  for (const char* name : {"result.json",
                           "run.json",
                           "pair_01/overlay.png",
                           "pair_01/simulated.png",
                           "pair_01/difference.exr"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / name)) << name;
  }
}

TEST_F(CompareVerb, MeasuresAgainstPhotographsAmongEachOther) {
  draw("simulated.png", {});
  draw("photos/1.png", {.noise = 0.01, .index = 1});
  draw("photos/2.png", {.noise = 0.012, .index = 2});
  draw("photos/3.png", {.noise = 0.014, .index = 3});
  const Json result = json_of(folder_, {"compare", "simulated.png", "photos", "--out", "out"});
  EXPECT_EQ(result["pairs"].size(), 3U);
  EXPECT_EQ(result["yardstick"]["reals"], 3);
  EXPECT_THAT(result["verdict"].get<std::string>(),
              HasSubstr("times as much as they differ from each other"));
}

TEST_F(CompareVerb, RefusesWithOneLineAndNoFolder) {
  draw("simulated.png", {});
  write_png(folder_ / "small.png", ImageF(20, 10, 0.5F), PixelDepth::k8Bit);
  const auto refused = [&](const Arguments& arguments, const std::string& message) {
    const ProgramResult result = glint_in(folder_, arguments);
    EXPECT_EQ(result.code, 2) << result.err;
    EXPECT_THAT(result.err, MatchesRegex(message + "\n"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
  };
  refused({"compare", "simulated.png", "--quiet", "--out", "out"},
          "compare needs a simulated picture and at least one real one");
  refused({"compare", "simulated.png", "small.png", "--quiet", "--out", "out"},
          "small\\.png: has one grey value all over, .*");
  refused(
      {"compare", "simulated.png", "simulated.png", "--outline", "line", "--quiet", "--out", "out"},
      "--outline: is line, must be auto, threshold, grab_cut or inner");
}

// The same bytes for any number of threads.
TEST_F(CompareVerb, WritesTheSameForAnyNumberOfThreads) {
  draw("simulated.png", {});
  draw("photos/1.png", {.shift_x_px = 0.3, .index = 1});
  draw("photos/2.png", {.scale = 1.01, .index = 2});
  for (const char* threads : {"1", "3"}) {
    json_of(folder_,
            {"compare",
             "simulated.png",
             "photos",
             "--threads",
             threads,
             "--out",
             std::string("out") + threads});
  }
  expect_same_files(folder_ / "out1", folder_ / "out3");
}

}  // namespace
}  // namespace glint::test

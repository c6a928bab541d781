// SPDX-License-Identifier: GPL-3.0-or-later
//
// The pages of every verb in a browser: they draw themselves, and no text of theirs is markup.
#include <array>
#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/image/image_io.h"
#include "tests/cli/program.h"
#include "tests/cli/ring_or_bar.h"
#include "tests/studies/compare/compare_fixture.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using Json = nlohmann::ordered_json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kBrowser = "chromium";

/// What a command writes to its stdout.
std::string output_of(const std::string& command) {
  std::FILE* pipe = popen(command.c_str(), "r");
  std::string text;
  std::array<char, 4096> block{};
  for (std::size_t count = 0; (count = std::fread(block.data(), 1, block.size(), pipe)) > 0;) {
    text.append(block.data(), count);
  }
  pclose(pipe);
  return text;
}

/// What tests/cli/printed_page.mjs tells of a page on paper.
Json printed(const std::filesystem::path& page) {
  const std::string command =
      fmt::format("node '" GLINT_SOURCE_DIR "/tests/cli/printed_page.mjs' {} '{}'",
                  kBrowser,
                  fs::absolute(page).string());
  const std::string text = output_of(command);
  return Json::parse(text, nullptr, false);
}

class Page : public ::testing::Test {
 protected:
  void SetUp() override {
    if (std::system((std::string("command -v ") + kBrowser + " >/dev/null").c_str()) != 0) {
      GTEST_SKIP() << "there is no Chromium; script/bootstrap --browser installs it";
    }
  }

  void glint(const Arguments& arguments) const {
    const ProgramResult result = glint_in(folder_, arguments);
    ASSERT_EQ(result.code, 0) << result.err;
  }

  /// The page as the browser has drawn it, after what the browser has to say.
  std::string drawn(const std::string& page) const {
    const std::string command = fmt::format(
        "{} --headless --no-sandbox --disable-gpu --enable-logging=stderr "
        "--user-data-dir='{}' --virtual-time-budget=10000 --dump-dom 'file://{}' 2>&1",
        kBrowser,
        (folder_ / "browser").string(),
        fs::absolute(folder_ / page).string());
    const std::string text = output_of(command);
    EXPECT_THAT(text, Not(HasSubstr("Uncaught"))) << page;
    EXPECT_THAT(text, Not(HasSubstr("Content Security Policy"))) << page;
    return text.substr(0, text.find("id=\"data\""));  // without the data, which hold every text
  }

  /// On paper nothing lies over anything.
  void expect_printed(const std::string& page, int max_pages) const {
    const Json paper = printed(folder_ / page);
    ASSERT_TRUE(paper.is_object()) << page;
    EXPECT_LE(paper["pages"], max_pages) << page;
    EXPECT_GT(paper["boxes"], 20) << page;
    EXPECT_EQ(paper["overlaps"], Json::array()) << page;
  }

  TemporaryFolder folder_;
};

TEST_F(Page, OfAComparisonIsDrawn) {
  write_png(folder_ / "s.png", drawn_blade(), PixelDepth::k16Bit);
  write_png(folder_ / "a.png",
            drawn_blade({.shift_x_px = 0.5, .gain = 1.2, .index = 1}),
            PixelDepth::k16Bit);
  write_png(folder_ / "b.png", drawn_blade({.noise = 0.02, .index = 2}), PixelDepth::k16Bit);
  glint({"compare", "s.png", "a.png", "b.png", "--quiet", "--out", "compared"});
  EXPECT_THAT(drawn("compared/report.html"),
              AllOf(HasSubstr("<h2>Pairs</h2>"),
                    HasSubstr("<h4>Causes</h4>"),
                    HasSubstr("<h4>Region by region</h4>"),
                    HasSubstr("Offset of edges against the radius"),
                    HasSubstr("Photographs among each other"),
                    HasSubstr("class=\"blink\">Blink</button>"),
                    HasSubstr("<input type=\"range\""),
                    HasSubstr("of full scale</span>"),
                    HasSubstr("<path")));
  expect_printed("compared/report.html", 6);
}

TEST_F(Page, OfACoverageIsDrawn) {
  const std::string scene =
      std::string(GLINT_SOURCE_DIR) + "/studies/gallery/viewpoints/scene.toml";
  glint({"cover",
         scene,
         "--quiet",
         "--set",
         "camera.width_px=153",
         "--set",
         "camera.height_px=128",
         "--set",
         "camera.pixel_um=55.2",
         "--out",
         "covered"});
  EXPECT_THAT(drawn("covered/report.html"),
              AllOf(HasSubstr("The part, coloured by what inspects it"),
                    HasSubstr("What each view adds"),
                    HasSubstr("<img")));
  expect_printed("covered/report.html", 4);
}

TEST_F(Page, OfARunAndOfItsInspectionIsDrawn) {
  write_file(folder_ / "study.toml", small_study());
  glint({"run", "study.toml", "--quiet", "--out", "run"});
  EXPECT_THAT(drawn("run/report.html"),
              AllOf(HasSubstr("<h2>Convergence</h2>"), HasSubstr("<path")));
  glint({"inspect", "run", "--quiet", "--out", "inspected"});
  EXPECT_THAT(drawn("inspected/report.html"),
              AllOf(HasSubstr("<h2>What was found</h2>"),
                    HasSubstr("Pixels by response"),
                    HasSubstr("<polygon")));
}

// Baseline, winner and three prototypes, with all their scores, folded, and a resolved TOML.
TEST_F(Page, OfFiveDesignsIsPrintedOnSixPagesWithNothingOverNothing) {
  write_file(
      folder_ / "study.toml",
      small_study() +
          "[defects.bumps]\ntype = \"bump\"\nx_mm = [-9, -5, 6, 9]\ny_mm = [1, -2, 2, -1]\n"
          "height_um = 5\ndiameter_mm = 1.5\n"
          "[prototypes.flat]\ntitle = \"Flat panels\"\n\"lighting.tunnel.shape\" = \"flat\"\n"
          "[prototypes.wide]\n\"lighting.tunnel.radius_mm\" = 110\n"
          "[prototypes.free]\ntitle = \"A free wall\"\n\"lighting.tunnel.shape\" = \"free\"\n");
  glint({"run", "study.toml", "--quiet", "--out", "run"});
  const Json paper = printed(folder_ / "run/report.html");
  ASSERT_TRUE(paper.is_object());
  EXPECT_GE(paper["pages"], 2);
  EXPECT_LE(paper["pages"], 6);
  EXPECT_GT(paper["boxes"], 300);
  EXPECT_EQ(paper["overlaps"], Json::array());
}

constexpr const char* kTwoObjectives = R"(schema = 1
[camera]
width_px = 96
height_px = 48
object_pixel_mm = 0.8
[part]
length_mm = 60
width_mm = 30
[sensor]
full_well_e = 5000
read_noise_e = 10
[scan]
positions = 6
[defects.dent]
x_mm = [5, -10]
y_mm = [2, -4]
diameter_mm = 8
height_um = 40
[lighting.tunnel]
shape = "semicylinder"
radius_mm = 150
[prototypes.flat]
title = "Flat panels"
"lighting.tunnel.shape" = "flat"
[variables]
"lighting.tunnel.radius_mm" = { min = 120, max = 240 }
"lighting.tunnel.duty" = { min = 0.2, max = 0.8 }
[[objective]]
maximise = "homogeneity.h_rms"
[[objective]]
maximise = "defects.min_cnr"
[constraints]
"homogeneity.clipped_share" = { max = 1 }
[manufacture]
"lighting.tunnel.slot_mm" = { plus_minus = 0.5 }
[budget]
evaluations = 24
)";

TEST_F(Page, OfSeveralObjectivesIsDrawnAndPrintedOnEightPagesWithNothingOverNothing) {
  write_file(folder_ / "study.toml", kTwoObjectives);
  glint({"run", "study.toml", "--quiet", "--out", "run"});
  glint({"report", "run", "--analyse", "--evaluate", "24", "--out", "analysed.html"});
  EXPECT_THAT(drawn("analysed.html"),
              AllOf(HasSubstr("<h2>The front</h2>"),
                    HasSubstr("<h2>Designs of the front</h2>"),
                    HasSubstr("<h2>Hypervolume</h2>"),
                    HasSubstr("<h2>As it will be built</h2>"),
                    HasSubstr("<h2>What matters</h2>"),
                    HasSubstr("aria-label=\"Objective\"")));
  const Json paper = printed(folder_ / "analysed.html");
  ASSERT_TRUE(paper.is_object());
  EXPECT_GE(paper["pages"], 3);
  EXPECT_LE(paper["pages"], 8);
  EXPECT_EQ(paper["overlaps"], Json::array());
}

// Two texts and a drawing over each other: the test above would see it.
TEST_F(Page, OverlapsAreSeen) {
  write_file(folder_ / "bad.html",
             "<main><p style='position:absolute;top:20px'>one sentence</p>"
             "<p style='position:absolute;top:25px'>another one</p></main>");
  const Json paper = printed(folder_ / "bad.html");
  ASSERT_TRUE(paper.is_object());
  EXPECT_EQ(paper["pages"], 1);
  EXPECT_NE(paper["overlaps"], Json::array());
}

TEST_F(Page, TakesNamesOfFilesForText) {
  const std::string name = "<i onclick=x>";
  fs::create_directories(folder_ / name);
  ImageF picture(64, 48);
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 64; ++x) {
      picture(x, y) = 0.5F + 0.01F * static_cast<float>((7 * x + 13 * y) % 5);
    }
  }
  write_png(folder_ / name / "a.png", picture, PixelDepth::k8Bit);
  glint({"inspect", name, "--quiet", "--out", "out"});
  EXPECT_THAT(drawn("out/report.html"),
              AllOf(HasSubstr("&lt;i onclick=x&gt;"), Not(HasSubstr("<i onclick=\"x\">"))));
}

TEST_F(Page, OfPopulationsIsDrawn) {
  const std::string gallery = GLINT_SOURCE_DIR "/studies/gallery/";
  glint({"run",
         gallery + "sort_parts/study.toml",
         "--quiet",
         "--out",
         "sorted",
         "--set",
         "sorting.parts=8",
         "--set",
         "sorting.flawless=2",
         "--set",
         "sorting.prototype_parts=4",
         "--set",
         "sorting.prototype_flawless=2"});
  EXPECT_THAT(drawn("sorted/report.html"),
              AllOf(HasSubstr("How sorting moves"), HasSubstr("Perfect below")));
  glint({"run",
         gallery + "pod/study.toml",
         "--quiet",
         "--out",
         "pod",
         "--set",
         "pod.levels=4",
         "--set",
         "pod.parts=2",
         "--set",
         "pod.flawless=2",
         "--set",
         "pod.prototype_flawless=2"});
  EXPECT_THAT(drawn("pod/report.html"),
              AllOf(HasSubstr("How surely a dent is found"), HasSubstr("depth of the defect")));
}

TEST_F(Page, OfAValidationIsDrawn) {
  write_file(folder_ / "study.toml", kRingOrBar + R"([objective]
maximise = "defects.min_cnr"
[validate]
)");
  glint({"run", "study.toml", "--quiet", "--out", "run"});
  for (const char* name : {"ring", "bar"}) {
    glint({"render",
           std::string("run/") + name + "/scene.toml",
           "--set",
           "sensor.seed=9",
           "--quiet",
           "--out",
           std::string("photos/") + name});
  }
  glint({"validate", "run", "--pictures", "photos", "--refit", "--quiet", "--out", "validated"});
  EXPECT_THAT(drawn("validated/report.html"),
              AllOf(HasSubstr("<h2>Where the misfit comes from</h2>"),
                    HasSubstr("<h2>Designs on both sides</h2>"),
                    HasSubstr("The winner stays"),
                    HasSubstr("overlay of")));
}

TEST_F(Page, OfRenderedViewsIsDrawn) {
  write_file(
      folder_ / "scene.toml",
      "title = \"A <b>plate</b>\"\n[part]\nshape = \"plate\"\nlength_mm = 16\nwidth_mm = 12\n"
      "[camera]\nwidth_px = 60\nheight_px = 45\nobject_pixel_mm = 0.3\n"
      "working_distance_mm = 100\n[render.paths]\nsamples = 4\n"
      "[lighting.ring]\ntype = \"ring\"\nmount = \"camera\"\n"
      "[defects.dent]\ndiameter_mm = 3\nheight_um = 100\n");
  glint({"render", "scene.toml", "--quiet", "--out", "out"});
  EXPECT_THAT(drawn("out/report.html"),
              AllOf(HasSubstr("<h1>A &lt;b&gt;plate&lt;/b&gt;</h1>"),
                    HasSubstr("1 defect in view."),
                    HasSubstr("<h3>Scores of the first view</h3>")));
}

}  // namespace
}  // namespace glint::test

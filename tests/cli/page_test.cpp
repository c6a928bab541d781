// SPDX-License-Identifier: GPL-3.0-or-later
//
// The pages of every verb in a browser: they draw themselves, and no text of theirs is markup.
#include <array>
#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/image/image_io.h"
#include "tests/cli/program.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kBrowser = "chromium";

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
    std::FILE* pipe = popen(command.c_str(), "r");
    std::string text;
    std::array<char, 4096> block{};
    for (std::size_t count = 0; (count = std::fread(block.data(), 1, block.size(), pipe)) > 0;) {
      text.append(block.data(), count);
    }
    pclose(pipe);
    EXPECT_THAT(text, Not(HasSubstr("Uncaught"))) << page;
    EXPECT_THAT(text, Not(HasSubstr("Content Security Policy"))) << page;
    return text.substr(0, text.find("id=\"data\""));  // without the data, which hold every text
  }

  TemporaryFolder folder_;
};

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
                    HasSubstr("<h2>Scores of the first view</h2>")));
}

}  // namespace
}  // namespace glint::test

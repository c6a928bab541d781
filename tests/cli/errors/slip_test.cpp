// SPDX-License-Identifier: GPL-3.0-or-later
//
// Slips of the hand: no file of the user's and no earlier result is lost by them.
#include <cstdlib>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "tests/cli/imprint_fixture.h"
#include "tests/cli/inspect_fixture.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using ::testing::HasSubstr;
using ::testing::Not;

/// gear.toml, that can be run, rendered and imprinted, beside a mesh and a report of the user's
/// own.
class Slip : public ImprintVerb {
 protected:
  void SetUp() override {
    write_file(folder_ / "gear.toml", small_study());
    write_file(folder_ / "shaft.toml", kShaft);
    write_file(folder_ / "plate.stl", rectangle_stl(40, 12));
    before_ = files_below(folder_.path());
  }

  ProgramResult glint(Arguments arguments) const {
    arguments.emplace_back("--quiet");
    return glint_in(folder_, arguments);
  }

  void expect_done(const Arguments& arguments) const {
    const ProgramResult result = glint(arguments);
    EXPECT_EQ(result.code, 0) << result.err;
  }

  /// Nothing is written.
  void expect_refused(const Arguments& arguments, const std::string& message) const {
    const auto before = files_below(folder_.path());
    const ProgramResult result = glint(arguments);
    EXPECT_EQ(result.code, 2) << arguments.front();
    EXPECT_THAT(result.err, HasSubstr(message));
    EXPECT_EQ(files_below(folder_.path()), before) << arguments.front();
  }

  /// A folder of results as run.json tells it.
  void tell_source(const std::string& folder,
                   const std::string& verb,
                   const std::string& source) const {
    fs::create_directories(folder_ / folder);
    write_file(folder_ / folder / "run.json",
               R"({"verb": ")" + verb + R"(", "source": )" + source + "}");
  }

  std::map<std::string, std::string> before_;
};

TEST_F(Slip, ReportReplacesReportsOnly) {
  expect_done({"run", "gear.toml", "--out", "run"});
  expect_refused({"report", "run", "--out", "gear.toml"},
                 "gear.toml: exists and is no report of glint");
  expect_done({"report", "run", "--out", "page.html"});
  expect_done({"report", "run", "--out", "page.html"});
  expect_done({"report", "run"});
  write_file(folder_ / "run/report.html", "<p>mine</p>");
  expect_refused({"report", "run"}, "run/report.html: exists and is no report of glint");
}

TEST_F(Slip, PartIsNotWrittenOverAFile) {
  expect_refused({"part", "plate.stl", "--out", "plate.stl"}, "plate.stl: exists already");
  write_file(folder_ / "other.ply", "mine");
  expect_refused({"part", "plate.stl", "--out", "other.ply"}, "other.ply: exists already");
}

TEST_F(Slip, LogIsAddedToLogsOnly) {
  expect_refused({"check", "gear.toml", "--log", "gear.toml"},
                 "gear.toml: exists and is no log of glint");
  const ProgramResult nowhere = glint({"check", "gear.toml", "--log", "no/where/x.log"});
  EXPECT_EQ(nowhere.code, 3);
  EXPECT_THAT(nowhere.err,
              HasSubstr("no/where/x.log: the log cannot be written: there is no folder"));
  EXPECT_EQ(files_below(folder_.path()), before_);
  expect_done({"run", "gear.toml", "--out", "run", "--log", "run.log"});
  expect_done({"run", "gear.toml", "--out", "run", "--log", "run.log"});
}

TEST_F(Slip, VerbsRefuseTheFoldersOfOthers) {
  write_png(folder_ / "photo.png", ImageF(40, 30, 0.5F), PixelDepth::k8Bit);
  const std::vector<std::pair<std::string, Arguments>> verbs = {
      {"run", {"run", "gear.toml"}},
      {"render", {"render", "gear.toml"}},
      {"imprint", {"imprint", "shaft.toml", "--no_previews"}},
      {"imprint --preview_tools", {"imprint", "shaft.toml", "--preview_tools"}},
      {"inspect", {"inspect", "photo.png"}},
      {"frontier", {"frontier", "gear.toml"}}};
  for (const auto& [name, arguments] : verbs) {
    if (name != "frontier") {  // takes seconds, and has a test of its own
      Arguments first = arguments;
      first.insert(first.end(), {"--out", name});
      expect_done(first);
    }
  }
  // Each verb in the folder of the one before it, and `run` in that of `render`; in all folders of
  // others where cli_long asks for it.
  const bool is_whole = std::getenv("GLINT_ALL_CALLS") != nullptr;
  for (std::size_t owner = 0; owner + 1 < verbs.size(); ++owner) {
    for (std::size_t other = 0; other < verbs.size(); ++other) {
      const bool is_next = other == owner + 1 || (owner == 1 && other == 0);
      const bool is_of_run = owner == 0 && verbs[other].first == "frontier";  // in its report
      if (owner != other && !is_of_run && (is_next || is_whole)) {
        const std::string& of = verbs[owner].first;
        Arguments second = verbs[other].second;
        second.insert(second.end(), {"--out", of});
        expect_refused(second, of + ": holds results of `glint " + of + "`");
      }
    }
  }
}

TEST_F(Slip, VerbsRefuseTheFoldersOfOtherStudies) {
  write_file(folder_ / "other.toml", small_study());
  write_file(folder_ / "axle.toml", kShaft);
  const std::string of_gear = ": holds results of `glint run` of gear; choose another";
  expect_done({"run", "gear.toml", "--out", "gear/run"});
  expect_refused({"frontier", "other.toml", "--out", "gear/run"}, "gear/run" + of_gear);
  expect_refused({"frontier", "other.toml", "--inspector", "--out", "gear/run"}, of_gear);
  expect_refused({"frontier", "other.toml", "--search", "--out", "gear/run"}, of_gear);
  expect_done({"frontier",
               "gear/run/study.resolved.toml",
               "--inspector",
               "--budget",
               "1s",
               "--out",
               "gear/run"});
  expect_done({"imprint", "shaft.toml", "--preview_tools", "--out", "tools"});
  expect_done({"imprint", "shaft.toml", "--preview_tools", "--out", "tools"});
  expect_refused({"imprint", "axle.toml", "--preview_tools", "--out", "tools"},
                 "tools: holds results of `glint imprint --preview_tools` of shaft");
}

TEST_F(Slip, VerbsLeaveForeignFilesAlone) {
  write_png(folder_ / "photo.png", ImageF(40, 30, 0.5F), PixelDepth::k8Bit);
  const std::vector<std::pair<Arguments, std::string>> verbs = {
      {{"run", "gear.toml"}, "report.html"},
      {{"run", "gear.toml"}, "sorting_sizes.json"},
      {{"run", "gear.toml"}, "pod_curves.json"},
      {{"render", "gear.toml"}, "report.html"},
      {{"imprint", "shaft.toml"}, "part.stl"},
      {{"imprint", "shaft.toml", "--count", "2"}, "parts.json"},
      {{"imprint", "shaft.toml", "--preview_tools"}, "tools.png"},
      {{"inspect", "photo.png"}, "defects.csv"},
      {{"frontier", "gear.toml"}, "frontier.svg"}};
  for (const auto& [arguments, file] : verbs) {
    const fs::path folder = folder_ / "mine";
    fs::create_directories(folder);
    write_file(folder / file, "mine");
    Arguments into = arguments;
    into.insert(into.end(), {"--out", "mine"});
    expect_refused(into, "mine: holds a " + file + " that is not of `glint " + arguments.front());
    fs::remove_all(folder);
  }
}

TEST_F(Slip, InputsAreNeverOutputs) {
  expect_done({"render", "gear.toml", "--out", "pictures"});
  expect_refused({"render", "pictures/baseline/scene.toml", "--out", "pictures"},
                 "pictures/baseline/scene.toml: is read, and lies where results are written");
  expect_refused({"run", "pictures/study.resolved.toml", "--out", "pictures"},
                 "pictures: holds results of `glint render`");
}

TEST_F(Slip, EachVerbHasADefaultFolderOfItsOwn) {
  expect_done({"run", "gear.toml"});
  fs::create_directories(folder_ / "copy");
  fs::copy_file(folder_ / "gear.toml", folder_ / "copy/gear.toml");
  expect_refused({"run", "copy/gear.toml"},
                 "out/gear/run: holds results of gear.toml; choose another folder with --out");
  expect_done({"render", "gear.toml"});
  expect_done({"imprint", "shaft.toml", "--no_previews"});
  expect_done({"imprint", "shaft.toml", "--preview_tools"});
  expect_done({"inspect", "out/gear/run"});
  expect_done({"render", "out/gear/run/winner/scene.toml"});
  for (const char* file : {"out/gear/run/study.sqlite",
                           "out/gear/render/baseline/aspect.png",
                           "out/shaft/imprint/part.stl",
                           "out/shaft/tools/tools.png",
                           "out/gear/inspect/winner/overlay.png",
                           "out/gear_winner/render/baseline/aspect.png"}) {
    EXPECT_TRUE(fs::exists(folder_ / file)) << file;
  }
}

// Both cameras' folders are called "pictures", and so is that of the results.
TEST_F(Slip, FoldersOfPicturesWithOneNameAreNotMixed) {
  write_file(folder_ / "camera.toml", "[camera]\nwidth_px = 64\nheight_px = 48\nfocal_x_px = 90\n");
  for (const char* side : {"left", "right"}) {
    fs::create_directories(folder_ / side / "pictures");
    write_png(folder_ / side / "pictures/a.png", ImageF(64, 48, 0.5F), PixelDepth::k8Bit);
  }
  const auto undistort = [](const std::string& side) {
    return Arguments{"undistort", side + "/pictures/a.png", "--camera", "camera.toml"};
  };
  expect_done(undistort("left"));
  expect_refused(undistort("right"),
                 "out/pictures/undistort: holds results of left/pictures; choose another folder");
  expect_done(undistort("left"));
}

// Both studies are called "gear", and so are their folders.
TEST_F(Slip, StudiesOfOneNameAreNotMixed) {
  for (const char* side : {"left", "right"}) {
    fs::create_directories(folder_ / side);
    write_file(folder_ / side / "gear.toml", small_study());
  }
  const std::string of_left = ": holds results of left/gear.toml; choose another folder with --out";
  expect_done({"render", "left/gear.toml"});
  expect_refused({"render", "right/gear.toml"}, "out/gear/render" + of_left);
  expect_done({"render", "right/gear.toml", "--out", "out/gear/render"});
  for (const std::string verb : {"run", "cover", "imprint"}) {
    tell_source("out/gear/" + verb, verb, R"("../../../left/gear.toml")");
    expect_refused({verb, "right/gear.toml"}, "out/gear/" + verb + of_left);
  }
}

TEST_F(Slip, PicturesOfOneNameAreNotMixed) {
  for (const char* side : {"left", "right"}) {
    fs::create_directories(folder_ / side);
    write_png(folder_ / side / "photo.png", ImageF(40, 30, 0.5F), PixelDepth::k8Bit);
  }
  tell_source("out/photo/inspect", "inspect", R"("../../../left/photo.png")");
  expect_refused({"inspect", "right/photo.png"},
                 "out/photo/inspect: holds results of left/photo.png; choose another folder");
  tell_source("out/photo/compare", "compare", R"(["../../../right/photo.png", "../../../right"])");
  expect_refused({"compare", "right/photo.png", "left/photo.png"},
                 "out/photo/compare: holds results of right/photo.png and right; choose another");
  tell_source("out/photo/compare", "compare", R"(["../../../right/photo.png", "../../../left"])");
  EXPECT_THAT(glint({"compare", "right/photo.png", "left/photo.png"}).err,
              Not(HasSubstr("holds results of")))
      << "of several photographs";
}

TEST_F(Slip, ARunInTheFormerDefaultFolderIsResumed) {
  expect_done({"run", "gear.toml", "--out", "out/gear"});
  const auto before = files_below(folder_ / "out/gear");
  const auto result =
      nlohmann::json::parse(glint_in(folder_, {"run", "gear.toml", "--quiet", "--json"}).out);
  EXPECT_EQ(result["report"], "out/gear/report.html");
  EXPECT_FALSE(fs::exists(folder_ / "out/gear/run"));
  EXPECT_EQ(files_below(folder_ / "out/gear"), before);
  const auto run = nlohmann::json::parse(read_file(folder_ / "out/gear/run.json"));
  EXPECT_GT(run["timings"]["replayed_evaluations"], 0);
}

TEST_F(InspectVerb, DoesNotMixTwoInspections) {
  write_part("a");
  write_part("b", false);
  inspect_json({"a"});
  const auto before = files_below(folder_ / "out");
  const ProgramResult other = inspect({"b"});
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.err, HasSubstr("out: holds the inspection of another part, a; choose another"));
  EXPECT_EQ(files_below(folder_ / "out"), before);
  inspect_json({"a"}, {"--set", "inspection.kernel_px=11"});
  inspect_json({"a", "b"});
  EXPECT_EQ(inspect({"a"}).code, 2) << "b would stay";
}

TEST_F(InspectVerb, KeepsNoMapsOfAnotherFilter) {
  write_part("a");
  inspect_json({"a"}, {"--set", "inspection.filter=phase"});
  EXPECT_TRUE(fs::exists(folder_ / "out/a/phase_rad.exr"));
  inspect_json({"a"});
  EXPECT_FALSE(fs::exists(folder_ / "out/a/phase_rad.exr"));
  EXPECT_FALSE(fs::exists(folder_ / "out/a/modulation.exr"));
}

TEST_F(InspectVerb, KeepsLearnedLimitsAndInputs) {
  write_part("bad");
  write_part("good", false);
  write_file(folder_ / "labels.csv", "good,perfect\nbad,Rejected\n");
  inspect_json({"bad", "good"}, {"--labels", "labels.csv", "--learn"});
  const ProgramResult again = inspect({"bad", "good"});
  EXPECT_EQ(again.code, 2);
  EXPECT_THAT(again.err, HasSubstr("out: holds grading.toml, the limits that an earlier"));
  const ProgramResult used = inspect({"bad", "good"}, {"--settings", "out/grading.toml"});
  EXPECT_EQ(used.code, 2);
  EXPECT_THAT(used.err, HasSubstr("out/grading.toml: is read, and lies where results are written"));
  EXPECT_TRUE(fs::exists(folder_ / "out/grading.toml"));
  const ProgramResult beside =
      glint_in(folder_, {"inspect", "bad", "good", "--quiet", "--out", "."});
  EXPECT_EQ(beside.code, 2);
  EXPECT_THAT(beside.err, HasSubstr("lies where results are written"));
  EXPECT_FALSE(fs::exists(folder_ / "bad/aspect.png"));
}

}  // namespace
}  // namespace glint::test

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/output/result_folder.h"

#include <array>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "studies/output/run_folder.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {
namespace fs = std::filesystem;

using ::testing::HasSubstr;

constexpr std::array kAll = {ResultKind::kRun,
                             ResultKind::kRender,
                             ResultKind::kImprint,
                             ResultKind::kTools,
                             ResultKind::kInspect,
                             ResultKind::kFrontier,
                             ResultKind::kCalibrate,
                             ResultKind::kBoard,
                             ResultKind::kSensor,
                             ResultKind::kPlan,
                             ResultKind::kPoints,
                             ResultKind::kPlace,
                             ResultKind::kUndistort,
                             ResultKind::kCover,
                             ResultKind::kCompare,
                             ResultKind::kValidate,
                             ResultKind::kGrab,
                             ResultKind::kAcquire,
                             ResultKind::kStability};

const std::vector<std::string> kNames = {"result.json", "report.html", "baseline"};

TEST(ResultFolder, IsOfWhomItsMarkTells) {
  for (const ResultKind kind : kAll) {
    const TemporaryFolder folder;
    EXPECT_EQ(result_kind_of(folder.path()), std::nullopt);
    mark_result_folder(folder.path(), kind);
    EXPECT_EQ(result_kind_of(folder.path()), kind);
    for (const ResultKind other : kAll) {
      if (other == kind) {
        EXPECT_NO_THROW(check_result_folder(folder.path(), other, kNames));
      } else {
        EXPECT_THAT(
            text_thrown_by<ConfigError>([&] { check_result_folder(folder.path(), other, kNames); }),
            HasSubstr("holds results of `glint " + std::string(command_of(kind)) + "`"));
      }
    }
  }
}

// What versions wrote whose run.json did not tell.
TEST(ResultFolder, OfOlderVersionsIsKnownByItsFiles) {
  using Files = std::vector<std::pair<std::string, std::string>>;
  const std::vector<std::pair<Files, ResultKind>> older = {
      {{{"study.sqlite", ""}}, ResultKind::kRun},
      {{{"run.json", R"({"study": "gear", "algorithm": "cobyla"})"}}, ResultKind::kRun},
      {{{"run.json", R"({"threads": 2})"}, {"study.resolved.toml", ""}}, ResultKind::kRender},
      {{{"run.json", R"({"inspected": 3})"}, {"result.json", "{}"}}, ResultKind::kInspect},
      {{{"scene.resolved.toml", "# glint imprint: one part\n"}}, ResultKind::kImprint},
      {{{"tools.json", "{}"}, {"tools.png", ""}}, ResultKind::kTools},
      {{{"frontier.json", "{}"}, {"frontier.html", ""}}, ResultKind::kFrontier}};
  for (const auto& [files, kind] : older) {
    const TemporaryFolder folder;
    for (const auto& [name, text] : files) {
      write_file(folder / name, text);
    }
    EXPECT_EQ(result_kind_of(folder.path()), kind) << files.front().first;
  }
}

TEST(ResultFolder, OfAnotherStudyIsRefused) {
  const TemporaryFolder folder;
  EXPECT_NO_THROW(check_study_of_folder(folder.path(), "gear"));
  mark_result_folder(folder.path(), ResultKind::kCover, "gear");
  EXPECT_EQ(study_of_folder(folder.path()), "gear");
  EXPECT_NO_THROW(check_study_of_folder(folder.path(), "gear"));
  EXPECT_THAT(text_thrown_by<ConfigError>([&] { check_study_of_folder(folder.path(), "shaft"); }),
              HasSubstr("holds results of `glint cover` of gear; choose another output folder"));
  write_file(folder / "run.json", R"({"verb": "stability", "study": null})");
  EXPECT_EQ(study_of_folder(folder.path()), "");
  EXPECT_NO_THROW(check_study_of_folder(folder.path(), "shaft"));
}

TEST(ResultFolder, OfFilesOfAnotherFolderIsRefused) {
  const TemporaryFolder folder;
  const fs::path out = folder / "out/pictures/calibrate";
  const auto check = [&](const char* source) {
    return text_thrown_by<ConfigError>([&] { check_source_of_folder(out, {folder / source}); });
  };
  EXPECT_EQ(source_seen_from(out, folder / "left/pictures"), "../../../left/pictures");
  EXPECT_EQ(source_seen_from(out, fs::path()), "");
  EXPECT_NO_THROW(check_source_of_folder(out, {folder / "left/pictures"}));
  make_folder(out);
  write_file(out / "run.json", R"({"verb": "calibrate"})");
  EXPECT_NO_THROW(check_source_of_folder(out, {folder / "left/pictures"})) << "an older version's";
  write_file(out / "run.json", R"({"verb": "calibrate", "source": "../../../left/pictures"})");
  EXPECT_NO_THROW(check_source_of_folder(out, {folder / "left/pictures"}));
  EXPECT_EQ(check("right/pictures"), "nothing thrown") << "the told ones were moved";
  const fs::path left = folder / "left/pictures";
  make_folder(left);
  const std::string of_left = "holds results of " + fs::canonical(left).string() + "; choose";
  EXPECT_THAT(check("right/pictures"), HasSubstr(of_left));
  make_folder(folder / "far/away");
  fs::rename(folder / "out", folder / "far/away/out");
  fs::create_directory_symlink("far/away/out", folder / "out");
  write_file(out / "run.json",
             R"({"verb": "calibrate", "source": "../../../../../left/pictures"})");
  EXPECT_THAT(check("right/pictures"), HasSubstr(of_left)) << "seen from where the link leads";
}

// Each folder has a gear.toml, and out/gear/render is the default of them all.
TEST(ResultFolder, OfAnotherFileOfTheSameNameIsRefused) {
  const TemporaryFolder folder;
  for (const char* side : {"left", "right"}) {
    make_folder(folder / side);
    write_file(folder / side / "gear.toml", "");
  }
  const fs::path left = folder / "left/gear.toml";
  const fs::path out = folder / "out/gear/render";
  make_folder(out);
  mark_result_folder(out, ResultKind::kRender, "gear", source_seen_from(out, left));
  EXPECT_NO_THROW(check_source_of_folder(out, {left}));
  EXPECT_THAT(
      text_thrown_by<ConfigError>(
          [&] { check_source_of_folder(out, {folder / "right/gear.toml"}); }),
      HasSubstr("holds results of " + fs::canonical(left).string() + "; choose another folder"));
  fs::create_symlink(left, folder / "gear.toml");
  EXPECT_NO_THROW(check_source_of_folder(out, {folder / "gear.toml"})) << "a link to the same file";
  fs::create_hard_link(left, folder / "hard.toml");
  EXPECT_NO_THROW(check_source_of_folder(out, {folder / "hard.toml"})) << "the same file";
  const fs::path pipe = folder / "pipe.toml";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  EXPECT_EQ(source_seen_from(out, pipe), "");
  EXPECT_NO_THROW(check_source_of_folder(out, {pipe})) << "nobody knows where it came from";
}

// Both are called "gear", as their folder is.
TEST(ResultFolder, OfStudyAndSceneOfOneFolderIsShared) {
  const TemporaryFolder folder;
  for (const char* side : {"left/gear", "right/gear"}) {
    make_folder(folder / side);
    write_file(folder / side / "study.toml", "");
    write_file(folder / side / "scene.toml", "");
  }
  const fs::path out = folder / "out/gear/render";
  make_folder(out);
  const fs::path study = folder / "left/gear/study.toml";
  mark_result_folder(out, ResultKind::kRender, "gear", source_seen_from(out, study));
  EXPECT_NO_THROW(check_source_of_folder(out, {folder / "left/gear/scene.toml"}));
  EXPECT_THROW(check_source_of_folder(out, {folder / "right/gear/scene.toml"}), ConfigError);
}

TEST(ResultFolder, OfSeveralInputsTellsAllOfThem) {
  const TemporaryFolder folder;
  make_folder(folder / "view");
  make_folder(folder / "photos");
  const fs::path out = folder / "out/view/compare";
  const auto inputs = [&](const char* real) { return std::vector{folder / "view", folder / real}; };
  const auto told = sources_seen_from(out, inputs("photos"));
  EXPECT_EQ(told.dump(), R"(["../../../view","../../../photos"])");
  EXPECT_EQ(sources_seen_from(out, {folder / "view"}).dump(), R"("../../../view")");
  make_folder(out);
  write_file(out / "run.json", R"({"verb": "compare", "source": )" + told.dump() + "}");
  EXPECT_NO_THROW(check_source_of_folder(out, inputs("photos")));
  EXPECT_THAT(text_thrown_by<ConfigError>([&] { check_source_of_folder(out, inputs("others")); }),
              HasSubstr("/view and " + fs::canonical(folder / "photos").string() + "; choose"));
}

TEST(ResultFolder, OfNobodyKnownKeepsItsFiles) {
  const TemporaryFolder folder;
  write_file(folder / "notes.txt", "mine");
  EXPECT_NO_THROW(check_result_folder(folder.path(), ResultKind::kRun, kNames));
  EXPECT_NO_THROW(check_result_folder(folder / "to_be_made", ResultKind::kRun, kNames));
  fs::create_directories(folder / "baseline");
  EXPECT_THAT(text_thrown_by<ConfigError>(
                  [&] { check_result_folder(folder.path(), ResultKind::kRun, kNames); }),
              HasSubstr("holds a baseline that is not of `glint run`"));
  fs::remove(folder / "baseline");
  fs::create_symlink("nowhere", folder / "report.html");
  EXPECT_THROW(check_result_folder(folder.path(), ResultKind::kRun, kNames), ConfigError)
      << "a dangling link is somebody's, too";
  write_file(folder / "run.json", "[1, 2]");
  EXPECT_EQ(result_kind_of(folder.path()), std::nullopt);
}

TEST(ResultFolder, NeverTakesAnInputForAnOutput) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "baseline");
  const fs::path scene = folder / "baseline/scene.toml";
  const fs::path study = folder / "study.toml";
  write_file(scene, "");
  write_file(study, "");
  const auto check = [&](const fs::path& input, const fs::path& out) {
    check_inputs_kept(std::vector{fs::path(), input}, out, kNames);
  };
  EXPECT_NO_THROW(check(study, folder.path()));
  EXPECT_NO_THROW(check(scene, folder / "elsewhere"));
  EXPECT_THROW(check(scene, folder.path()), ConfigError);
  EXPECT_THROW(check(folder / "baseline/../report.html", folder.path()), ConfigError);
  fs::create_directory_symlink(folder.path(), folder / "link");
  EXPECT_THROW(check(scene, folder / "link"), ConfigError) << "the same folder by another name";
}

TEST(ResultFolder, OfARunIsTheOlderOneWhereThatHoldsTheRun) {
  const TemporaryFolder folder;
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  EXPECT_EQ(default_run_folder("gear"), "out/gear/run");
  fs::create_directories("out/gear");
  EXPECT_EQ(default_run_folder("gear"), "out/gear/run");
  write_file("out/gear/study.sqlite", "");
  EXPECT_EQ(default_run_folder("gear"), "out/gear");
  fs::create_directories("out/gear/run");
  write_file("out/gear/run/study.sqlite", "");
  EXPECT_EQ(default_run_folder("gear"), "out/gear/run");
  fs::current_path(before);
}

// Else the default folder of what is made of a run would be the same for all studies.
TEST(ResultFolder, IsCalledAfterTheStudyOfARun) {
  const TemporaryFolder folder;
  make_folder(folder / "out/gear/run");
  make_folder(folder / "photos.raw");
  write_file(folder / "s.png", "");
  EXPECT_EQ(name_of_source(folder / "out/gear/run"), "gear");
  EXPECT_EQ(name_of_source(folder / "out/gear/run/"), "gear");
  EXPECT_EQ(name_of_source(folder / "out/gear/render/"), "gear") << "it is not there";
  EXPECT_EQ(name_of_source(folder / "out/gear"), "gear");
  EXPECT_EQ(name_of_source(folder / "photos.raw"), "photos.raw");
  EXPECT_EQ(name_of_source(folder / "s.png"), "s");
}

// Each run has a winner.
TEST(ResultFolder, OfADesignIsCalledAfterItsRun) {
  const TemporaryFolder folder;
  for (const char* study : {"gear", "cup"}) {
    const fs::path run = folder / "out" / study / "run";
    make_folder(run / "winner");
    write_file(run / kRunStudy, "");
    write_file(run / "winner/aspect.png", "");
    const std::string name = study;
    EXPECT_EQ(name_within_run(run), name);
    EXPECT_EQ(name_within_run(run / "winner"), name + "_winner");
    EXPECT_EQ(name_within_run(run / "winner/"), name + "_winner");
    EXPECT_EQ(name_within_run(run / "winner/aspect.png"), name + "_winner_aspect");
  }
  make_folder(folder / "out/gear/render/view_03");
  EXPECT_EQ(name_within_run(folder / "out/gear/render"), "gear") << "no run";
  EXPECT_EQ(name_within_run(folder / "out/gear/render/view_03"), "view_03");
  EXPECT_EQ(name_within_run({}), name_of_source({})) << "pairs of a file";
}

TEST(ResultFolder, DefaultsDifferFromVerbToVerb) {
  for (const ResultKind one : kAll) {
    for (const ResultKind other : kAll) {
      EXPECT_EQ(default_result_folder("gear", one) == default_result_folder("gear", other),
                one == other);
    }
  }
}

}  // namespace
}  // namespace glint

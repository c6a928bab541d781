// SPDX-License-Identifier: GPL-3.0-or-later
//
// Output that cannot be written, and output folders that hold something else.
#include <sys/resource.h>

#include <algorithm>
#include <csignal>

#include "tests/cli/program.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using ::testing::MatchesRegex;

/// A folder with a study in it.
class OutputError : public ::testing::Test {
 protected:
  void SetUp() override { write_file(folder_ / "study.toml", small_study()); }

  static void expect_one_line(const ProgramResult& result, int code, const std::string& message) {
    EXPECT_EQ(result.code, code);
    EXPECT_THAT(result.err, MatchesRegex(message + "\n"));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_EQ(result.out, "");
  }

  ProgramResult run(const std::string& out, const Arguments& more = {}) const {
    Arguments arguments = {"run", "study.toml", "--quiet", "--out", out};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return glint_in(folder_, arguments);
  }

  TemporaryFolder folder_;
};

TEST_F(OutputError, FolderBelowAFile) {
  expect_one_line(
      run("study.toml/x"), 3, "study\\.toml/x: the folder cannot be made: Not a directory");
  expect_one_line(run("study.toml"), 3, "study\\.toml: the folder cannot be made: .*");
  EXPECT_EQ(read_file(folder_ / "study.toml"), small_study());
}

TEST_F(OutputError, FolderWhereNoneCanBe) {
  expect_one_line(run("/proc/glint"), 3, "/proc/glint: the folder cannot be made: .*");
  const std::string long_name(300, 'x');
  expect_one_line(run("a/b/" + long_name), 3, "a/b/x+: the folder cannot be made: .*too long");
  EXPECT_FALSE(fs::exists(folder_ / "a")) << "parents are left behind";
}

TEST_F(OutputError, LinksThatLeadToNothingStay) {
  write_file(folder_ / "part.stl", rectangle_stl(40, 12));
  fs::create_symlink("not_mounted", folder_ / "link");
  const std::string nothing = ": the folder cannot be made: .* leads to nothing";
  expect_one_line(run("link"), 3, "link" + nothing);
  expect_one_line(run("link/below"), 3, "link/below" + nothing);
  expect_one_line(
      glint_in(folder_, {"part", "part.stl", "--out", "link/part.ply"}), 3, "link" + nothing);
  EXPECT_TRUE(fs::is_symlink(folder_ / "link"));
}

TEST_F(OutputError, RenderReportPartAndNewNameTheFile) {
  write_file(folder_ / "part.stl", rectangle_stl(40, 12));
  expect_one_line(glint_in(folder_, {"render", "study.toml", "--out", "study.toml/x"}),
                  3,
                  "study\\.toml/x: the folder cannot be made: .*");
  expect_one_line(glint_in(folder_, {"part", "part.stl", "--out", "study.toml/part.ply"}),
                  3,
                  "study\\.toml: the folder cannot be made: .*");
  expect_one_line(glint_in(folder_, {"new", "part.stl", "--out", "part.stl/new.toml"}),
                  3,
                  "part\\.stl: the folder cannot be made: .*");
  EXPECT_EQ(folder_.count(), 2);
}

TEST_F(OutputError, NoFolderIsMadeForAFileThatIsNotWritten) {
  write_file(folder_ / "part.stl", rectangle_stl(40, 12));
  const std::vector<Arguments> verbs = {
      {"report", "typo"},
      {"report", "typo", "--out", "a/b/page.html"},
      {"report", "typo", "--optuna", "a/b/journal"},
      {"part", "part.stl", "--out", "a/b/part.xyz"},
      {"part", "part.stl", "--out", "a/b/" + std::string(300, 'x') + "/part.ply"},
      {"new", "part.stl", "--unit", "ell", "--out", "a/b/n.toml"}};
  for (const Arguments& verb : verbs) {
    EXPECT_NE(glint_in(folder_, verb).code, 0) << verb.front();
    EXPECT_EQ(folder_.count(), 2) << verb.front() << " " << verb.back();
  }
}

TEST_F(OutputError, FoldersOfFilesAreMade) {
  write_file(folder_ / "part.stl", rectangle_stl(40, 12));
  const std::vector<Arguments> verbs = {
      {"new", "part.stl", "--working_distance_mm", "300", "--out", "a/b/new.toml"},
      {"part", "part.stl", "--out", "c/d/part.ply"},
      {"run", "study.toml", "--quiet", "--out", "run"},
      {"report", "run", "--out", "e/page.html"},
      {"report", "run", "--optuna", "f/journal.log"}};
  for (const Arguments& verb : verbs) {
    const ProgramResult result = glint_in(folder_, verb);
    EXPECT_EQ(result.code, 0) << verb.front() << ": " << result.err;
  }
  EXPECT_TRUE(fs::exists(folder_ / "a/b/new.toml"));
  EXPECT_TRUE(fs::exists(folder_ / "c/d/part.ply"));
  EXPECT_TRUE(fs::exists(folder_ / "e/page.html"));
  EXPECT_TRUE(fs::exists(folder_ / "f/journal.log"));
  const ProgramResult part = glint_in(folder_, {"part", "a/b/new.toml"});
  EXPECT_EQ(part.code, 0) << "the study finds its part: " << part.err;
}

TEST_F(OutputError, FullStandardOutput) {
  const ProgramResult result = glint_in(folder_.path(), {"explain", "scan"}, [] {
    if (std::freopen("/dev/full", "w", stdout) == nullptr) {
      std::abort();
    }
  });
  expect_one_line(result, 3, "stdout: cannot be written");
}

/// Files may not grow beyond that; the program is told by an error, as on a full disk.
ProgramResult run_with_file_limit(const TemporaryFolder& folder, rlim_t bytes) {
  return glint_in(folder.path(), {"run", "study.toml", "--quiet", "--out", "a/b"}, [bytes] {
    const struct rlimit limit = {.rlim_cur = bytes, .rlim_max = bytes};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  });
}

TEST_F(OutputError, FileTooLargeBeforeAnythingIsEvaluatedLeavesNothing) {
  expect_one_line(run_with_file_limit(folder_, 4096), 3, "a/b/study\\.sqlite[^ ]*: .*");
  EXPECT_EQ(folder_.count(), 1);
}

// The report is by far the largest file. The evaluations before it are kept for the next run.
TEST_F(OutputError, FileTooLargeAfterTheSearchKeepsTheEvaluations) {
  // The database and its log stay below, the page with its charts does not.
  expect_one_line(run_with_file_limit(folder_, 900 * 1024),
                  3,
                  "a/b/report\\.html: cannot be written: File too large");
  EXPECT_FALSE(fs::exists(folder_ / "a/b/report.html"));
  EXPECT_EQ(run("a/b").code, 0);
  EXPECT_EQ(run("whole").code, 0);
  expect_same_files(folder_ / "a/b", folder_ / "whole");
}

TEST_F(OutputError, AnotherStudyInTheFolderIsLeftAlone) {
  ASSERT_EQ(run("out").code, 0);
  const auto before = files_below(folder_ / "out");
  expect_one_line(run("out", {"--set", "lighting.tunnel.slot_mm=16"}),
                  2,
                  "out: holds another study: lighting\\.tunnel\\.slot_mm is 16, was [0-9.]+; of a "
                  "study that has been begun only title, \\[prototypes\\] and \\[budget\\] may "
                  "change, and variables may get wider limits and more choices: give another "
                  "folder with --out");
  expect_one_line(
      glint_in(folder_, {"render", "study.toml", "--out", "out"}),
      2,
      "out: holds results of `glint run` of glint_test_.*; choose another output folder");
  EXPECT_EQ(files_below(folder_ / "out"), before);
}

TEST_F(OutputError, DamagedDatabaseIsLeftAlone) {
  ASSERT_EQ(run("out").code, 0);
  const fs::path database = folder_ / "out/study.sqlite";
  const std::string whole = read_file(database);
  const auto before = files_below(folder_ / "out");
  std::string zeroed = whole;
  zeroed.replace(4096, 8192, 8192, '\0');
  const std::vector<std::pair<std::string, std::string>> damages = {
      {whole.substr(0, whole.size() / 2), "out/study\\.sqlite: .*truncated.*"},
      {whole.substr(0, 50), "out/study\\.sqlite: .*"},
      {"", "out/study\\.sqlite: .*damaged or truncated.*"},
      {"this is no database, whatever its name says\n",
       "out/study\\.sqlite: is not a study database, or a damaged one"},
      {zeroed, "out/study\\.sqlite: .*damaged.*"}};
  for (const auto& [bytes, message] : damages) {
    write_file(database, bytes);
    expect_one_line(run("out"), 3, message);
    EXPECT_EQ(read_file(database), bytes);
    EXPECT_EQ(files_below(folder_ / "out"), before);
  }
}

TEST_F(OutputError, OneFolderTakesOneProcess) {
  write_file(folder_ / "study.toml",
             edited(slow_study(), {{"evaluations = 40", "evaluations = 400"}}));
  Program first(folder_.path(), {"run", "study.toml", "--quiet", "--out", "out"});
  while (first.is_running() && !fs::exists(folder_ / "out/study.resolved.toml")) {
  }
  expect_one_line(
      run("out"), 3, "out/study\\.sqlite\\.lock: another process is running this study");
  EXPECT_TRUE(first.is_running());
}

}  // namespace
}  // namespace glint::test

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Study files that are devices, pipes, empty or missing, files of a scene that hold noise, and a
// machine that runs out of memory.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

#include "tests/cli/program.h"

namespace glint::test {
namespace {

using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;

/// A folder for study files that are refused.
class StudyFileError : public ::testing::Test {
 protected:
  void expect_refused(const Arguments& arguments,
                      int code,
                      const std::string& message,
                      const std::function<void()>& in_child = {}) const {
    const std::ptrdiff_t files = folder_.count();
    const ProgramResult result = glint_in(folder_.path(), arguments, in_child);
    EXPECT_EQ(result.code, code);
    EXPECT_THAT(result.err, MatchesRegex(message + "\n"));
    EXPECT_EQ(std::ranges::count(result.err, '\n'), 1) << result.err;
    EXPECT_EQ(folder_.count(), files) << "something is left behind";
  }

  TemporaryFolder folder_;
};

TEST_F(StudyFileError, DevicesAreNoStudyFiles) {
  write_file(folder_ / "study.toml", "include = [\"/dev/zero\"]\n");
  expect_refused(
      {"run", "study.toml", "--out", "out"},
      2,
      "study\\.toml:1:12: include: /dev/zero: is no study file: it holds more than 4 MB, "
      "which is the most allowed");
  expect_refused({"check", "/dev/null"}, 2, "/dev/null: describes no scene; .*");
}

TEST_F(StudyFileError, EmptyFilesDescribeNoScene) {
  for (const char* text : {"", "schema = 1\n"}) {
    write_file(folder_ / "study.toml", text);
    expect_refused({"run", "study.toml", "--out", "out"},
                   2,
                   "study\\.toml: describes no scene; it must hold at least one of the tables "
                   "\\[part\\] .*");
  }
}

TEST_F(StudyFileError, MissingIncludesAndCirclesNameTheFilesThatAsk) {
  write_file(folder_ / "a.toml", "include = [\"b.toml\"]\n");
  write_file(folder_ / "b.toml", "\ninclude = [\"gone.toml\"]\n");
  expect_refused({"check", "a.toml"},
                 3,
                 "b\\.toml:2:12: include: gone\\.toml: cannot be read: No such file or directory");
  write_file(folder_ / "b.toml", "include = [\"c.toml\"]\n");
  write_file(folder_ / "c.toml", "include = [\"a.toml\"]\n");
  expect_refused({"check", "a.toml"},
                 2,
                 "c\\.toml:1:12: include: the file includes itself: a\\.toml -> b\\.toml -> "
                 "c\\.toml -> a\\.toml");
}

TEST_F(StudyFileError, APipeIsReadLikeAFileInTheCurrentFolder) {
  write_file(folder_ / "base.toml", small_study());
  const std::string study = "include = [\"base.toml\"]\n";
  const ProgramResult result =
      glint_in(folder_.path(), {"check", "/dev/stdin", "--threads", "1"}, [&] {
        int ends[2] = {};
        const auto size = static_cast<ssize_t>(study.size());  // less than a pipe holds
        if (::pipe(ends) != 0 || ::write(ends[1], study.data(), study.size()) != size) {
          std::abort();
        }
        ::close(ends[1]);
        ::dup2(ends[0], STDIN_FILENO);
      });
  EXPECT_EQ(result.code, 0) << result.err;
  EXPECT_THAT(result.out, HasSubstr("the study is sound, 2 variables"));
}

// One fault, one exit code: the file is there, but holds something else.
TEST_F(StudyFileError, NoiseIsWrongInputWhateverItShouldBe) {
  const std::string noise = "\x01\x7f\x80noise\xff\x10 1 2 3";
  const std::string part = "[part]\nshape = \"plate\"\nlength_mm = 20\nwidth_mm = 16\n";
  const std::vector<std::pair<std::string, std::string>> scenes = {
      {"noise.ies", "[lighting.ies]\nfile = \"noise.ies\"\n"},
      {"noise.exr", "[lighting.environment]\nfile = \"noise.exr\"\n"},
      {"noise.png",
       "[lighting.dome]\n[material]\ntype = \"diffuse\"\n[material.texture]\n"
       "colour_file = \"noise.png\"\n"}};
  for (const auto& [name, tables] : scenes) {
    write_file(folder_ / name, noise);
    write_file(folder_ / "scene.toml", part + tables);
    expect_refused({"render", "scene.toml", "--out", "out"}, 2, ".*" + name + ":.*");
  }
}

TEST_F(StudyFileError, RunningOutOfMemoryIsNoMistakeOfTheProgram) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need all addresses";
#endif
  write_file(
      folder_ / "study.toml",
      edited(small_study(),
             {{"width_px = 200", "width_px = 6000"}, {"height_px = 60", "height_px = 4000"}}));
  const ProgramResult result =
      glint_in(folder_.path(), {"render", "study.toml", "--out", "out", "--threads", "1"}, [] {
        constexpr rlim_t kBytes = rlim_t{1500} << 20U;
        const struct rlimit limit = {.rlim_cur = kBytes, .rlim_max = kBytes};
        ::setrlimit(RLIMIT_AS, &limit);
      });
  EXPECT_EQ(result.code, 3) << result.err;
  EXPECT_THAT(result.err, HasSubstr("out of memory"));
  EXPECT_THAT(result.err, Not(HasSubstr("internal error")));
}

}  // namespace
}  // namespace glint::test

// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint imprint`: wrong input.
#include <sys/resource.h>

#include "tests/cli/imprint_fixture.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;
using ::testing::MatchesRegex;

TEST_F(ImprintVerb, RefusesACountThatIsNegativeOrZero) {
  expect_refused(kShaft, 2, "glint imprint: --count: .*", {"--count", "-1"});
  expect_refused(kShaft, 2, "glint imprint: --count: .*", {"--count", "0"});
  const std::string scene = edited(kShaft, {{"count = 1\n", "count = -1\n"}});
  expect_refused(scene, 2, place_of(scene, "count = -1") + "defects\\.scratch\\.count: .*-1.*");
}

TEST_F(ImprintVerb, RefusesASceneWithoutDefects) {
  const std::string scene = std::string(kShaft).substr(0, std::string(kShaft).find("[defects"));
  expect_refused(scene, 2, "study\\.toml: defects: no table .*nothing to imprint");
}

TEST_F(ImprintVerb, RefusesAnInvertedRange) {
  const std::string scene = edited(kShaft, {{"[1, 2]\nheight", "[2, 1]\nheight"}});
  expect_refused(scene, 2, place_of(scene, "diameter_mm =") + "defects\\.dent\\.diameter_mm: .*");
}

TEST_F(ImprintVerb, RefusesAnUnknownKey) {
  const std::string scene = edited(kShaft, {{"tool_level", "tool_levl"}});
  expect_refused(scene,
                 2,
                 place_of(scene, "tool_levl") +
                     "defects\\.dent\\.tool_levl: unknown key, the nearest known one is "
                     "\"tool_level\"");
}

TEST_F(ImprintVerb, RefusesAPlaceOffTheSurface) {
  const std::string scene = edited(kShaft, {{"count = [1, 2]\n", "at_mm = [0, 0, 8, 0, 0, 30]\n"}});
  expect_refused(scene,
                 2,
                 place_of(scene, "at_mm") +
                     "defects\\.dent\\.at_mm: place 2 at 0, 0, 30 mm: .*off the surface.*");
}

TEST_F(ImprintVerb, RefusesGivenPlacesBesideRandomOnes) {
  for (const char* places : {"at_mm = [0, 0, 8]", "x_mm = [1]\ny_mm = [0]"}) {
    const std::string scene =
        edited(kShaft, {{"count = [1, 2]\n", std::string("count = 2\n") + places + "\n"}});
    expect_refused(scene,
                   2,
                   place_of(scene, "count = 2") +
                       "defects\\.dent\\.count: random places and .* exclude each other; .*");
  }
}

TEST_F(ImprintVerb, RefusesAPaintedFileThatDoesNotFit) {
  ASSERT_EQ(glint_in(folder_, {"part", "study.toml", "--out", "plain.ply", "--quiet"}).code, 0);
  const std::string scene =
      edited(kShaft, {{"tool_level = 2", "region = \"faces\"\nregion_file = \"plain.ply\""}});
  expect_refused(scene,
                 2,
                 place_of(scene, "region_file =") +
                     R"(defects\.dent\.region_file: .*plain\.ply: .*have no colours.*)");
}

TEST_F(ImprintVerb, RefusesAToolFolderThatIsEmpty) {
  fs::create_directories(folder_ / "tools");
  const std::string scene = edited(kShaft, {{"tool_level = 2", "tool_folder = \"tools\""}});
  expect_refused(scene,
                 2,
                 place_of(scene, "tool_folder =") +
                     "defects\\.dent\\.tool_folder: [^ ]*tools holds no tool, .*");
}

TEST_F(ImprintVerb, RefusesAToolThatIsOpen) {
  fs::create_directories(folder_ / "tools");
  const std::string scene = edited(kShaft, {{"tool_level = 2", "tool_folder = \"tools\""}});
  write_file(folder_ / "tools/open.off", kOpenTetrahedron);
  const std::string message = place_of(scene, "tool_folder =") +
                              R"(defects\.dent\.tool_folder: [^ ]*open\.off: cannot be a tool: .*)";
  expect_refused(scene, 2, message);
  expect_refused(scene, 2, message, {"--preview_tools"});
}

TEST_F(ImprintVerb, RefusesAPartInMetres) {
  write_file(folder_ / "part.stl", rectangle_stl(0.2, 0.04));
  const std::string scene = edited(
      kShaft, {{"shape = \"cylinder\"\nlength_mm = 20\nradius_mm = 8\n", "file = \"part.stl\"\n"}});
  expect_refused(
      scene,
      2,
      R"(study\.toml:3:2: part\.unit: part\.stl is 0\.2 mm large: is the file in m\? .*)");
}

TEST_F(ImprintVerb, NamesAFolderThatCannotBeMade) {
  const ProgramResult result = imprint("study.toml/x");
  EXPECT_EQ(result.code, 3);
  EXPECT_EQ(result.err, "study.toml/x: the folder cannot be made: Not a directory\n");
}

// A file beyond the limit is told as a full disk is; neither a fresh nor an old folder keeps
// pieces.
TEST_F(ImprintVerb, FileTooLargeLeavesNothing) {
  const auto limited = [&](const Arguments& more) {
    Arguments arguments = {"imprint", "study.toml", "--quiet", "--out"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return glint_in(folder_.path(), arguments, [] {
      const struct rlimit limit = {.rlim_cur = 10'000, .rlim_max = 10'000};
      ::setrlimit(RLIMIT_FSIZE, &limit);
    });
  };
  const ProgramResult one = limited({"a/b"});
  EXPECT_EQ(one.code, 3);
  EXPECT_THAT(one.err, MatchesRegex("a/b/[^ ]*: cannot be written: File too large\n"));
  EXPECT_FALSE(fs::exists(folder_ / "a"));
  fs::create_directories(folder_ / "c");
  EXPECT_EQ(limited({"c"}).code, 3);
  EXPECT_TRUE(fs::is_empty(folder_ / "c"));
  EXPECT_EQ(limited({"d", "--count", "3"}).code, 3);
  EXPECT_FALSE(fs::exists(folder_ / "d"));
}

}  // namespace
}  // namespace glint::test

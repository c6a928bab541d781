// SPDX-License-Identifier: GPL-3.0-or-later
#include <unistd.h>

#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/config.h"
#include "core/config/toml.h"
#include "core/file.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string place_of(const ConfigNode& root, std::string_view path) {
  const ConfigNode* node = root.at_path(path);
  return node == nullptr ? "absent" : node->place.prefix();
}

TEST(ParseToml, KnowsEveryKindOfValue) {
  const ConfigNode root = parse_toml(
      "flag = true\ncount = -3\nduty = 0.25\nname = \"strip\"\nlist = [1, 2.5]\n[part]\nx = 1\n",
      "a.toml");
  EXPECT_TRUE(root.at_path("flag")->boolean);
  EXPECT_EQ(root.at_path("count")->integer, -3);
  EXPECT_EQ(root.at_path("count")->number, -3.0);
  EXPECT_EQ(root.at_path("count")->kind, ConfigNode::Kind::kInteger);
  EXPECT_EQ(root.at_path("duty")->number, 0.25);
  EXPECT_EQ(root.at_path("duty")->kind, ConfigNode::Kind::kNumber);
  EXPECT_EQ(root.at_path("name")->text, "strip");
  EXPECT_EQ(root.at_path("list.1")->number, 2.5);
  EXPECT_TRUE(root.at_path("part")->is_table());
}

TEST(ParseToml, RemembersWhereEachKeyStands) {
  const ConfigNode root = parse_toml(
      "# comment\nname = \"a\"\n\n[part]\n  length_mm = 200.0\n[[viewpoint]]\nup = [0, 1, 2]\n",
      "dir/a.toml");
  EXPECT_EQ(place_of(root, "name"), "dir/a.toml:2:1: ");
  EXPECT_EQ(place_of(root, "part"), "dir/a.toml:4:2: ");
  EXPECT_EQ(place_of(root, "part.length_mm"), "dir/a.toml:5:3: ");
  EXPECT_EQ(place_of(root, "viewpoint.0.up"), "dir/a.toml:7:1: ");
  EXPECT_EQ(place_of(root, "viewpoint.0.up.2"), "dir/a.toml:7:13: ");
}

TEST(ParseToml, KeepsTheOrderOfTheFile) {
  const ConfigNode root = parse_toml("zebra = 1\nant = 2\n[z]\n[a]\n[m]\ny = 1\nb = 2\n", "a");
  EXPECT_THAT(root.names, ElementsAre("zebra", "ant", "z", "a", "m"));
  EXPECT_THAT(root.at_path("m")->names, ElementsAre("y", "b"));
}

TEST(ParseToml, PointsAtAMistake) {
  EXPECT_THAT(text_thrown_by<ConfigError>([] { parse_toml("a = 1\nb = = 2\n", "a.toml"); }),
              StartsWith("a.toml:2:5: "));
  EXPECT_THAT(text_thrown_by<ConfigError>([] { parse_toml("a = 1\na = 2\n", "a.toml"); }),
              StartsWith("a.toml:2:"));
  EXPECT_THAT(text_thrown_by<ConfigError>([] { parse_toml("day = 1979-05-27\n", "a.toml"); }),
              EndsWith("dates and times are not used in study files"));
}

TEST(ParseToml, RefusesBytesThatAreNoText) {
  EXPECT_THROW(parse_toml("a = \"\xff\xfe\"\n", "a.toml"), ConfigError);
  EXPECT_THROW(parse_toml(std::string("a = \0\n", 6), "a.toml"), ConfigError);
}

TEST(ParseToml, RefusesWhatWouldExhaustTheStack) {
  std::string dotted = "ok = 1\na";
  std::string nested = "a = ";
  for (int i = 0; i < 200000; ++i) {
    dotted += ".a";
    nested += "[";
  }
  EXPECT_EQ(text_thrown_by<ConfigError>([&] { parse_toml(dotted + " = 1\n", "a.toml"); }),
            "a.toml:2: a key has more than 500 parts");
  EXPECT_THROW(parse_toml(nested + "\n", "a.toml"), ConfigError);
}

TEST(ParseToml, TakesLongArraysOfNumbers) {
  std::string text = "values = [0.5";
  for (int i = 1; i < 20000; ++i) {
    text += ", 0.5";
  }
  EXPECT_EQ(parse_toml(text + "]\n", "a.toml").at_path("values")->items.size(), 20000U);
}

TEST(LoadToml, LaysLaterKeysOverIncludedOnes) {
  const TemporaryFolder folder;
  make_folder(folder / "shared");
  write_file(folder / "shared/base.toml", "seed = 1\n[part]\nlength_mm = 200\nwidth_mm = 50\n");
  write_file(folder / "second.toml", "[part]\nwidth_mm = 60\n");
  write_file(folder / "study.toml",
             "include = [\"shared/base.toml\", \"second.toml\"]\n[part]\nheight_mm = 5\n");
  const ConfigNode root = load_toml(folder / "study.toml");
  EXPECT_EQ(root.find("include"), nullptr);
  EXPECT_EQ(root.at_path("seed")->integer, 1);
  EXPECT_EQ(root.at_path("part.length_mm")->integer, 200);
  EXPECT_EQ(root.at_path("part.width_mm")->integer, 60);
  EXPECT_EQ(root.at_path("part.height_mm")->integer, 5);
  EXPECT_EQ(place_of(root, "part.length_mm"), (folder / "shared/base.toml").string() + ":3:1: ");
}

TEST(LoadToml, FollowsIncludesOfIncludesFromTheirOwnFolder) {
  const TemporaryFolder folder;
  make_folder(folder / "a/b");
  write_file(folder / "a/b/deep.toml", "depth = 2\n");
  write_file(folder / "a/middle.toml", "include = [\"b/deep.toml\"]\n");
  write_file(folder / "top.toml", "include = [\"a/middle.toml\", \"a/b/deep.toml\"]\n");
  EXPECT_EQ(load_toml(folder / "top.toml").at_path("depth")->integer, 2);
}

TEST(LoadToml, RefusesAFileThatIncludesItself) {
  const TemporaryFolder folder;
  write_file(folder / "a.toml", "include = [\"a.toml\"]\n");
  EXPECT_THAT(text_thrown_by<ConfigError>([&] { load_toml(folder / "a.toml"); }),
              AllOf(HasSubstr("a.toml:1:12: include: the file includes itself: "),
                    EndsWith("a.toml -> " + (folder / "a.toml").string())));
  write_file(folder / "top.toml", "include = [\"b.toml\"]\n");
  write_file(folder / "b.toml", "include = [\"c.toml\"]\n");
  write_file(folder / "c.toml", "include = [\"./b.toml\"]\n");
  const std::string b = (folder / "b.toml").string();
  const std::string c = (folder / "c.toml").string();
  EXPECT_EQ(text_thrown_by<ConfigError>([&] { load_toml(folder / "top.toml"); }),
            c + ":1:12: include: the file includes itself: " + b + " -> " + c + " -> " + b);
}

TEST(LoadToml, RefusesDevicesAndFilesThatAreNoStudies) {
  const TemporaryFolder folder;
  write_file(folder / "a.toml", "include = [\"/dev/zero\"]\n");
  EXPECT_THAT(text_thrown_by<ConfigError>([&] { load_toml(folder / "a.toml"); }),
              AllOf(HasSubstr("a.toml:1:12: include: /dev/zero: is no study file"),
                    HasSubstr("more than 4 MB")));
  write_file(folder / "large.toml", std::string((4U << 20U) + 1, '#'));
  EXPECT_THAT(text_thrown_by<ConfigError>([&] { load_toml(folder / "large.toml"); }),
              HasSubstr("large.toml: is no study file"));
  write_file(folder / "just.toml", std::string(4U << 20U, '#'));
  EXPECT_TRUE(load_toml(folder / "just.toml").names.empty());
}

TEST(LoadToml, ReadsPipes) {
  int ends[2] = {};
  ASSERT_EQ(::pipe(ends), 0);
  const std::string text = "seed = 3\n";
  ASSERT_EQ(::write(ends[1], text.data(), text.size()), static_cast<ssize_t>(text.size()));
  ::close(ends[1]);
  EXPECT_EQ(load_toml(fmt::format("/dev/fd/{}", ends[0])).at_path("seed")->integer, 3);
  ::close(ends[0]);
}

TEST(LoadToml, RefusesAnIncludeThatIsNoListOfFiles) {
  const TemporaryFolder folder;
  write_file(folder / "a.toml", "include = \"b.toml\"\n");
  EXPECT_THAT(
      text_thrown_by<ConfigError>([&] { load_toml(folder / "a.toml"); }),
      EndsWith("a.toml:1:1: include: must be an array of file names, like [\"base.toml\"]"));
  write_file(folder / "a.toml", "include = [3]\n");
  EXPECT_THAT(text_thrown_by<ConfigError>([&] { load_toml(folder / "a.toml"); }),
              EndsWith("a.toml:1:12: include: must hold file names"));
}

TEST(LoadToml, NamesAMissingFile) {
  const TemporaryFolder folder;
  EXPECT_THAT(text_thrown_by<IoError>([&] { load_toml(folder / "none.toml"); }),
              HasSubstr("none.toml: cannot be read: No such file or directory"));
  write_file(folder / "a.toml", "include = [\"gone.toml\"]\n");
  EXPECT_THAT(
      text_thrown_by<IoError>([&] { load_toml(folder / "a.toml"); }),
      AllOf(HasSubstr("a.toml:1:12: include: "), HasSubstr("gone.toml: cannot be read: No")));
}

TEST(ParseOverride, ReadsTomlValues) {
  EXPECT_EQ(parse_override("3").kind, ConfigNode::Kind::kInteger);
  EXPECT_EQ(parse_override("3.5").number, 3.5);
  EXPECT_TRUE(parse_override("true").boolean);
  EXPECT_EQ(parse_override("\"a b\"").text, "a b");
  EXPECT_EQ(parse_override("[1, 2]").items.size(), 2U);
  EXPECT_EQ(parse_override("{ min = 1 }").at_path("min")->integer, 1);
}

TEST(ParseOverride, TakesEverythingElseAsPlainText) {
  for (const char* text :
       {"parts/wheel.stl", "ellipse", "", "1\nother = 2", "2024-01-31", "[broken", "a = b"}) {
    const ConfigNode value = parse_override(text);
    EXPECT_EQ(value.kind, ConfigNode::Kind::kText) << text;
    EXPECT_EQ(value.text, text);
  }
}

TEST(ParseOverride, StandsOnTheCommandLine) {
  EXPECT_EQ(parse_override("3").place.prefix(), "--set: ");
  EXPECT_EQ(parse_override("wheel.stl").place.prefix(), "--set: ");
  EXPECT_EQ(parse_override("[1, 2]").items[1].place.prefix(), "--set: ");
}

TEST(ResolvePath, IsRelativeToTheFileOrTheCurrentFolder) {
  const ConfigNode root = parse_toml("file = \"part.stl\"\nabs = \"/x/y.stl\"\n", "dir/a.toml");
  EXPECT_EQ(resolve_path(*root.find("file")), "dir/part.stl");
  EXPECT_EQ(resolve_path(*root.find("abs")), "/x/y.stl");
  EXPECT_EQ(resolve_path(parse_override("part.stl")), "part.stl");
  EXPECT_EQ(resolve_path(parse_override("[\"part.stl\"]").items[0]), "part.stl");
  EXPECT_EQ(resolve_path(ConfigNode::from_text("part.stl")), "part.stl");
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/config.h"

#include <array>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "core/rng.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Kind = ConfigNode::Kind;
using ::testing::EndsWith;

/// Equal but for places and the order of a table's keys (tables follow plain values in a file).
bool is_same_tree(const ConfigNode& a, const ConfigNode& b) {
  if (a.kind != b.kind || a.items.size() != b.items.size()) {
    return false;
  }
  for (std::size_t i = 0; i < a.items.size(); ++i) {
    const ConfigNode* other = a.is_table() ? b.find(a.names[i]) : &b.items[i];
    if (other == nullptr || !is_same_tree(a.items[i], *other)) {
      return false;
    }
  }
  const bool is_same_number = a.number == b.number
                                  ? std::signbit(a.number) == std::signbit(b.number)
                                  : std::isnan(a.number) && std::isnan(b.number);
  return a.boolean == b.boolean && a.integer == b.integer && is_same_number && a.text == b.text;
}

std::string random_text(Rng& rng) {
  static const std::vector<std::string> pieces = {
      "a",  "Z",    "9",    "_", "-", ".", " ", "\"", "\\",       "\n",          "\t",
      "\r", "\x01", "\x7f", "#", "'", "[", "]", "=",  "\xc3\xa9", "\xe2\x82\xac"};
  std::string text;
  const std::uint32_t length = rng.next_u32() % 7;
  for (std::uint32_t i = 0; i < length; ++i) {
    text += pieces[rng.next_u32() % pieces.size()];
  }
  return text;
}

double random_number(Rng& rng) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr std::array<double, 7> kSpecial = {0.0, -0.0, 1e300, -1e-300, 5.0, kInfinity, kNan};
  const std::uint32_t pick = rng.next_u32() % 14;
  return pick < kSpecial.size() ? kSpecial[pick] : rng.normal() * std::exp(10.0 * rng.normal());
}

ConfigNode random_tree(Rng& rng, int depth, bool must_be_table) {
  const std::uint32_t pick = must_be_table ? 5 : rng.next_u32() % (depth > 0 ? 7 : 4);
  switch (pick) {
    case 0:
      return ConfigNode::from_boolean(rng.uniform() < 0.5);
    case 1:
      return ConfigNode::from_integer(static_cast<std::int64_t>(rng.next_u32()) - 2000000000);
    case 2:
      return ConfigNode::from_number(random_number(rng));
    case 3:
      return ConfigNode::from_text(random_text(rng));
    case 4: {
      ConfigNode node = ConfigNode::array();
      const bool has_tables_only = rng.uniform() < 0.3;
      for (std::uint32_t i = rng.next_u32() % 4; i > 0; --i) {
        node.items.push_back(random_tree(rng, depth - 1, has_tables_only));
      }
      return node;
    }
    default: {
      ConfigNode node = ConfigNode::table();
      for (std::uint32_t i = rng.next_u32() % 5; i > 0; --i) {
        const std::string name = random_text(rng);
        if (node.find(name) == nullptr) {
          node.items.push_back(random_tree(rng, depth - 1, false));
          node.names.push_back(name);
        }
      }
      return node;
    }
  }
}

TEST(ToToml, ReadsBackAsTheSameTreeForRandomTrees) {
  for (std::uint64_t i = 0; i < 3000; ++i) {
    Rng rng(31, Stream::kTest, i);
    const ConfigNode tree = random_tree(rng, 4, true);
    const std::string text = to_toml(tree);
    const ConfigNode read = parse_toml(text, "random.toml");
    ASSERT_TRUE(is_same_tree(tree, read)) << "case " << i << "\n" << text;
    ASSERT_EQ(to_toml(read), text) << "case " << i;
  }
}

TEST(ToToml, WritesPlainKeysBeforeTables) {
  const ConfigNode root = parse_toml(
      "[lighting.tunnel]\nradius_mm = 150.0\n[[viewpoint]]\nup = [0, 1, 0]\n[[viewpoint]]\n", "a");
  EXPECT_EQ(to_toml(root),
            "[lighting]\n\n[lighting.tunnel]\nradius_mm = 150.0\n\n[[viewpoint]]\nup = [0, 1, 0]\n"
            "\n[[viewpoint]]\n");
}

TEST(ValueToToml, WritesOneLine) {
  EXPECT_EQ(value_to_toml(ConfigNode::from_number(150)), "150.0");
  EXPECT_EQ(value_to_toml(ConfigNode::from_number(1e22)), "1e+22");
  EXPECT_EQ(value_to_toml(ConfigNode::from_integer(150)), "150");
  EXPECT_EQ(value_to_toml(ConfigNode::from_boolean(false)), "false");
  EXPECT_EQ(value_to_toml(ConfigNode::from_text("a\"b\\\n")), R"("a\"b\\\n")");
  const ConfigNode root = parse_toml(R"(v = { min = 1, choices = ["a", "b"], none = {} })", "a");
  EXPECT_EQ(value_to_toml(*root.find("v")), R"({ min = 1, choices = ["a", "b"], none = {} })");
}

TEST(AtPath, GoesThroughTablesAndArrays) {
  const ConfigNode root = parse_toml("[[viewpoint]]\nposition_mm = [1, 2, 3]\n[t]\n5 = 7\n", "a");
  EXPECT_EQ(root.at_path("viewpoint.0.position_mm.2")->integer, 3);
  EXPECT_EQ(root.at_path("t.5")->integer, 7);
  for (const char* path : {"viewpoint.1",
                           "viewpoint.x",
                           "viewpoint.0.position_mm.2.y",
                           "none",
                           "",
                           "viewpoint.-1",
                           "viewpoint.0x",
                           "t.5.1",
                           "."}) {
    EXPECT_EQ(root.at_path(path), nullptr) << path;
  }
}

TEST(SetPath, MakesTablesOnTheWay) {
  ConfigNode root = ConfigNode::table();
  set_path(root, "lighting.tunnel.radius_mm", ConfigNode::from_number(150));
  set_path(root, "lighting.tunnel.radius_mm", ConfigNode::from_number(160));
  set_path(root, "seed", ConfigNode::from_integer(3));
  EXPECT_EQ(to_toml(root), "seed = 3\n\n[lighting]\n\n[lighting.tunnel]\nradius_mm = 160.0\n");
}

TEST(SetPath, ReplacesAnItemOfAnArray) {
  ConfigNode root = parse_toml("position_mm = [1, 2, 3]\n", "a");
  set_path(root, "position_mm.1", ConfigNode::from_integer(20));
  EXPECT_EQ(to_toml(root), "position_mm = [1, 20, 3]\n");
}

TEST(SetPath, SaysWhyAPathCannotBeSet) {
  ConfigNode root = parse_toml("a = 1\nlist = [1, 2]\n", "x");
  const auto text_for = [&](const char* path) {
    return text_thrown_by<ConfigError>([&] { set_path(root, path, parse_override("1")); });
  };
  EXPECT_EQ(text_for("a.b"), "--set: a.b: \"a\" is a plain value and has no keys");
  EXPECT_EQ(text_for("list.2"),
            "--set: list.2: the array has 2 items, so the index must be below 2");
  EXPECT_EQ(text_for("list.x"),
            "--set: list.x: the array has 2 items, so the index must be below 2");
  EXPECT_EQ(text_for(""), "--set: \"\" is no key path");
  EXPECT_EQ(text_for("a..b"), "--set: \"a..b\" is no key path");
  ConfigNode plain = ConfigNode::from_integer(1);
  EXPECT_THROW(set_path(plain, "a", ConfigNode::from_integer(1)), ConfigError);
}

TEST(SetPath, LeavesTheTreeAloneWhenItFails) {
  ConfigNode root = parse_toml("a = 1\n", "x");
  EXPECT_THROW(set_path(root, "b.c..d", ConfigNode::from_integer(1)), ConfigError);
  EXPECT_EQ(to_toml(root), "a = 1\n");
}

TEST(Merge, MergesTablesAndReplacesTheRest) {
  ConfigNode base = parse_toml("x = 1\nlist = [1, 2, 3]\n[t]\na = 1\nb = 2\n[u]\nc = 1\n", "base");
  merge(base, parse_toml("list = [9]\nu = 5\n[t]\nb = 3\n[new]\nd = 1\n", "over"));
  EXPECT_EQ(to_toml(base), "x = 1\nlist = [9]\nu = 5\n\n[t]\na = 1\nb = 3\n\n[new]\nd = 1\n");
  EXPECT_EQ(base.at_path("t.b")->place.file, "over");
  EXPECT_EQ(base.at_path("t.a")->place.file, "base");
}

TEST(Merge, WithItselfChangesNothingForRandomTrees) {
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(32, Stream::kTest, i);
    const ConfigNode tree = random_tree(rng, 3, true);
    ConfigNode merged = tree;
    merge(merged, tree);
    ASSERT_TRUE(is_same_tree(merged, tree)) << to_toml(tree);
    ConfigNode from_nothing = ConfigNode::table();
    merge(from_nothing, tree);
    ASSERT_TRUE(is_same_tree(from_nothing, tree)) << to_toml(tree);
  }
}

}  // namespace
}  // namespace glint

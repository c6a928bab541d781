// SPDX-License-Identifier: GPL-3.0-or-later
//
// scene_with() reads the tables again that its values stand in; here its scenes and errors are
// compared with those of a reading of everything.
#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "core/rng.h"
#include "core/text.h"
#include "studies/definition/overrides.h"
#include "studies/definition/study.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using Kind = ConfigNode::Kind;

/// All that is read of a scene: its keys and what follows from them. Of a failure its messages.
template <class Read>
std::string outcome_of(const Read& read) {
  try {
    const SceneSettings scene = read();
    return fmt::format("{}reflectance {} channels {} tunnel {}\n",
                       to_toml(write_scene(scene)),
                       scene.render.reflectance,
                       scene.paths.channels,
                       scene.has_tunnel ? scene.tunnel_name : "none");
  } catch (const ConfigError& error) {
    return std::string("refused: ") + error.what();
  }
}

SceneSettings read_whole(const Study& study, const Overrides& overrides) {
  ConfigNode root = study.root;
  for (const auto& [path, value] : overrides) {
    put_override(root, study.resolved, path, value);
  }
  std::vector<Problem> errors;
  SceneSettings scene = read_scene(root, errors);
  throw_if_any(errors);
  return scene;
}

Study study_from(const std::string& text) {
  Study study;
  study.root = parse_toml(text, "s.toml");
  std::vector<Problem> errors;
  study.scene = read_scene(study.root, errors);
  throw_if_any(errors);
  study.resolved = write_scene(study.scene);
  return study;
}

/// Dotted paths of all single values: these may be variables.
void collect_values(const ConfigNode& node,
                    const std::string& path,
                    std::vector<std::string>& paths) {
  if (!node.is_table() && !node.is_array()) {
    paths.push_back(path);
  }
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const std::string name = node.is_table() ? node.names[i] : fmt::format("{}", i);
    collect_values(node.items[i], path.empty() ? name : path + "." + name, paths);
  }
}

/// Words that a key of this name takes somewhere in the key table, and one that none takes.
std::vector<std::string> words_for(const std::string& path) {
  std::vector<std::string> words = {"nonsense"};
  if (path == "lighting_use") {
    words.insert(words.end(), {"all", "tunnel", "ring"});
    return words;
  }
  const std::string name = path.substr(path.rfind('.'));
  if (name == ".type") {  // of a light, which is no row of the table
    words.insert(words.end(), {"tunnel", "ring", "dome"});
  }
  for (const KeyRow& row : scene_keys()) {
    if (row.kind == "choice" && row.path.ends_with(name)) {
      const std::vector<std::string> parts = split(row.allowed, '"');
      for (std::size_t i = 1; i < parts.size(); i += 2) {
        words.push_back(parts[i]);
      }
    }
  }
  return words;
}

/// Mostly near the value that is there, at times far from it.
ConfigNode random_value(const std::string& path, const ConfigNode& like, Rng& rng) {
  ConfigNode value;
  if (like.kind == Kind::kBoolean) {
    value = ConfigNode::from_boolean(rng.uniform() < 0.5);
  } else if (like.kind == Kind::kInteger) {
    value = ConfigNode::from_integer(like.integer + static_cast<int>(rng.uniform(-2.0, 6.0)));
  } else if (like.kind == Kind::kNumber) {
    const bool is_near = rng.uniform() < 0.8;
    value = ConfigNode::from_number(is_near ? like.number * rng.uniform(0.8, 1.2)
                                            : rng.uniform(-1000.0, 1000.0));
  } else {
    const std::vector<std::string> words = words_for(path);
    value = ConfigNode::from_text(words[rng.next_u32() % words.size()]);
  }
  value.place = {.file = "random.toml", .line = 7, .column = 1};
  return value;
}

std::vector<fs::path> gallery_files() {
  std::vector<fs::path> files;
  for (const auto& folder : fs::directory_iterator(GLINT_SOURCE_DIR "/studies/gallery")) {
    for (const char* name : {"study.toml", "scene.toml"}) {
      if (fs::exists(folder.path() / name)) {
        files.push_back(folder.path() / name);
      }
    }
  }
  std::ranges::sort(files);
  return files;
}

/// What came of the comparisons, so that none of them is for nothing.
struct Compared {
  std::set<Kind> read;  ///< kinds of values that reached a scene
  int refused = 0;
};

void compare(const Study& study, const Overrides& overrides, Compared& compared) {
  const std::string part = outcome_of([&] { return scene_with(study, overrides); });
  ASSERT_EQ(part, outcome_of([&] { return read_whole(study, overrides); }));
  const bool is_refused = part.starts_with("refused: ");
  compared.refused += is_refused ? 1 : 0;
  for (const auto& [path, value] : overrides) {
    if (!is_refused) {
      compared.read.insert(value.kind);
    }
  }
}

TEST(SceneWith, GivesScenesAndErrorsOfAWholeReadingForEveryKeyOfTheGallery) {
  Compared compared;
  std::uint64_t seed = 0;
  for (const fs::path& file : gallery_files()) {
    const Study study = load_study(file, {});
    std::vector<std::string> paths;
    collect_values(study.resolved, "", paths);
    ASSERT_GT(paths.size(), 100U);
    Rng rng(++seed, Stream::kTest, 0);
    const auto one_of = [&](const std::string& path) {
      return std::pair(path, random_value(path, *study.resolved.at_path(path), rng));
    };
    for (const std::string& path : paths) {
      ASSERT_NO_FATAL_FAILURE(compare(study, {one_of(path)}, compared)) << file << " " << path;
    }
    for (int i = 0; i < 100; ++i) {  // keys of several tables at once
      Overrides overrides;
      for (std::uint32_t k = 2 + rng.next_u32() % 3; k > 0; --k) {
        overrides.push_back(one_of(paths[rng.next_u32() % paths.size()]));
      }
      ASSERT_NO_FATAL_FAILURE(compare(study, overrides, compared)) << file << " set " << i;
    }
  }
  EXPECT_GE(seed, 12U);
  EXPECT_EQ(compared.read.size(), 4U) << "booleans, integers, numbers and texts";
  EXPECT_GT(compared.refused, 100);
}

TEST(SceneWith, GivesPointsOfTheSearchAsAWholeReadingDoes) {
  for (const fs::path& file : gallery_files()) {
    const Study study = load_study(file, {});
    for (std::uint64_t i = 0; i < 50 && study.has_search(); ++i) {
      Rng rng(3, Stream::kTest, i);
      std::vector<double> unit(study.space.variables.size());
      std::ranges::generate(unit, [&] { return rng.uniform(); });
      const Overrides overrides = overrides_of(study, point_from_unit(study.space, unit));
      ASSERT_EQ(outcome_of([&] { return scene_with(study, overrides); }),
                outcome_of([&] { return read_whole(study, overrides); }))
          << file << " point " << i;
    }
  }
}

TEST(SceneWith, WhatFollowsFromOtherTablesFollows) {
  const Study study = study_from("[render]\nrays_per_axis = 3\n");
  const auto with = [&](const std::string& path, double value) {
    return scene_with(study, {{path, ConfigNode::from_number(value)}});
  };
  EXPECT_EQ(with("camera.working_distance_mm", 700.0).viewpoint().position_mm[2], 700.0);
  const SceneSettings dim = with("material.reflectance.0", 0.25);
  EXPECT_EQ(dim.render.reflectance, 0.25);
  EXPECT_EQ(dim.render.rays_per_axis, 3);
  ConfigNode colours = ConfigNode::array();
  for (const double nm : {600.0, 550.0, 450.0}) {
    colours.items.push_back(ConfigNode::from_number(nm));
  }
  EXPECT_EQ(scene_with(study, {{"sensor.wavelengths_nm", colours}}).paths.channels, 3);
}

TEST(SceneWith, ConditionsBetweenTablesAreToldWithTheirPlaces) {
  const Study study = study_from("[render]\nmethod = \"closed\"\n");
  const auto refusal = [&](const std::string& path, ConfigNode value) {
    value.place = {.file = "prototype.toml", .line = 3, .column = 1};
    return outcome_of([&] { return scene_with(study, {{path, value}}); });
  };
  // The method stands in the file, the source with the value.
  EXPECT_THAT(refusal("material.type", ConfigNode::from_text("conductor")),
              ::testing::StartsWith("refused: s.toml:2:1: render.method: is \"closed\""));
  EXPECT_THAT(refusal("viewpoints.source", ConfigNode::from_text("sphere")),
              ::testing::StartsWith("refused: prototype.toml:3:1: viewpoints.source: a scan"));
}

// What is wrong in a table that no value touches is not looked at: it was read before.
TEST(SceneWith, ReadsNoOtherTables) {
  Study study = study_from("[sensor]\ngain = 2\n");
  study.root = parse_toml("[sensor]\ngain = -1\n", "s.toml");
  const SceneSettings scene = scene_with(study, {{"scan.positions", ConfigNode::from_integer(12)}});
  EXPECT_EQ(scene.scan.positions, 12);
  EXPECT_EQ(scene.sensor.gain, 2.0);
  EXPECT_THROW(scene_with(study, {{"sensor.bits", ConfigNode::from_integer(8)}}), ConfigError);
}

}  // namespace
}  // namespace glint

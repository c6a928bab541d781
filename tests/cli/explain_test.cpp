// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint explain`: keys, scores, tables, schema.
#include <algorithm>
#include <cstdlib>
#include <set>

#include <nlohmann/json.hpp>

#include "metrics/scores.h"
#include "studies/definition/key_table.h"
#include "studies/definition/scene.h"
#include "studies/definition/study_tables.h"
#include "tests/cli/program.h"

namespace glint::test {
namespace {

using Json = nlohmann::json;

using ::testing::HasSubstr;

/// Whether all calls of a kind are tried, or some: cli_long asks for all.
bool tries_all_calls() {
  return std::getenv("GLINT_ALL_CALLS") != nullptr;
}

TEST(Explain, KnowsEveryKeyOfTheKeyTable) {
  const TemporaryFolder folder;
  std::vector<KeyRow> rows = scene_keys();
  const std::vector<KeyRow> more = study_keys();
  rows.insert(rows.end(), more.begin(), more.end());
  std::map<std::string, std::set<std::string>> families;
  for (const KeyRow& row : rows) {
    families[row.path.substr(0, row.path.find('.'))].insert(row.path);
    EXPECT_NE(row.doc, "") << row.path;
  }
  EXPECT_GT(families.size(), 25U);
  int family_index = 0;
  for (const auto& [family, paths] : families) {
    if (family_index++ % 4 != 0 && !tries_all_calls()) {
      continue;
    }
    std::set<std::string> found;
    const Json json = json_of(folder, {"explain", family});
    for (const Json& row : json["found"]) {
      if (row.contains("key")) {
        found.insert(row["key"]);
      }
    }
    for (const std::string& path : paths) {
      EXPECT_TRUE(found.contains(path)) << path;
    }
  }
}

TEST(Explain, TellsUnitRangeAndDefault) {
  const TemporaryFolder folder;
  const Json found = json_of(folder, {"explain", "lighting.tunnel.radius_mm"})["found"];
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0]["unit"], "mm");
  EXPECT_EQ(found[0]["kind"], "number");
  EXPECT_NE(found[0]["allowed"], "");
  EXPECT_NE(found[0]["default"], "");
  // Named lights, named defects and array elements are explained by what they are made of.
  EXPECT_EQ(json_of(folder, {"explain", "lighting.top.radius_mm"})["found"], found);
  EXPECT_EQ(json_of(folder, {"explain", "viewpoint.0.position_mm.2"})["found"][0]["key"],
            "viewpoint.0.position_mm");
}

TEST(Explain, KnowsScoresAndPartsOfNames) {
  const TemporaryFolder folder;
  const ProgramResult score = glint_in(folder, {"explain", "homogeneity.h_rms"});
  EXPECT_EQ(score.code, 0);
  EXPECT_THAT(score.out, HasSubstr("1 - standard deviation / mean"));
  EXPECT_THAT(score.out, HasSubstr("a score"));
  EXPECT_EQ(json_of(folder, {"explain", "defects.dent_3.cnr"})["found"][0]["score"],
            "defects.dent_3.cnr");
  EXPECT_EQ(json_of(folder, {"explain", "period_mm"})["found"][0]["key"],
            "lighting.tunnel.period_mm");
}

TEST(Explain, OfAScoreOfDefectsIsThatScoreAlone) {
  const TemporaryFolder folder;
  for (const std::string score : {"defects.min_cnr", "defects.made", "defects.mean_change"}) {
    const Json found = json_of(folder, {"explain", score})["found"];
    ASSERT_EQ(found.size(), 1U) << score;
    EXPECT_EQ(found[0]["score"], score);
  }
}

// Names of the field alone tell a newcomer nothing.
TEST(Explain, OfTheWorstDefectsScoreTellsHowItIsMeasured) {
  const TemporaryFolder folder;
  EXPECT_THAT(glint_in(folder, {"explain", "defects.min_dprime"}).out,
              HasSubstr("norm of its deviation image / standard deviation of the background"));
  EXPECT_THAT(glint_in(folder, {"explain", "defects.min_union"}).out, HasSubstr("/ its true area"));
}

TEST(Explain, KnowsTheKeysOfTheFileItself) {
  const TemporaryFolder folder;
  for (const std::string key : {"title", "include", "schema"}) {
    const Json found = json_of(folder, {"explain", key})["found"];
    ASSERT_EQ(found.size(), 1U) << key;
    EXPECT_EQ(found[0]["key"], key);
  }
}

TEST(Explain, OfAKindOfDefectOrLightIsItsTable) {
  const TemporaryFolder folder;
  std::set<std::string> keys;
  const Json of_scratch = json_of(folder, {"explain", "scratch"});
  for (const Json& row : of_scratch["found"]) {
    keys.insert(row["key"]);
  }
  EXPECT_TRUE(keys.contains("defects.scratch.width_mm"));
  EXPECT_FALSE(keys.contains("defects.scratch.diameter_mm"));
  const Json of_ring = json_of(folder, {"explain", "ring"});
  for (const Json& row : of_ring["found"]) {
    EXPECT_TRUE(row["key"].get<std::string>().starts_with("lighting.ring.")) << row;
  }
  EXPECT_THAT(glint_in(folder, {"explain", "lighting.left.type"}).out, HasSubstr("\"ring\""));
}

TEST(Explain, OfAKeyThatIsAScoreTooTellsBoth) {
  const TemporaryFolder folder;
  const Json found = json_of(folder, {"explain", "inspection.threshold"})["found"];
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0]["score"], "inspection.threshold");
  EXPECT_EQ(found[1]["key"], "inspection.threshold");
}

TEST(Explain, ListsTheTablesAndAllKeys) {
  const TemporaryFolder folder;
  const Json groups = json_of(folder, {"explain"})["groups"];
  std::size_t keys = 0;
  for (const Json& group : groups) {
    EXPECT_GT(group["keys"], 0) << group;
    keys += group["keys"].get<std::size_t>();
  }
  EXPECT_EQ(keys, all_keys().size());
  EXPECT_EQ(json_of(folder, {"explain", "--all"})["found"].size(), keys + score_docs().size());
  const std::string list = glint_in(folder, {"explain"}).out;
  EXPECT_LT(std::ranges::count(list, '\n'), 45);
  EXPECT_THAT(list, HasSubstr("\n  lighting "));
  const std::string lights = glint_in(folder, {"explain", "lighting"}).out;
  EXPECT_LT(std::ranges::count(lights, '\n'), 40);
  EXPECT_THAT(lights, HasSubstr("lighting.ring "));
}

TEST(Explain, PrintsTheSchemaOfStudyFiles) {
  const TemporaryFolder folder;
  const ProgramResult plain = glint_in(folder, {"explain", "--schema"});
  EXPECT_EQ(plain.code, 0);
  EXPECT_EQ(Json::parse(plain.out)["title"], "Glint study");
  EXPECT_EQ(glint_in(folder, {"explain", "--schema", "--json"}).out, plain.out);
}

}  // namespace
}  // namespace glint::test

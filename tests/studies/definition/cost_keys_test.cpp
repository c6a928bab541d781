// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/scene_lights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "core/file.h"
#include "studies/definition/study.h"
#include "studies/definition/study_text.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

SceneSettings read(const std::string& text, std::vector<Problem>& errors) {
  return read_scene(parse_toml(text, "scene.toml"), errors);
}

std::string first_problem(const std::string& text) {
  std::vector<Problem> errors;
  read(text, errors);
  return errors.empty() ? "" : errors.front().message();
}

TEST(CostKeys, AreReadInTheirUnitsAndAbsentOnesStayUnknown) {
  std::vector<Problem> errors;
  const SceneSettings scene = read("[cost]\nexposure_ms = 12\nper_led = 0\n", errors);
  ASSERT_TRUE(errors.empty());
  ASSERT_TRUE(scene.cost.has_value());
  EXPECT_NEAR(scene.cost->exposure_s.value(), 0.012, 1e-15);
  EXPECT_EQ(scene.cost->per_led, 0.0);
  EXPECT_FALSE(scene.cost->move_s || scene.cost->per_mm2 || scene.cost->per_frame);
  EXPECT_FALSE(read("[part]\n", errors).cost.has_value());
}

TEST(CostKeys, WritingAndReadingBackGivesTheSameTable) {
  const std::string text = "[cost]\nexposure_ms = 12.5\nmove_ms = 40\nper_mm2 = 0.03\n";
  std::vector<Problem> errors;
  const ConfigNode written = write_scene(read(text, errors));
  const ConfigNode* cost = written.find("cost");
  ASSERT_NE(cost, nullptr);
  EXPECT_EQ(cost->names, (std::vector<std::string>{"exposure_ms", "move_ms", "per_mm2"}));
  EXPECT_EQ(to_toml(write_scene(read(to_toml(written), errors))), to_toml(written));
  EXPECT_TRUE(errors.empty());
  EXPECT_EQ(write_scene(read("[part]\n", errors)).find("cost"), nullptr);
}

TEST(CostKeys, WrongOnesAreToldWithTheirPlace) {
  EXPECT_THAT(first_problem("[cost]\nexposure_ms = 0\n"),
              HasSubstr("scene.toml:2:1: cost.exposure_ms: is 0, must be > 0"));
  EXPECT_THAT(first_problem("[cost]\nper_mm2 = -1\n"),
              HasSubstr("scene.toml:2:1: cost.per_mm2: is -1, must be >= 0"));
  EXPECT_THAT(first_problem("[cost]\nper_leds = 1\n"), HasSubstr("per_led"));
  EXPECT_THAT(first_problem("[cost]\nmove_ms = \"fast\"\n"), HasSubstr("cost.move_ms"));
}

TEST(CostKeys, AreListedWithoutDefault) {
  const std::vector<KeyRow> rows = cost_keys();
  ASSERT_EQ(rows.size(), 5U);
  EXPECT_EQ(rows[0].path, "cost.exposure_ms");
  EXPECT_EQ(rows[0].unit, "ms");
  for (const KeyRow& row : rows) {
    EXPECT_EQ(row.default_text, "none") << row.path;
  }
}

class CostOfStudyTest : public testing::Test {
 protected:
  Study study(const std::string& text) {
    write_file(folder_ / "study.toml", text);
    return load_study(folder_ / "study.toml", {});
  }

  std::string refusal(const std::string& text) {
    try {
      study(text);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }

  TemporaryFolder folder_;
};

TEST_F(CostOfStudyTest, ScoresThatNeedItSayWhatIsMissing) {
  const auto minimising = [](const std::string& score) {
    return "[objective]\nminimise = \"" + score + "\"\n";
  };
  EXPECT_THAT(refusal(minimising("scan.time_s")),
              HasSubstr("study.toml:2:1: objective.minimise: \"scan.time_s\" needs "
                        "cost.exposure_ms"));
  EXPECT_THAT(refusal("[cost]\nexposure_ms = 5\n" + minimising("scan.time_s")),
              HasSubstr("needs cost.move_ms"));
  EXPECT_EQ(refusal("[cost]\nexposure_ms = 5\nmove_ms = 9\n" + minimising("scan.time_s")), "");
  EXPECT_EQ(refusal("[cost]\nexposure_ms = 5\n[lighting.ring]\n" + minimising("scan.time_s")), "");
  EXPECT_THAT(refusal(minimising("cost.total")),
              HasSubstr("\"cost.total\" needs a price: cost.per_mm2, cost.per_led or "
                        "cost.per_frame"));
  EXPECT_THAT(refusal(minimising("lighting.widht_mm")), HasSubstr("\"lighting.width_mm\""));
  EXPECT_THAT(refusal("[constraints]\n\"cost.total\" = { max = 3 }\n"),
              HasSubstr("study.toml:2:1: constraints: \"cost.total\" needs a price"));
}

TEST_F(CostOfStudyTest, AnEnvironmentHasNoSize) {
  const std::string sky = "[lighting.sky]\ntype = \"environment\"\n[lighting.ring]\n";
  const std::string smallest = "[objective]\nminimise = \"lighting.area_mm2\"\n";
  EXPECT_THAT(refusal(sky + smallest),
              HasSubstr("\"lighting.area_mm2\" needs lights that have an end; lighting.sky is an "
                        "environment, around everything"));
  EXPECT_EQ(refusal("lighting_use = \"ring\"\n" + sky + smallest), "");
  EXPECT_THAT(refusal("lighting_use = \"ring\"\n" + sky + smallest +
                      "[variables]\n\"lighting_use\" = { choices = [\"ring\", \"sky\"] }\n"),
              HasSubstr("lighting.sky is an environment"));
  EXPECT_EQ(refusal(sky + "[objective]\nminimise = \"lighting.leds\"\n"), "");
  EXPECT_THAT(refusal(sky + "[cost]\nper_mm2 = 1\n[objective]\nminimise = \"cost.total\"\n"),
              HasSubstr("is an environment"));
}

TEST_F(CostOfStudyTest, ItIsPartOfWhatARunIs) {
  const std::string plain = config_hash(study("[part]\n"));
  EXPECT_NE(config_hash(study("[cost]\nper_led = 1\n")), plain);
  EXPECT_NE(config_hash(study("[cost]\nper_led = 1\n")),
            config_hash(study("[cost]\nper_led = 2\n")));
}

}  // namespace
}  // namespace glint

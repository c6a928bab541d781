// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/ladder/branch_split.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "tests/studies/plate_under_two_lights.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const std::string kLitPlate = std::string(test::kPlateUnderTwoLights) + R"([lighting.wide]
type = "ring"
inner_radius_mm = 30
outer_radius_mm = 40
height_mm = 30
[objective]
maximise = "homogeneity.mean"
[budget]
evaluations = 20
[accuracy]
tolerance = "auto"
)";

/// @param variables  lines of that table; a second one, sensor.bits, comes first
Study study_with(const std::string& variables, const std::vector<KeyValue>& sets = {}) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml",
             kLitPlate + "[variables]\n\"sensor.bits\" = { min = 8, max = 10 }\n" + variables);
  return load_study(folder / "study.toml", sets);
}

// Under the tunnel the plate is a mirror with closed forms, under a ring its light is sampled.
TEST(BranchSplit, IsTheChoiceThatChangesHowTheSceneIsRendered) {
  const Study study = study_with("lighting_use = { choices = [\"tunnel\", \"ring\", \"wide\"] }\n");
  const auto split = branch_split(study);
  ASSERT_TRUE(split.has_value());
  ASSERT_EQ(split->choices.size(), 1U);
  EXPECT_EQ(split->choices[0].variable, 1U);
  EXPECT_EQ(split->name, "lighting_use");
  EXPECT_THAT(split->values, ElementsAre("tunnel", "ring", "wide"));
  EXPECT_EQ(split->branch_of({9.0, 2.0}), 2U);
  EXPECT_EQ(split->branch_of({9.0, 0.0, 0.1}), 0U) << "with what building adds behind it";
  EXPECT_EQ(split->label(1), "lighting_use = ring");
  EXPECT_THAT(baseline_of(study, *split, 2), ElementsAre(baseline_point(study)[0], 2.0));
}

TEST(BranchSplit, IsNoChoiceAmongScenesOfOneKind) {
  EXPECT_FALSE(branch_split(study_with("lighting_use = { choices = [\"ring\", \"wide\"] }\n")));
  EXPECT_FALSE(branch_split(study_with("")));
}

// While it is inactive a design has the file's light, whatever its point says.
TEST(BranchSplit, IsNoChoiceWithACondition) {
  EXPECT_FALSE(branch_split(
      study_with("lighting_use = { choices = [\"tunnel\", \"ring\"], when = \"sensor.bits == 8\" "
                 "}\n")));
}

TEST(BranchSplit, PrototypesBelongWhereTheirValueDoes) {
  const Study study = study_with("lighting_use = { choices = [\"tunnel\", \"ring\"] }\n");
  const BranchSplit split = *branch_split(study);
  const auto with = [](const std::string& light) {
    return Overrides{{"lighting_use", ConfigNode::from_text(light)}};
  };
  EXPECT_EQ(branch_of(study, split, with("tunnel")), 0U);
  EXPECT_EQ(branch_of(study, split, with("ring")), 1U);
  EXPECT_FALSE(branch_of(study, split, with("wide")));
  EXPECT_FALSE(branch_of(study, split, {})) << "the file lets all of them shine";
}

const char* const kTunnelOrRing = "lighting_use = { choices = [\"tunnel\", \"ring\"] }\n";
const char* const kMirrorOrMatt = "\"material.type\" = { choices = [\"mirror\", \"diffuse\"] }\n";

// Only a mirror under a tunnel has closed forms, paths follow the others.
TEST(BranchSplit, OfTwoChoicesAreTheirCombinations) {
  const Study study = study_with(std::string(kTunnelOrRing) + kMirrorOrMatt);
  const auto split = branch_split(study);
  ASSERT_TRUE(split.has_value());
  EXPECT_EQ(split->name, "lighting_use, material.type");
  EXPECT_THAT(split->values,
              ElementsAre("tunnel, mirror", "tunnel, diffuse", "ring, mirror", "ring, diffuse"));
  EXPECT_EQ(split->branch_of({9.0, 1.0, 0.0}), 2U);
  EXPECT_EQ(split->label(1), "lighting_use = tunnel, material.type = diffuse");
  EXPECT_THAT(baseline_of(study, *split, 2), ElementsAre(baseline_point(study)[0], 1.0, 0.0));
  EXPECT_THAT(in_branch(study, *split, 1, {9.0, 1.0, 0.0}), ElementsAre(9.0, 0.0, 1.0));
  EXPECT_THAT(choices_in_common(study, split), IsEmpty());
  EXPECT_EQ(branch_of(study, *split, {{"lighting_use", ConfigNode::from_text("ring")}}), 2U)
      << "with the file's mirror";
}

TEST(BranchSplit, OfOneOfThemLeavesTheOtherInCommon) {
  const Study study = study_with(std::string(kTunnelOrRing) + kMirrorOrMatt);
  const auto split = one_choice_split(study);
  ASSERT_TRUE(split.has_value());
  EXPECT_THAT(split->values, ElementsAre("tunnel", "ring"));
  EXPECT_THAT(choices_in_common(study, split), ElementsAre("material.type"));
}

// Under the ring of the file paths follow mirrors and matt plates alike.
TEST(BranchSplit, FindsAChoiceThatMattersInAnotherBranchThanTheBaselines) {
  const Study study =
      study_with(std::string(kTunnelOrRing) + kMirrorOrMatt, {{"lighting_use", "ring"}});
  const auto split = branch_split(study);
  ASSERT_TRUE(split.has_value());
  EXPECT_EQ(split->name, "lighting_use, material.type");
}

// Six times three are more than sixteen.
TEST(BranchSplit, HasNoMoreThanSixteenBranches) {
  const Study study = study_with(
      "lighting_use = { choices = [\"tunnel\", \"ring\", \"wide\", \"ring+wide\", "
      "\"tunnel+ring\", \"tunnel+wide\"] }\n"
      "\"material.type\" = { choices = [\"mirror\", \"diffuse\", \"conductor\"] }\n",
      {{"render.method", "auto"}});
  const auto split = branch_split(study);
  ASSERT_TRUE(split.has_value());
  EXPECT_EQ(split->name, "lighting_use");
  EXPECT_EQ(split->values.size(), 6U);
  EXPECT_THAT(choices_in_common(study, split), ElementsAre("material.type"));
}

TEST(SearchRungs, AreNamedByTheValuesOfTheChoice) {
  RenderRung coarse;
  coarse.name = "8 samples";
  RenderRung fine;
  fine.name = "16 samples";
  EXPECT_EQ((SearchRungs{.split = {}, .rungs = {coarse}}.name()), "8 samples");
  const BranchSplit split = split_by({{0, "lighting_use", {"bar", "ring"}}});
  const SearchRungs two = {.split = split, .rungs = {coarse, fine}};
  EXPECT_EQ(two.name(), "bar: 8 samples; ring: 16 samples");
  EXPECT_EQ(two.of({1.0}).name, "16 samples");
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/starter/starter_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "studies/definition/study.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

/// A plan for a part of 60 x 20 x 10 mm under a camera at 300 mm.
StarterPlan small_plan(StarterLight light) {
  StarterPlan plan{.light = light, .name = "block", .part_file = "block.stl"};
  plan.study_file = "block.toml";
  plan.sizes = starter_sizes({60.0, 20.0, 10.0}, 0.0, 300.0, light);
  plan.places_mm = {{1.0, 2.0}};
  return plan;
}

// The top is 295 mm away and looks 300 / 295 times as large; with a margin of 10 % the picture is
// 1.1 x 1.01695 x 1000 = 1118.6 px wide, 372.9 px high, rounded up to 16. Reach across: half of
// hypot(20, 10) = 11.18 mm, so radius = ceil(22.36 + 20) = 43. The view has narrowed to
// (300 - 43) / 295 of 20 mm, 17.4 mm, where it passes the slot; 2 mm are added. Period: 43 / 6.
TEST(StarterSizes, FollowFromPartAndWorkingDistance) {
  const StarterSizes sizes = starter_sizes({60.0, 20.0, 10.0}, 0.0, 300.0, StarterLight::kTunnel);
  EXPECT_DOUBLE_EQ(sizes.object_pixel_mm, 0.06);
  EXPECT_EQ(sizes.width_px, 1120);
  EXPECT_EQ(sizes.height_px, 384);
  EXPECT_EQ(sizes.tunnel_radius_mm, 43.0);
  EXPECT_EQ(sizes.slot_mm, 20.0);
  EXPECT_EQ(sizes.length_mm, 318.0);
  EXPECT_EQ(sizes.period_mm, 7.0);
  EXPECT_DOUBLE_EQ(sizes.diameter_mm, 0.6);
}

TEST(StarterSizes, AreRefusedWhereTheLightWouldTouchThePart) {
  EXPECT_THROW(starter_sizes({60.0, 20.0, 10.0}, 0.0, 12.0, StarterLight::kTunnel), ConfigError);
  EXPECT_THROW(starter_sizes({60.0, 20.0, 10.0}, 0.0, 40.0, StarterLight::kRing), ConfigError);
  EXPECT_NO_THROW(starter_sizes({60.0, 20.0, 10.0}, 0.0, 60.0, StarterLight::kRing));
}

// 0.02 x (0.6 / 4) x sqrt(e) = 0.0049462 mm.
TEST(StarterPlan, MakesTheDentAsSteepAsWanted) {
  EXPECT_NEAR(small_plan(StarterLight::kTunnel).depth_mm(), 0.0049462, 1e-7);
}

// The part need only be there: a study names it, nothing opens it yet.
TEST(StarterText, OfEveryLightIsAStudyThatMaximisesItsDentsDetectability) {
  const TemporaryFolder folder;
  write_file(folder / "block.stl", "solid block\nendsolid block\n");
  for (const StarterLight light : {StarterLight::kTunnel,
                                   StarterLight::kRing,
                                   StarterLight::kDome,
                                   StarterLight::kBar,
                                   StarterLight::kAll}) {
    SCOPED_TRACE(std::string(light_name(light)));
    const StarterPlan plan = small_plan(light);
    write_file(folder / "block.toml", starter_text(plan));
    const Study study = load_study(folder / "block.toml", {});
    EXPECT_TRUE(study.goal.objective.is_maximised);
    EXPECT_EQ(study.goal.objective.name, objective_of(light));
    EXPECT_EQ(study.has_search(), light != StarterLight::kAll);
    EXPECT_EQ(study.prototypes.size(), light == StarterLight::kAll ? 3U : 0U);
    EXPECT_EQ(study.space.variables.size(), starter_space(plan).variables.size());
    for (const Variable& variable : study.space.variables) {
      const double start = study.resolved.at_path(variable.name)->number;
      EXPECT_LE(variable.low, start * (1.0 + 1e-9)) << variable.name;
      EXPECT_GE(variable.high, start * (1.0 - 1e-9)) << variable.name;
    }
  }
}

TEST(StarterText, LimitsEvennessAndClippingAndSaysWhatIsToBeKnownOfTheDent) {
  StarterPlan plan = small_plan(StarterLight::kTunnel);
  plan.min_h = 0.53;
  plan.remarks = {"Nothing shows it."};
  const std::string text = starter_text(plan);
  EXPECT_THAT(text, HasSubstr("\"homogeneity.h_rms\" = { min = 0.53 }"));
  EXPECT_THAT(text, HasSubstr("\"homogeneity.clipped_share\" = { max = 0.01 }"));
  EXPECT_THAT(text, HasSubstr("# Nothing shows it.\n[defects.dent]"));
  EXPECT_THAT(text, Not(HasSubstr("[material]")));
  EXPECT_THAT(text,
              HasSubstr("in a picture that is not much less even than at the start, and not"));
  EXPECT_THAT(starter_text(small_plan(StarterLight::kRing)), HasSubstr("type = \"conductor\""));
}

// Each design has an evenness of its own, so that only clipping is limited.
TEST(StarterText, OfAllLightsPromisesNoEvenness) {
  const std::string text = starter_text(small_plan(StarterLight::kAll));
  EXPECT_THAT(text, HasSubstr("# ... in a picture that is not overexposed.\n[constraints]\n"));
  EXPECT_THAT(text, HasSubstr("colour_srgb = [196, 199, 199] # steel"));
}

}  // namespace
}  // namespace glint

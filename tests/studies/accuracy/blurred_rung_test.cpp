// SPDX-License-Identifier: GPL-3.0-or-later
//
// Blurred reflections as rungs of a study of satin metal: taken where they serve, and nowhere else.
#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/studies/accuracy/chosen_for.h"

namespace glint {
namespace {

/// A bowl or a convex strip, by the radius across.
std::string study_text(double radius_mm, double alpha, const std::string& more = "") {
  return fmt::format(R"(schema = 1
[part]
shape = "strip"
length_mm = 46
width_mm = 18
radius_along_mm = 400
radius_across_mm = {}
[material]
type = "conductor"
alpha = [{}]
[camera]
width_px = 24
height_px = 12
object_pixel_mm = 1.6
working_distance_mm = 300
[sensor]
bits = 0
full_well_e = 0
blur_px = 0
[metrics]
erosion_px = 1
[scan]
positions = 4
[render.paths]
samples = 64
max_reflections = 1
[lighting.tunnel]
radius_mm = 100
slot_mm = 10
period_mm = 24
[variables]
"lighting.tunnel.duty" = {{ min = 0.3, max = 0.7 }}
"lighting.tunnel.radius_mm" = {{ min = 80, max = 120 }}
[objective]
maximise = "homogeneity.h_rms"
[search]
algorithm = "random"
[budget]
evaluations = 20
[accuracy]
tolerance = {{ "homogeneity.h_rms" = 0.03 }}
)",
                     radius_mm,
                     alpha) +
         more;
}

const StepReport* blurred_step(const ChosenAccuracy& chosen) {
  for (std::size_t i = 0; i < chosen.ladder.size(); ++i) {
    if (chosen.ladder[i].level == "blurred") {
      return &chosen.choice.steps[i];
    }
  }
  return nullptr;
}

TEST(BlurredRung, ServesASatinTunnel) {
  const ChosenAccuracy chosen = test::chosen_for(study_text(60, 0.05));
  const StepReport* step = blurred_step(chosen);
  ASSERT_NE(step, nullptr);
  EXPECT_TRUE(chosen.choice.is_reached);
  EXPECT_EQ(chosen.rung().level, "blurred") << chosen.rung().name;
  const auto& bounds = chosen.choice.steps[chosen.choice.step].bounds;
  ASSERT_FALSE(bounds.empty());
  fmt::print("h of \"{}\" within {:.4f}\n", chosen.rung().name, bounds[0].bound);
  EXPECT_EQ(chosen.top().level, "direct light") << "paths judge";
}

TEST(BlurredRung, IsNotOneOfRougherMetal) {
  const ChosenAccuracy chosen = test::chosen_for(study_text(60, 0.3));
  EXPECT_EQ(blurred_step(chosen), nullptr);
  EXPECT_EQ(chosen.rung().level, "direct light");
}

TEST(BlurredRung, CannotRenderABowl) {
  const ChosenAccuracy chosen = test::chosen_for(study_text(-10, 0.05));
  const StepReport* step = blurred_step(chosen);
  ASSERT_NE(step, nullptr);
  EXPECT_EQ(step->skipped, "cannot render every design");
  EXPECT_EQ(chosen.rung().level, "direct light");
}

}  // namespace
}  // namespace glint

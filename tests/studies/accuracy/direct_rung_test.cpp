// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sums of direct light as rungs of a study of brushed metal under a ring.
#include <algorithm>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/studies/accuracy/chosen_for.h"

namespace glint::direct_rung_test {
namespace {

std::string study_text(const std::string& lights) {
  return R"(schema = 1
[part]
shape = "plate"
length_mm = 46
width_mm = 18
thickness_mm = 3
[material]
type = "conductor"
alpha = [0.3, 0.15]
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
[render.paths]
samples = 64
max_reflections = 1
[lighting.ring]
height_mm = 60
[variables]
"lighting.ring.inner_radius_mm" = { min = 10, max = 25 }
"lighting.ring.outer_radius_mm" = { min = 30, max = 60 }
[objective]
maximise = "homogeneity.h_rms"
[search]
algorithm = "random"
[budget]
evaluations = 20
[accuracy]
tolerance = { "homogeneity.h_rms" = 0.1 }
)" + lights;
}

bool has_sums(const ChosenAccuracy& chosen) {
  return std::ranges::any_of(chosen.ladder,
                             [](const RenderRung& rung) { return rung.level == "direct sum"; });
}

TEST(DirectRung, ServesMetalUnderARing) {
  const ChosenAccuracy chosen = test::chosen_for(study_text(""));
  EXPECT_TRUE(chosen.choice.is_reached);
  EXPECT_EQ(chosen.rung().level, "direct sum") << chosen.rung().name;
  const auto& bounds = chosen.choice.steps[chosen.choice.step].bounds;
  ASSERT_FALSE(bounds.empty());
  fmt::print("h of \"{}\" within {:.4f}\n", chosen.rung().name, bounds[0].bound);
  EXPECT_EQ(chosen.top().level, "direct light") << "paths judge";
}

TEST(DirectRung, IsNotOneUnderASky) {
  const ChosenAccuracy chosen =
      test::chosen_for(study_text("[lighting.sky]\ntype = \"environment\"\nradiance = [0.1]\n"));
  EXPECT_FALSE(has_sums(chosen));
  EXPECT_EQ(chosen.rung().level, "direct light");
}

TEST(DirectRung, IsNotOneWherePathsAreAskedForByName) {
  EXPECT_FALSE(has_sums(test::chosen_for(study_text("[render]\nmethod = \"paths\"\n"))));
}

}  // namespace
}  // namespace glint::direct_rung_test

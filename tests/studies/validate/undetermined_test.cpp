// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/validate_result.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace glint {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// Ring and dome in two designs; the ring's place was found, all else was left as designed.
ValidationFindings all_determined() {
  ValidationFindings findings;
  findings.geometry.is_known = true;
  findings.geometry.sigma.setConstant(1e-3);
  findings.blur_px2 = 0.1;
  const GreyFit fit = {
      .is_known = true,
      .values = {{.fault = GreyFault::kExposure, .value = 0.95, .sigma = 0.002},
                 {.fault = GreyFault::kLightPlace, .light = "ring", .value = 1.8, .sigma = 0.1}},
      .kept = {{.fault = GreyFault::kLightPlace, .light = "dome", .index = 2, .sigma = 0.3},
               {.fault = GreyFault::kSegments, .light = "ring", .value = 1.0, .sigma = 0.01},
               {.fault = GreyFault::kRoughness, .value = 1.0, .sigma = 0.02}}};
  for (const char* design : {"ring", "dome"}) {
    findings.grey.push_back({.design = design, .fit = fit});
  }
  return findings;
}

TEST(Undetermined, IsNothingThatIsKnownBetterThanMatters) {
  EXPECT_THAT(undetermined_of(all_determined()), IsEmpty());
}

TEST(Undetermined, IsWhatAFitFoundButDoesNotKnow) {
  ValidationFindings findings = all_determined();
  for (DesignGrey& grey : findings.grey) {
    grey.fit.values[1].sigma = 0.7;
  }
  const auto numbers = undetermined_of(findings);
  ASSERT_EQ(numbers.size(), 1U) << "of both designs once";
  EXPECT_EQ(numbers[0].name, "light_place");
  EXPECT_EQ(numbers[0].of, "ring");
  EXPECT_EQ(numbers[0].value, "x_mm");
  EXPECT_EQ(numbers[0].sigma, 0.7);
  EXPECT_EQ(numbers[0].matters, 0.5);
}

TEST(Undetermined, IsWhatAFitCouldNotFree) {
  ValidationFindings findings = all_determined();
  for (DesignGrey& grey : findings.grey) {
    grey.fit.kept[0].sigma = std::numeric_limits<double>::infinity();
    grey.fit.kept[2].sigma = 0.2;
  }
  const nlohmann::ordered_json told = undetermined_json(undetermined_of(findings));
  ASSERT_EQ(told.size(), 2U);
  EXPECT_EQ(told[0]["of"], "dome");
  EXPECT_EQ(told[0]["value"], "z_mm");
  EXPECT_TRUE(told[0]["sigma"].is_null());
  EXPECT_THAT(told[0]["text"].get<std::string>(),
              HasSubstr("light place of dome, z_mm: undetermined, the pictures say nothing of it"));
  EXPECT_EQ(told[1]["name"], "roughness");
  EXPECT_THAT(told[1]["text"].get<std::string>(), HasSubstr("known to 0.2"));
  EXPECT_THAT(told[1]["text"].get<std::string>(), HasSubstr("0.03 would matter"));
}

// Without edges the part's place is known as well as it was before.
TEST(Undetermined, IsAPartWhoseEdgesAndPlaceAreNotKnown) {
  ValidationFindings findings = all_determined();
  findings.geometry.is_known = false;
  findings.part_sigma.setConstant(0.001);
  EXPECT_THAT(undetermined_of(findings), IsEmpty());
  findings.part_sigma.tail<3>().setConstant(0.4);
  const auto numbers = undetermined_of(findings);
  ASSERT_EQ(numbers.size(), 1U);
  EXPECT_EQ(numbers[0].name, "part_pose");
  EXPECT_NEAR(numbers[0].sigma.value_or(0.0), 0.6928, 1e-3);
}

TEST(Undetermined, AreGreyValuesAndBlurThatAreNotSeen) {
  ValidationFindings findings = all_determined();
  findings.grey[1].fit = {};
  findings.blur_px2.reset();
  const auto numbers = undetermined_of(findings);
  ASSERT_EQ(numbers.size(), 2U);
  EXPECT_EQ(numbers[0].name + " of " + numbers[0].of, "light_power of dome");
  EXPECT_EQ(numbers[1].name, "blur");
  EXPECT_FALSE(numbers[1].sigma);
}

}  // namespace
}  // namespace glint

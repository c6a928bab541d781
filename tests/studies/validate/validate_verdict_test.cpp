// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/validate_verdict.h"

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace glint {
namespace {

using testing::HasSubstr;

/// Edges 0.2 px apart, grey values alike.
ValidationFindings alike() {
  ValidationFindings findings;
  findings.distance_px = 0.2;
  findings.geometry.is_known = true;
  findings.grey.push_back(
      {.design = "ring",
       .fit = {.is_known = true, .before = 0.01, .exposed = 0.01, .after = 0.01}});
  return findings;
}

TEST(Verdict, AgreesWhereNothingDiffers) {
  const ValidateVerdict verdict = judge(alike());
  EXPECT_EQ(verdict.agreement, SidesAgreement::kAgrees);
  EXPECT_TRUE(verdict.faults.empty());
  EXPECT_THAT(verdict.sentence, HasSubstr("agree"));
}

TEST(Verdict, AgreesAfterARefitOfTheExposure) {
  ValidationFindings findings = alike();
  findings.grey[0].fit.before = 0.05;
  findings.grey[0].fit.change.exposure = 0.95;
  const ValidateVerdict verdict = judge(findings);
  EXPECT_EQ(verdict.agreement, SidesAgreement::kAfterRefit);
  ASSERT_EQ(verdict.faults.size(), 1U);
  EXPECT_EQ(verdict.faults[0].name, "exposure");
  EXPECT_TRUE(verdict.faults[0].is_within);
}

// Four standard deviations of 2 % are 8 %, of 0.2 % less than the 1 % that matters.
TEST(Verdict, AnExposureWithinItsNoiseIsNoCause) {
  ValidationFindings findings = alike();
  GreyFit& fit = findings.grey[0].fit;
  fit.change.exposure = 1.02;
  fit.values = {{.fault = GreyFault::kExposure, .value = 1.02, .sigma = 0.02}};
  EXPECT_TRUE(judge(findings).faults.empty());
  fit.change.exposure = 1.05;
  fit.values = {{.fault = GreyFault::kExposure, .value = 1.05, .sigma = 0.002}};
  const ValidateVerdict verdict = judge(findings);
  ASSERT_EQ(verdict.faults.size(), 1U);
  EXPECT_EQ(verdict.faults[0].name, "exposure");
  EXPECT_DOUBLE_EQ(verdict.faults[0].values[0].sigma, 0.002);
}

/// Ring as designed, and a dome whose lights have another power, found with that sigma.
ValidationFindings with_a_power(double power, double sigma) {
  ValidationFindings findings = alike();
  findings.grey[0].fit.values = {{.fault = GreyFault::kExposure, .value = 1.0, .sigma = 0.003}};
  findings.grey.push_back(findings.grey[0]);
  findings.grey[1].design = "dome";
  findings.grey[1].fit.change.exposure = power;
  findings.grey[1].fit.values.push_back(
      {.fault = GreyFault::kLightPower, .light = "dome", .value = power, .sigma = sigma});
  return findings;
}

// The ratio of both: the power's own noise, and the exposure's of each.
TEST(Verdict, APowerWithinItsNoiseIsNoCause) {
  EXPECT_TRUE(judge(with_a_power(1.1, 0.05)).faults.empty());
  const ValidateVerdict verdict = judge(with_a_power(1.1, 0.004));
  ASSERT_EQ(verdict.faults.size(), 1U);
  EXPECT_EQ(verdict.faults[0].name, "light_power");
  // (1.1 x 0.003)^2 + 0.004^2 of the dome, (1.1 x 0.003)^2 of the ring
  EXPECT_NEAR(verdict.faults[0].values[0].sigma, std::sqrt(2 * 1.089e-5 + 1.6e-5), 1e-9);
}

// However little the exposure is known that both share: dead segments beside it leave it open.
TEST(Verdict, ThePowerOfADesignThatWasFittedWithTheOthersDoesNotHangOnTheirExposure) {
  ValidationFindings findings = with_a_power(1.1, 0.004);
  for (DesignGrey* grey : {&findings.grey[0], &findings.grey[1]}) {
    grey->fit.values[0].sigma = 0.03;
    grey->fit.is_joint = true;
  }
  findings.grey[1].fit.power = 1.1;
  findings.grey[1].fit.power_sigma = 0.004;
  const ValidateVerdict verdict = judge(findings);
  ASSERT_EQ(verdict.faults.size(), 1U);
  EXPECT_EQ(verdict.faults[0].name, "light_power");
  EXPECT_NEAR(verdict.faults[0].values[0].sigma, 0.004, 1e-12);
}

// Variances add: 2 px of more blur are 4 px2, 0.8 px are 0.64.
TEST(Verdict, ComparesBlurWithItsLimitInPixels) {
  ValidationFindings findings = alike();
  findings.limits.blur_px = 1.0;
  findings.blur_px2 = -0.64;
  EXPECT_EQ(judge(findings).agreement, SidesAgreement::kAgrees);
  findings.blur_px2 = -4.0;
  EXPECT_EQ(judge(findings).agreement, SidesAgreement::kDisagrees);
}

/// Ring, dome and one that is dark, as bright as told against the others.
ValidationFindings with_a_dark_one(double exposure, double rounding) {
  ValidationFindings findings = alike();
  findings.grey.push_back(findings.grey[0]);
  findings.grey.push_back(findings.grey[0]);
  findings.grey[1].design = "dome";
  findings.grey[2].design = "dark";
  findings.grey[2].fit.change.exposure = exposure;
  findings.grey[2].fit.rounding = rounding;
  return findings;
}

TEST(Verdict, AllowsADarkDesignWhatRoundingMakesOfIt) {
  EXPECT_EQ(judge(with_a_dark_one(1.3, 0.35)).agreement, SidesAgreement::kAgrees);
  EXPECT_EQ(judge(with_a_dark_one(2.0, 0.35)).agreement, SidesAgreement::kDisagrees);
  const ValidateVerdict verdict = judge(with_a_dark_one(1.3, 0.0));
  ASSERT_EQ(verdict.faults.size(), 1U);
  EXPECT_EQ(verdict.faults[0].name, "light_power");
  EXPECT_EQ(verdict.faults[0].of, "dark");
}

/// Three designs of these exposures and shares of rounding.
ValidationFindings exposed(const std::vector<std::array<double, 2>>& designs) {
  ValidationFindings findings = alike();
  const DesignGrey one = findings.grey[0];
  findings.grey.clear();
  for (const auto& [exposure, rounding] : designs) {
    findings.grey.push_back(one);
    findings.grey.back().design = "design_" + std::to_string(findings.grey.size());
    findings.grey.back().fit.change.exposure = exposure;
    findings.grey.back().fit.rounding = rounding;
  }
  return findings;
}

/// "exposure; light_power design_2": causes as told.
std::string causes_of(const std::vector<std::array<double, 2>>& designs) {
  std::string text;
  for (const ToldFault& fault : judge(exposed(designs)).faults) {
    text += (text.empty() ? "" : "; ") + fault.name + (fault.of.empty() ? "" : " ") + fault.of;
  }
  return text;
}

// Two rounded ones that agree outvote a bright one, if rounding cannot be what they differ by.
TEST(Verdict, OneBrightDesignIsNotTheMeasureOfAllOthers) {
  EXPECT_EQ(causes_of({{1.10, 1e-4}, {1.0, 0.04}, {1.0, 0.04}}), "light_power design_1");
  EXPECT_EQ(causes_of({{1.10, 1e-4}, {1.0, 0.35}, {1.0, 0.35}}), "exposure");
  EXPECT_EQ(causes_of({{1.0, 1e-4}, {1.0, 0.04}, {1.02, 0.04}}), "");
  EXPECT_EQ(causes_of({{0.9, 1e-4}, {0.9, 1e-4}, {0.9, 1e-4}, {1.3, 0.5}}), "exposure");
}

// 0.75 and 1.28 may both be 1 when rounding makes 30 % of them: 0.75 / 1.3 to 0.75 / 0.7 holds 1,
// 1.28 / 1.3 to 1.28 / 0.7 does. 0.6 / 0.7 does not reach 1.28 / 1.3.
TEST(Verdict, AllowsRoundingOnBothSidesOfARatio) {
  EXPECT_EQ(causes_of({{0.75, 0.3}, {1.25, 0.3}, {1.28, 0.3}}), "");
  EXPECT_EQ(causes_of({{0.60, 0.3}, {1.25, 0.3}, {1.28, 0.3}}), "light_power design_1");
  EXPECT_EQ(causes_of({{0.75, 0.1}, {1.25, 0.1}, {1.28, 0.1}}), "exposure; light_power design_1");
}

TEST(Verdict, ADeadLightIsNoRounding) {
  EXPECT_EQ(causes_of({{5e-4, 1e-3}}), "exposure");
  EXPECT_EQ(causes_of({{5e-4, 1e-3}, {1.0, 1e-3}}), "light_power design_1");
  EXPECT_EQ(causes_of({{1.0, 1e-3}, {5e-4, 1e-3}, {1.0, 0.04}}), "light_power design_2");
  EXPECT_EQ(judge(exposed({{5e-4, 1e-3}})).agreement, SidesAgreement::kDisagrees);
}

TEST(Verdict, TellsWhichDesignsAreTooDarkToBeJudged) {
  const double unbounded = std::numeric_limits<double>::infinity();
  for (const double rounding : {0.8, unbounded}) {
    const ValidateVerdict verdict = judge(exposed({{1.0, 1e-3}, {0.3, rounding}}));
    EXPECT_EQ(verdict.agreement, SidesAgreement::kAgrees);
    EXPECT_THAT(verdict.sentence, HasSubstr("Grey values of design_2 are too dark to be judged"));
    ASSERT_EQ(verdict.notes.size(), 1U);
    EXPECT_THAT(verdict.notes[0], HasSubstr("design_2: its grey values cannot be judged"));
  }
  EXPECT_TRUE(judge(exposed({{1.0, 0.4}})).notes.empty());
  EXPECT_EQ(causes_of({{1.0, 1e-3}, {3.0, 0.8}}), "light_power design_2") << "more than rounding";
}

TEST(Verdict, NamesNoRefitOfNothing) {
  ValidationFindings findings = alike();
  findings.grey[0].fit.before = 0.05;
  const ValidateVerdict verdict = judge(findings);
  EXPECT_EQ(verdict.agreement, SidesAgreement::kAfterRefit);
  EXPECT_EQ(verdict.sentence, "Simulation and reality agree after a refit.");
}

TEST(Verdict, TakesTheExposureFromDesignsThatAreHardlyRounded) {
  ValidationFindings findings = with_a_dark_one(1.3, 0.35);
  findings.grey.erase(findings.grey.begin());
  EXPECT_EQ(judge(findings).agreement, SidesAgreement::kAgrees);
  findings.grey.erase(findings.grey.begin());
  EXPECT_EQ(judge(findings).agreement, SidesAgreement::kAgrees) << "only the dark one is left";
  findings.grey[0].fit.rounding = 0.1;
  EXPECT_EQ(judge(findings).agreement, SidesAgreement::kDisagrees);
}

TEST(Verdict, NamesALightThatStandsTooFarOff) {
  ValidationFindings findings = alike();
  GreyFit& fit = findings.grey[0].fit;
  fit.before = fit.exposed = 0.1;
  fit.values = {
      {.fault = GreyFault::kLightPlace, .light = "ring", .index = 0, .value = 20.0, .sigma = 0.2}};
  const ValidateVerdict verdict = judge(findings);
  EXPECT_EQ(verdict.agreement, SidesAgreement::kDisagrees);
  ASSERT_EQ(verdict.faults.size(), 1U);
  EXPECT_EQ(verdict.faults[0].name, "light_place");
  EXPECT_EQ(verdict.faults[0].of, "ring");
  EXPECT_FALSE(verdict.advice.empty());
}

TEST(Verdict, NamesADeadSegmentByItsNumber) {
  ValidationFindings findings = alike();
  GreyFit& fit = findings.grey[0].fit;
  fit.before = fit.exposed = 0.1;
  fit.values = {
      {.fault = GreyFault::kSegments, .light = "ring", .index = 2, .value = 0.01, .sigma = 0.02}};
  const ValidateVerdict verdict = judge(findings);
  ASSERT_EQ(verdict.faults.size(), 1U);
  EXPECT_EQ(verdict.faults[0].name, "dead_segment");
  EXPECT_EQ(verdict.faults[0].of, "ring, segment 3");
}

TEST(Verdict, AllowsEdgesWhatCalibrationAndPlacementPredict) {
  ValidationFindings findings = alike();
  findings.distance_px = 1.4;
  findings.geometry.faults = {GeometryFault::kFocalLength};
  EXPECT_EQ(judge(findings).agreement, SidesAgreement::kDisagrees);
  findings.geometry.pose_budget_px = 0.5;  // 3 x 0.5 = 1.5 px
  EXPECT_EQ(judge(findings).agreement, SidesAgreement::kAgrees);
}

TEST(Verdict, NamesAPartThatIsTiltedThoughItsEdgesHardlyMove) {
  ValidationFindings findings = alike();
  findings.geometry.faults = {GeometryFault::kPartPose};
  findings.geometry.part << 0.05, 0, 0, 0, 0, 0;  // 2.9 degrees
  findings.geometry.sigma.setConstant(1e-3);
  const ValidateVerdict verdict = judge(findings);
  EXPECT_EQ(verdict.agreement, SidesAgreement::kDisagrees);
  ASSERT_EQ(verdict.faults.size(), 1U);
  EXPECT_EQ(verdict.faults[0].name, "part_pose");
  // Noise, or less than what a refit sets right.
  findings.geometry.sigma.setConstant(0.02);
  EXPECT_EQ(judge(findings).agreement, SidesAgreement::kAgrees);
  findings.geometry.sigma.setConstant(1e-4);
  findings.geometry.part << 0.005, 0, 0, 0, 0, 0;
  EXPECT_EQ(judge(findings).agreement, SidesAgreement::kAgrees);
}

TEST(Verdict, ALensIsNeverSetRightByARefit) {
  ValidationFindings findings = alike();
  findings.distance_px = 0.7;
  findings.geometry.faults = {GeometryFault::kFocalLength};
  findings.geometry.lens[0] = 3.0;
  const ValidateVerdict verdict = judge(findings);
  EXPECT_EQ(verdict.agreement, SidesAgreement::kDisagrees);
  EXPECT_EQ(verdict.faults[0].name, "lens");
  EXPECT_EQ(verdict_json(verdict)["causes"][0]["of"], "focal_length");
}

TEST(Verdict, DoesNotAgreeWhereTheRankingIsReversed) {
  ValidationFindings findings = alike();
  Ranking same = {.simulated = {"a", "b"}, .real = {"a", "b"}};
  same.pairs.push_back({.first = "a", .second = "b"});
  Ranking reversed = {.simulated = {"a", "b"}, .real = {"b", "a"}, .agrees = false};
  reversed.pairs.push_back({.first = "a", .second = "b", .is_against = true});
  findings.rankings = {{.objective = "contrast", .ranking = same},
                       {.objective = "evenness", .ranking = reversed}};
  const ValidateVerdict verdict = judge(findings);
  EXPECT_EQ(verdict.agreement, SidesAgreement::kDisagrees);
  EXPECT_THAT(verdict.sentence, HasSubstr("by contrast holds in reality"));
  EXPECT_THAT(verdict.sentence, HasSubstr("by evenness is another: b, a instead of a, b"));
}

TEST(Verdict, NamesDesignsWhosePartIsTooThin) {
  ValidationFindings findings = alike();
  findings.grey[0].fit.is_thin = true;
  const ValidateVerdict verdict = judge(findings);
  EXPECT_THAT(verdict.sentence, HasSubstr("Grey values of ring tell little but the exposure"));
  ASSERT_EQ(verdict.notes.size(), 1U);
  EXPECT_THAT(verdict.notes[0], HasSubstr("ring: most of its part is thinner than three pixels"));
}

TEST(Verdict, NamesDesignsWhoseGreyValuesCouldNotBeCompared) {
  ValidationFindings findings = alike();
  findings.grey.push_back({.design = "tunnel", .fit = {}});
  EXPECT_THAT(judge(findings).sentence, HasSubstr("Grey values of tunnel could not be compared"));
}

}  // namespace
}  // namespace glint

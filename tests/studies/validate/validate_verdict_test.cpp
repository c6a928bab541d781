// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/validate_verdict.h"

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

TEST(Verdict, TakesTheExposureFromDesignsThatAreHardlyRounded) {
  ValidationFindings findings = with_a_dark_one(1.3, 0.35);
  findings.grey.erase(findings.grey.begin());
  EXPECT_EQ(judge(findings).agreement, SidesAgreement::kAgrees);
  EXPECT_EQ(fits_by_exposure(findings.grey).size(), 1U);
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
  findings.ranking = Ranking{.simulated = {"a", "b"}, .real = {"b", "a"}, .agrees = false};
  findings.ranking->pairs.push_back({.first = "a", .second = "b", .is_against = true});
  const ValidateVerdict verdict = judge(findings);
  EXPECT_EQ(verdict.agreement, SidesAgreement::kDisagrees);
  EXPECT_THAT(verdict.sentence, HasSubstr("b, a instead of a, b"));
}

}  // namespace
}  // namespace glint

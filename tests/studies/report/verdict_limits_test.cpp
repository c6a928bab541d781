// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a verdict says of limits.
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/studies/report/verdict_data.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

/// sound_search() whose winner keeps its limit, an evenness of 0.7, with that probability.
Json search_with_chance(double probability, double expected) {
  Json data = sound_search();
  Json& winner = data["designs"][1];
  winner["feasible"] = probability >= 0.5;
  winner["limits"] = {{"probability", probability},
                      {"by", "model"},
                      {"scores", {{"homogeneity.h_rms", {{"value", expected}, {"sd", 0.02}}}}}};
  return data;
}

TEST(Verdict, TellsHowProbablyLimitsAreKeptUnderNoise) {
  const Json likely = search_with_chance(0.75, 0.8);
  EXPECT_EQ(text_of_code(likely, "limits_met"),
            "By the search's model it keeps the constraint with a probability of 75 %.");
  EXPECT_EQ(text_of_code(likely, "limits_unlikely"), "");
  EXPECT_EQ(complete_report(likely)["verdict"]["tone"], "good");
  // Its one evaluation is within the limit, which is no answer to what is expected of it.
  Json unlikely = search_with_chance(0.3125, 0.65);
  EXPECT_THAT(text_of_code(unlikely, "no_feasible"),
              HasSubstr("No design is expected to meet every constraint. The most likely one"));
  EXPECT_EQ(text_of_code(unlikely, "limits_unlikely"),
            "By the search's model it keeps the constraint with a probability of 31 % only.");
  EXPECT_EQ(text_of_code(unlikely, "limit_failed"),
            "It is expected to miss a limit: h (rms) is 65.0 %, must be at least 70.0 %.");
  EXPECT_EQ(complete_report(unlikely)["verdict"]["tone"], "bad");
  unlikely["designs"][1]["limits"]["by"] = "replicates";
  EXPECT_THAT(text_of_code(unlikely, "limits_unlikely"), HasSubstr("By its replicates it keeps"));
}

/// What is said of a design whose score has that value, beside its limits.
std::string said_of_limit(const char* score, double value, const Json& limits) {
  Json data = prototypes();
  data["constraints"] = Json::array({limits});
  data["constraints"][0]["name"] = score;
  for (Json& design : data["designs"]) {
    design["feasible"] = false;
    design["scores"][score] = value;
  }
  return text_of_code(data, "limit_failed");
}

TEST(Verdict, ShowsByHowLittleALimitIsMissed) {
  const auto cnr = [](double value, const Json& limits) {
    return said_of_limit("defects.min_cnr", value, limits);
  };
  EXPECT_EQ(cnr(4.998, {{"min", 5}}),
            "It misses a limit: smallest CNR is 4.998, must be at least 5.");
  EXPECT_THAT(cnr(2.1, {{"min", 3}}), HasSubstr("is 2.10, must be at least 3."));
  EXPECT_THAT(cnr(12.8, {{"min", 12.84}}), HasSubstr("is 12.80, must be at least 12.84."));
  EXPECT_THAT(cnr(5.00004, {{"min", 1}, {"max", 5}}),
              HasSubstr("is 5.00004, must be at least 1 and at most 5."));
  const auto even = [](double value, const Json& limits) {
    return said_of_limit("homogeneity.h_rms", value, limits);
  };
  EXPECT_THAT(even(0.6998, {{"min", 0.7}}), HasSubstr("is 69.98 %, must be at least 70.00 %."));
  EXPECT_THAT(even(0.6, {{"min", 0.7125}}), HasSubstr("is 60.0 %, must be at least 71.25 %."));
  EXPECT_THAT(even(0.0063, {{"min", 0.7}}), HasSubstr("is 0.63 %, must be at least 70.0 %."));
}

}  // namespace
}  // namespace glint

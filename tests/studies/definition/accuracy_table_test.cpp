// SPDX-License-Identifier: GPL-3.0-or-later
//
// [accuracy]: what it reads, refuses and writes.
#include "studies/definition/accuracy_table.h"
#include "studies/definition/ladder/render_ladder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "studies/definition/study_schema.h"
#include "studies/definition/study_text.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kTunnelSearch =
    "[lighting.tunnel]\n[defects.dent]\nx_mm = [5]\ny_mm = [10]\n"
    "[variables]\n\"lighting.tunnel.duty\" = { min = 0.3, max = 0.7 }\n"
    "[objective]\nmaximise = \"defects.min_cnr\"\n";

Study accurate_study(const std::string& text, const std::vector<KeyValue>& sets = {}) {
  const TemporaryFolder folder;
  write_file(folder / "s.toml", text);
  return load_study(folder / "s.toml", sets);
}

std::string refusal_of(const std::string& text, const std::vector<KeyValue>& sets = {}) {
  try {
    const Study study = accurate_study(text, sets);
    check_ladder(study, render_ladder(study.scene, kept_keys(study.root)));
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

std::string refusal_of_tolerance(const std::string& value) {
  return refusal_of(kTunnelSearch + "[accuracy]\ntolerance = " + value + "\n");
}

TEST(ReadAccuracy, AbsentLeavesTheStudyAsItWas) {
  const Study study = accurate_study(kTunnelSearch);
  EXPECT_FALSE(study.accuracy.has_value());
  EXPECT_THAT(resolved_text(study), Not(HasSubstr("accuracy")));
}

TEST(ReadAccuracy, TakesAutoAndNumbersSharesAndPoints) {
  const Study study =
      accurate_study(kTunnelSearch + "[accuracy]\ntolerance = \"auto\"\nconfidence = 0.95\n");
  EXPECT_TRUE(study.accuracy->is_auto);
  EXPECT_EQ(study.accuracy->confidence, 0.95);
  const Study wished = accurate_study(
      kTunnelSearch +
      "[accuracy]\ntolerance = { \"homogeneity.h_rms\" = \"0.1 points\", \"defects.min_cnr\" = "
      "\"2 %\", \"homogeneity.mean\" = 0.01 }\n");
  ASSERT_EQ(wished.accuracy->wishes.size(), 3U);
  EXPECT_FALSE(wished.accuracy->is_auto);
  EXPECT_EQ(wished.accuracy->confidence, 0.99);
  EXPECT_DOUBLE_EQ(wished.accuracy->wishes[0].tolerance, 0.001);
  EXPECT_FALSE(wished.accuracy->wishes[0].is_relative);
  EXPECT_DOUBLE_EQ(wished.accuracy->wishes[1].tolerance, 0.02);
  EXPECT_TRUE(wished.accuracy->wishes[1].is_relative);
  EXPECT_EQ(wished.accuracy->wishes[2].score, "homogeneity.mean");
  EXPECT_EQ(wished.accuracy->wishes[2].tolerance, 0.01);
}

TEST(ReadAccuracy, TheCommandLineSetsIt) {
  EXPECT_TRUE(accurate_study(kTunnelSearch, {{"accuracy.tolerance", "auto"}}).accuracy->is_auto);
  const Study study =
      accurate_study(kTunnelSearch, {{"accuracy.tolerance", R"({ "defects.min_cnr" = "5 %" })"}});
  EXPECT_DOUBLE_EQ(study.accuracy->wishes.at(0).tolerance, 0.05);
}

TEST(ReadAccuracy, RefusesWithPlaceWhatIsNoTolerance) {
  for (const char* value :
       {"0", "-1", "\"2 kg\"", "\"%\"", "true", "\"-3 %\"", "[1]", "{}", "inf"}) {
    EXPECT_THAT(refusal_of_tolerance(std::string("{ \"defects.min_cnr\" = ") + value + " }"),
                AllOf(HasSubstr("s.toml:10:"),
                      HasSubstr("accuracy.tolerance: defects.min_cnr: is "),
                      HasSubstr("must be a number > 0")))
        << value;
  }
  for (const char* value : {"\"best\"", "0.1", "{}", "true", "[]"}) {
    EXPECT_THAT(refusal_of_tolerance(value),
                AllOf(HasSubstr("s.toml:10:"), HasSubstr("must be \"auto\" or a table")))
        << value;
  }
  EXPECT_THAT(refusal_of(kTunnelSearch + "[accuracy]\n"),
              HasSubstr("s.toml:9:2: accuracy.tolerance: is missing"));
}

TEST(ReadAccuracy, RefusesUnknownScoresWithTheNearest) {
  EXPECT_THAT(refusal_of_tolerance("{ \"homogeneity.h_rm\" = 1 }"),
              AllOf(HasSubstr("s.toml:10:"),
                    HasSubstr("accuracy.tolerance: \"homogeneity.h_rm\""),
                    HasSubstr("homogeneity.h_rms")));
  EXPECT_THAT(refusal_of_tolerance("{ \"homogeneity.h_rms.high\" = 1 }"),
              HasSubstr("is the bound or the error of a score"));
}

TEST(ReadAccuracy, RefusesOtherKeysAndConfidences) {
  const std::string table = kTunnelSearch + "[accuracy]\ntolerance = \"auto\"\n";
  EXPECT_THAT(refusal_of(table + "confidence = 1\n"), HasSubstr("s.toml:11:"));
  EXPECT_THAT(refusal_of(table + "confidence = 0.4\n"), HasSubstr("accuracy.confidence"));
  EXPECT_THAT(refusal_of(table + "tolerence = 1\n"), HasSubstr("tolerance"));
  EXPECT_THAT(refusal_of(table + "keep = [\"render.max_bounces\"]\n"),
              HasSubstr("accuracy.keep: \"render.max_bounces\" is none of the keys"));
  EXPECT_THAT(refusal_of(table + "keep = \"render.method\"\n"),
              HasSubstr("must be a list of keys"));
}

TEST(ReadAccuracy, TellsAWrongKeyAndAWrongScoreInOnePass) {
  const std::string refusal =
      refusal_of(kTunnelSearch +
                 "[accuracy]\nconfidenc = 0.9\nkeep = [\"render.aperture\"]\n"
                 "tolerance = { \"homogeneity.h_rmss\" = 0.1, \"defects.min_cnr\" = -1 }\n");
  EXPECT_THAT(refusal,
              AllOf(HasSubstr("accuracy.confidenc: unknown key"),
                    HasSubstr("\"homogeneity.h_rmss\""),
                    HasSubstr("defects.min_cnr: is -1"),
                    HasSubstr("render.aperture")));
}

TEST(ReadAccuracy, NeedsASearch) {
  EXPECT_THAT(refusal_of("[lighting.tunnel]\n[accuracy]\ntolerance = \"auto\"\n"),
              AllOf(HasSubstr("s.toml:2:"), HasSubstr("needs [variables] and [objective]")));
}

TEST(ReadAccuracy, RefusesDesignsThatChooseForThemselves) {
  EXPECT_THAT(refusal_of(kTunnelSearch + "[accuracy]\ntolerance = \"auto\"\n[prototypes.fine]\n"
                                         "\"render.max_direction_error_mrad\" = 0.1\n"),
              AllOf(HasSubstr("s.toml:12:"),
                    HasSubstr("prototypes: render.max_direction_error_mrad: is chosen by")));
}

TEST(CheckLadder, RefusesKeysByHandThatLeaveNothingToChoose) {
  const std::string by_hand = "[render]\nmax_direction_error_mrad = 0.2\n";
  EXPECT_THAT(refusal_of(kTunnelSearch + "[accuracy]\ntolerance = \"auto\"\n" + by_hand),
              AllOf(HasSubstr("s.toml:9:"),
                    HasSubstr("leaves one way to render"),
                    HasSubstr("set by hand: render.max_direction_error_mrad")));
  EXPECT_EQ(refusal_of(kTunnelSearch + "[accuracy]\ntolerance = \"auto\"\nkeep = []\n" + by_hand),
            "");
}

TEST(WriteAccuracy, TheResolvedTextIsTheSameStudyAndKeepsTheSameKeys) {
  const TemporaryFolder folder;
  write_file(folder / "s.toml",
             kTunnelSearch +
                 "[accuracy]\ntolerance = { \"defects.min_cnr\" = \"7 %\", \"homogeneity.mean\" = "
                 "0.3 }\n[render]\nmax_direction_error_mrad = 0.2\n");
  const Study study = load_study(folder / "s.toml", {});
  write_file(folder / "r.toml", resolved_text(study));
  const Study again = load_study(folder / "r.toml", {});
  EXPECT_EQ(resolved_text(again), resolved_text(study));
  EXPECT_EQ(kept_keys(again.root), (KeptKeys{.max_direction_error = true}));
  EXPECT_EQ(kept_keys(again.root), kept_keys(study.root));
  EXPECT_EQ(again.accuracy->wishes.at(0).tolerance, study.accuracy->wishes.at(0).tolerance);
}

TEST(WriteAccuracy, KeepsReflectionsWhereTheyAreNamed) {
  const std::string paths = "[render.paths]\nmax_reflections = 3\n";
  const std::string table = kTunnelSearch + "[accuracy]\ntolerance = \"auto\"\n";
  const TemporaryFolder folder;
  write_file(folder / "s.toml", table + "keep = [\"render.paths.max_reflections\"]\n" + paths);
  const Study study = load_study(folder / "s.toml", {});
  EXPECT_EQ(kept_keys(study.root), (KeptKeys{.reflections = true}));
  write_file(folder / "r.toml", resolved_text(study));
  EXPECT_EQ(kept_keys(load_study(folder / "r.toml", {}).root), (KeptKeys{.reflections = true}));
  write_file(folder / "given.toml", table + paths);
  EXPECT_EQ(kept_keys(load_study(folder / "given.toml", {}).root), KeptKeys{})
      << "it is a limit, and kept on request alone";
}

TEST(WishText, SaysTheUnit) {
  EXPECT_EQ(wish_text({.score = "homogeneity.h_rms", .tolerance = 0.001}),
            "0.1 points of homogeneity.h_rms (0.001)");
  EXPECT_EQ(wish_text({.score = "defects.min_cnr", .tolerance = 0.02, .is_relative = true}),
            "2 % of defects.min_cnr");
  EXPECT_EQ(wish_text({.score = "defects.min_cnr", .tolerance = 2}), "2 of defects.min_cnr");
}

TEST(AccuracySchema, KnowsBothKindsOfTolerance) {
  const auto table = study_schema()["properties"]["accuracy"];
  EXPECT_EQ(table["additionalProperties"], false);
  const auto& kinds = table["properties"]["tolerance"]["anyOf"];
  EXPECT_EQ(kinds[0]["enum"][0], "auto");
  EXPECT_EQ(kinds[1]["additionalProperties"]["anyOf"][0]["exclusiveMinimum"], 0.0);
  EXPECT_EQ(table["properties"]["confidence"]["default"], 0.99);
}

}  // namespace
}  // namespace glint

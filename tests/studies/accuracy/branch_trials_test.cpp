// SPDX-License-Identifier: GPL-3.0-or-later
//
// A rung for each branch of a choice, with evaluations that are made up.
#include "studies/accuracy/branch_trials.h"

#include <cmath>
#include <functional>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "studies/accuracy/accuracy_panel.h"
#include "studies/accuracy/accuracy_report.h"
#include "studies/accuracy/tried_designs.h"
#include "tests/studies/accuracy/branch_study.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using test::kRingBranch;
using test::kTunnelBranch;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::SizeIs;
using ::testing::StartsWith;

using ScoreOf = std::function<double(const test::BranchDesign&, const RenderRung&)>;

Study study_from(const std::string& text) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", text);
  return load_study(folder / "study.toml", {});
}

Study branched_study(const std::string& accuracy) {
  return study_from(test::branch_study(accuracy));
}

struct Chooser {
  Study study;
  std::map<std::string, int> evaluations = {};  ///< by rung

  /// @param score  not a number: the design cannot be rendered
  ChosenAccuracy choose(const ScoreOf& score, Storage* storage = nullptr) {
    ThreadPool pool(1);
    SceneStore store(pool);
    AccuracyRecord record(storage);
    return choose_accuracy({.study = study,
                            .store = store,
                            .record = storage,
                            .evaluate =
                                [&](const Overrides& overrides, const RenderRung& rung) {
                                  ++evaluations[rung.name];
                                  const double value = score(test::branch_design(overrides), rung);
                                  return std::isnan(value)
                                             ? Outcome{.is_failed = true, .message = "failed"}
                                             : Outcome{.scores = test::branch_scores(value)};
                                }},
                           record);
  }
};

constexpr double kCoarse_rad = 1e-3;  ///< footprints of 2 mrad alone are coarser

/// Off by 0.4 either way for a mirror with the coarsest footprints, by 0.01 for 8 samples. Of eight
/// designs those bounds are at least 0.4, and at most 0.01 + 3.72 * 0.0107 = 0.05.
double wrong_tunnel(const test::BranchDesign& design, const RenderRung& rung) {
  const bool is_coarse =
      design.is_ring ? rung.paths.samples == 8 : rung.render.max_direction_error_rad > kCoarse_rad;
  const double error = is_coarse ? (design.is_ring ? 0.01 : 0.4) : 0.0;
  return design.gain + error * test::branch_sign(design.gain);
}

TEST(ChooseBranches, EachBranchTakesTheCheapestRungThatServesIt) {
  Chooser chooser{branched_study("tolerance = { \"homogeneity.mean\" = 0.2 }")};
  const ChosenAccuracy chosen = chooser.choose(wrong_tunnel);
  ASSERT_TRUE(chosen.split.has_value());
  ASSERT_THAT(chosen.branches, SizeIs(2));
  const ChosenAccuracy& tunnel = chosen.branches[kTunnelBranch];
  const ChosenAccuracy& ring = chosen.branches[kRingBranch];
  EXPECT_EQ(tunnel.choice.step, 1U) << tunnel.rung().name;
  EXPECT_EQ(tunnel.rung().level, "level 0");
  EXPECT_EQ(ring.rung().name, "direct light, 8 samples");
  for (const ChosenAccuracy& part : chosen.branches) {
    EXPECT_TRUE(part.choice.is_reached) << part.label;
    EXPECT_THAT(part.designs, SizeIs(kTriedOfBranch)) << part.label;
    EXPECT_EQ(part.choice.num_alike, 0U) << part.label;
    EXPECT_LT(part.choice.steps[part.choice.step].bounds[0].bound, 0.2) << part.label;
    EXPECT_EQ(part.known.size(), kTriedOfBranch) << part.label;
  }
  EXPECT_GT(tunnel.choice.steps[0].bounds[0].bound, 0.39);
  EXPECT_EQ(chooser.evaluations["direct light, 8 samples"], 8);
  EXPECT_EQ(chooser.evaluations[ring.top().name], 8);
}

TEST(ChooseBranches, DesignsAreOfTheirBranch) {
  Chooser chooser{branched_study("tolerance = { \"homogeneity.mean\" = 0.2 }")};
  const ChosenAccuracy chosen = chooser.choose(wrong_tunnel);
  EXPECT_EQ(chosen.branches[kTunnelBranch].designs[0], "baseline");
  EXPECT_EQ(chosen.branches[kRingBranch].designs[0], "baseline, lighting_use = ring");
  for (std::size_t branch = 0; branch < 2; ++branch) {
    for (const auto& [point, outcome] : chosen.branches[branch].known) {
      EXPECT_EQ(chosen.index_of(point), branch);
      EXPECT_EQ(&chosen.of(point), &chosen.branches[branch]);
    }
  }
}

// Half of the work each, as nothing is known of the search.
TEST(ChooseBranches, CountTheirWorkByTheSharesOfTheDesigns) {
  Chooser chooser{branched_study("tolerance = { \"homogeneity.mean\" = 0.2 }")};
  ChosenAccuracy chosen = chooser.choose(wrong_tunnel);
  const double tunnel = chosen.branches[kTunnelBranch].rung().work;
  const double ring = chosen.branches[kRingBranch].rung().work;
  EXPECT_NEAR(chosen.evaluation_work(), 0.5 * (tunnel + ring), 1e-12 * ring);
  const std::vector<Trial> trials = {{.name = {}, .point = {1.0, 1.0}, .outcome = {}},
                                     {.name = {}, .point = {0.0, 1.0}, .outcome = {}},
                                     {.name = {}, .point = {1.0, 0.7}, .outcome = {}},
                                     {.name = {}, .point = {1.0, 0.8}, .outcome = {}}};
  count_designs(chosen, trials);
  EXPECT_EQ(chosen.branches[kRingBranch].share, 0.75);
  EXPECT_NEAR(chosen.evaluation_work(), 0.25 * tunnel + 0.75 * ring, 1e-12 * ring);
}

/// 8 samples are too bright by 5, and keep the order of the designs under a ring.
/// @param most  samples that are wrong
ScoreOf bright_rings(int most) {
  return [most](const test::BranchDesign& design, const RenderRung& rung) {
    const bool is_wrong = design.is_ring && rung.paths.samples <= most;
    return design.gain + (design.is_ring ? 0.003 : 0.0) + (is_wrong ? 5.0 : 0.0);
  };
}

// Within the ring's branch 8 samples rank rightly. Rungs of the mirrors, which all rank alike, are
// given back where they rose before the ring's.
TEST(ChooseBranches, AutoRanksTheDesignsOfAllBranchesTogether) {
  Chooser chooser{branched_study("tolerance = \"auto\"")};
  const ChosenAccuracy chosen = chooser.choose(bright_rings(8));
  ASSERT_THAT(chosen.branches, SizeIs(2));
  EXPECT_EQ(chosen.branches[kRingBranch].rung().name, "direct light, 16 samples");
  EXPECT_EQ(chosen.branches[kTunnelBranch].choice.step, 0U);
  ASSERT_THAT(chosen.orders, SizeIs(1));
  EXPECT_EQ(chosen.orders[0].agreement.tau, 1.0);
  EXPECT_GT(chosen.orders[0].agreement.pairs, 100U) << "of 120";
  const StepReport& coarse = chosen.branches[kRingBranch].choice.steps[0];
  EXPECT_EQ(coarse.orders[0].agreement.tau, 1.0) << "of the ring alone";
  EXPECT_FALSE(coarse.serves);
  for (const ChosenAccuracy& part : chosen.branches) {
    EXPECT_TRUE(part.choice.is_reached) << part.label;
  }
}

// Only the top, which a search may not use, is right.
TEST(ChooseBranches, AutoSaysWhereNoRungsRankRightly) {
  Chooser chooser{branched_study("tolerance = \"auto\"")};
  const ChosenAccuracy chosen = chooser.choose(bright_rings(16));
  EXPECT_EQ(chosen.branches[kRingBranch].rung().name, "direct light, 16 samples");
  EXPECT_FALSE(chosen.branches[kRingBranch].choice.is_reached);
  EXPECT_LT(chosen.orders[0].agreement.tau, 0.9);
  const auto told = accuracy_json(chooser.study, chosen, 90, {});
  EXPECT_EQ(told["reached"], false);
  ASSERT_EQ(told["unreached"].size(), 1U);
  EXPECT_THAT(told["unreached"][0].get<std::string>(), HasSubstr("of all branches together"));
}

// 16 samples, the ring's only dearer rung that a search may use, cannot render its designs.
TEST(ChooseBranches, ABranchStaysWhereNoDearerRungRendersItsDesigns) {
  Chooser chooser{branched_study("tolerance = \"auto\"")};
  const ScoreOf too_bright = bright_rings(8);
  const ChosenAccuracy chosen =
      chooser.choose([&](const test::BranchDesign& design, const RenderRung& rung) {
        return design.is_ring && rung.paths.samples == 16 ? std::nan("") : too_bright(design, rung);
      });
  const ChosenAccuracy& ring = chosen.branches[kRingBranch];
  EXPECT_EQ(ring.rung().name, "direct light, 8 samples");
  EXPECT_THAT(ring.choice.scores, SizeIs(kTriedOfBranch));
  EXPECT_EQ(ring.choice.steps[1].skipped, "cannot render every design");
  EXPECT_FALSE(ring.choice.is_reached);
  ASSERT_THAT(chosen.orders, SizeIs(1)) << "all branches are ranked";
  EXPECT_LT(chosen.orders[0].agreement.tau, 0.9);
  EXPECT_THAT(ring.choice.unreached[0], HasSubstr("of all branches together"));
}

// The file's own accuracy of directions leaves the tunnel one rung; its top is only compared with.
TEST(ChooseBranches, SaysOfWhichBranchNoRungRendersAllDesigns) {
  const TemporaryFolder folder;
  write_file(folder / "study.toml", test::branch_study("tolerance = \"auto\""));
  Chooser chooser{load_study(folder / "study.toml", {{"render.max_direction_error_mrad", "0.2"}})};
  const ChosenAccuracy chosen =
      chooser.choose([](const test::BranchDesign& design, const RenderRung& rung) {
        return !design.is_ring && rung.is_for_search ? std::nan("") : design.gain;
      });
  for (const ChosenAccuracy& part : chosen.branches) {
    EXPECT_FALSE(part.choice.is_reached) << part.label;
    ASSERT_THAT(part.choice.unreached, SizeIs(1)) << part.label;
    EXPECT_THAT(part.choice.unreached[0],
                HasSubstr("renders all designs with lighting_use = tunnel;"));
  }
}

/// 8 samples are off by 0.4 either way for matt plates under a ring alone.
double wrong_matt_ring(const test::BranchDesign& design, const RenderRung& rung) {
  const bool is_coarse = design.is_ring && design.is_diffuse && rung.paths.samples == 8;
  return design.gain + (is_coarse ? 0.4 : 0.0) * test::branch_sign(design.gain);
}

TEST(ChooseBranches, OfTwoChoicesEachCombinationTakesItsOwnRung) {
  Chooser chooser{
      study_from(test::two_choices_study("tolerance = { \"homogeneity.mean\" = 0.2 }"))};
  const ChosenAccuracy chosen = chooser.choose(wrong_matt_ring);
  ASSERT_THAT(chosen.branches, SizeIs(4));
  EXPECT_EQ(chosen.rules(), kCombinedRules);
  for (std::size_t branch = 0; branch < 4; ++branch) {
    EXPECT_THAT(chosen.branches[branch].designs, SizeIs(kTriedOfBranch)) << branch;
    EXPECT_TRUE(chosen.branches[branch].choice.is_reached) << branch;
  }
  EXPECT_EQ(chosen.branches[0].rung().level, "level 0");
  EXPECT_EQ(chosen.branches[1].rung().name, "direct light, 8 samples");
  EXPECT_EQ(chosen.branches[2].rung().name, "direct light, 8 samples");
  EXPECT_EQ(chosen.branches[3].rung().name, "direct light, 16 samples");
  const auto told = accuracy_json(chooser.study, chosen, 90, {});
  EXPECT_EQ(told["variable"], "lighting_use, material.type");
  EXPECT_EQ(told["branches"][3]["value"], "ring, diffuse");
  EXPECT_THAT(told["rung"].get<std::string>(),
              HasSubstr("; ring, mirror: direct light, 8 samples"));
  EXPECT_EQ(accuracy_panel(told)["tables"][0]["rows"][4][0],
            "lighting_use = ring, material.type = diffuse");
  const TemporaryFolder folder;
  write_file(folder / "result.json", nlohmann::ordered_json{{"accuracy", told}}.dump());
  const std::optional<SearchRungs> read = rungs_of_run(chooser.study, folder.path());
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->name(), chosen.rungs().name());
}

/// As a program that knew branches of one choice alone left it when its search had begun: under the
/// tunnel paths of the matt plates, as mirrors are rendered alike by them.
void keep_rules_3(const Study& study, Storage& storage) {
  AccuracyRecord record(&storage);
  for (TrialDesigns branch : tried_designs(study, *one_choice_split(study))) {
    std::erase_if(branch.candidates, [](const TriedDesign& tried) {
      const test::BranchDesign design = test::branch_design(tried.overrides);
      return !design.is_ring && !design.is_diffuse;
    });
    branch.candidates.resize(kTriedOfBranch);
    for (const RenderRung& rung : branch_ladder(study, branch)) {
      for (const TriedDesign& design : branch.candidates) {
        const double gain = test::branch_design(design.overrides).gain;
        record.keep(
            rung.name, design.name, *design.point, Outcome{.scores = test::branch_scores(gain)});
      }
    }
  }
  record.begin_search("tunnel: direct light, 8 samples; ring: direct light, 8 samples",
                      kBranchRules);
}

TEST(ChooseBranches, ASearchThatBeganWithBranchesOfOneChoiceGoesOnWithThem) {
  const TemporaryFolder folder;
  Storage storage = Storage::open(folder / "accuracy.sqlite",
                                  {.config_hash = "a", .config_text = "", .code_version = ""});
  Chooser chooser{
      study_from(test::two_choices_study("tolerance = { \"homogeneity.mean\" = 0.2 }"))};
  keep_rules_3(chooser.study, storage);
  const ChosenAccuracy chosen = chooser.choose(wrong_matt_ring, &storage);
  EXPECT_TRUE(chooser.evaluations.empty()) << "its trial is over";
  ASSERT_THAT(chosen.branches, SizeIs(2));
  EXPECT_EQ(chosen.rules(), kBranchRules);
  AccuracyRecord record(&storage);
  EXPECT_NO_THROW(record.check_rules(true));
  EXPECT_NO_THROW(record.begin_search(chosen.rungs().name(), chosen.rules()));
  const auto told = accuracy_json(chooser.study, chosen, 90, {});
  EXPECT_THAT(told["sentence"].get<std::string>(),
              HasSubstr("All values of material.type have one ladder in each branch"));
  write_file(folder / "result.json", nlohmann::ordered_json{{"accuracy", told}}.dump());
  EXPECT_TRUE(rungs_of_run(chooser.study, folder.path()).has_value());
}

TEST(ChooseBranches, OfOneKindOfScenesHasOneRung) {
  std::string text = test::branch_study("tolerance = \"auto\"");
  text.replace(text.find("\"ring\"] }"), 6, "\"tunnel+ring\"");
  text.replace(text.find("[\"tunnel\","), 10, "[\"ring\",");
  const TemporaryFolder folder;
  write_file(folder / "study.toml", text);
  Chooser chooser{load_study(folder / "study.toml", {})};
  const ChosenAccuracy chosen = chooser.choose(
      [](const test::BranchDesign& design, const RenderRung&) { return design.gain; });
  EXPECT_FALSE(chosen.split.has_value());
  EXPECT_THAT(chosen.designs, SizeIs(kTriedDesigns));
  EXPECT_EQ(accuracy_json(chooser.study, chosen, 90, {}).count("branches"), 0U);
}

/// As a program without branches left it when its search had begun: one ladder of paths, tried on
/// the first designs under a ring, as mirrors are rendered alike by it.
void keep_rules_2(const Study& study, Storage& storage) {
  AccuracyRecord record(&storage);
  std::vector<TriedDesign> designs = tried_designs(study);
  std::erase_if(designs, [](const TriedDesign& design) {
    return !test::branch_design(design.overrides).is_ring;
  });
  designs.resize(kTriedDesigns);
  for (const RenderRung& rung : search_ladder(study)) {
    for (const TriedDesign& design : designs) {
      const double gain = test::branch_design(design.overrides).gain;
      record.keep(
          rung.name, design.name, *design.point, Outcome{.scores = test::branch_scores(gain)});
    }
  }
  record.begin_search("direct light, 8 samples");
}

TEST(ChooseBranches, ASearchThatBeganWithOneRungGoesOnWithIt) {
  const TemporaryFolder folder;
  Storage storage = Storage::open(folder / "accuracy.sqlite",
                                  {.config_hash = "a", .config_text = "", .code_version = ""});
  Chooser chooser{branched_study("tolerance = { \"homogeneity.mean\" = 0.2 }")};
  keep_rules_2(chooser.study, storage);
  const ChosenAccuracy chosen = chooser.choose(wrong_tunnel, &storage);
  EXPECT_TRUE(chooser.evaluations.empty()) << "its trial is over";
  EXPECT_FALSE(chosen.split.has_value());
  EXPECT_EQ(chosen.rung().name, "direct light, 8 samples");
  AccuracyRecord record(&storage);
  EXPECT_NO_THROW(record.check_rules(true));
  EXPECT_NO_THROW(record.begin_search(chosen.rungs().name()));
}

TEST(BranchReport, TellsARowForEachBranch) {
  Chooser chooser{branched_study("tolerance = { \"homogeneity.mean\" = 0.2 }")};
  const ChosenAccuracy chosen = chooser.choose(wrong_tunnel);
  const nlohmann::ordered_json told = accuracy_json(chooser.study, chosen, 90, {"polarisation"});
  EXPECT_EQ(told["variable"], "lighting_use");
  ASSERT_EQ(told["branches"].size(), 2U);
  EXPECT_EQ(told["branches"][1]["value"], "ring");
  EXPECT_EQ(told["branches"][1]["rung"], "direct light, 8 samples");
  EXPECT_EQ(told["branches"][1]["scores"][0]["score"], "homogeneity.mean");
  EXPECT_EQ(told["level"], "tunnel: level 0; ring: direct light");
  EXPECT_THAT(told["sentence"].get<std::string>(),
              AllOf(HasSubstr("Designs with lighting_use = tunnel are rendered by"),
                    HasSubstr("Designs with lighting_use = ring are rendered by")));
  EXPECT_THAT(accuracy_text(told),
              HasSubstr("\n  Designs with lighting_use = ring are rendered by"));
  const nlohmann::ordered_json panel = accuracy_panel(told);
  ASSERT_EQ(panel["tables"].size(), 5U) << "facts, branches, two ladders, what is left out";
  EXPECT_EQ(panel["tables"][0]["rows"][2][0], "lighting_use = ring");
  ASSERT_EQ(panel["tables"][1]["rows"].size(), 2U);
  EXPECT_EQ(panel["tables"][1]["rows"][1][0], "ring");
  EXPECT_EQ(panel["tables"][1]["rows"][1][3], "direct light, 8 samples");
  EXPECT_THAT(panel["tables"][3]["caption"].get<std::string>(),
              StartsWith("The ladder of lighting_use = ring, tried on 8 designs"));
}

// What a later command renders designs by.
TEST(BranchReport, IsReadBackAsTheRungsOfTheRun) {
  const TemporaryFolder folder;
  Chooser chooser{branched_study("tolerance = { \"homogeneity.mean\" = 0.2 }")};
  const ChosenAccuracy chosen = chooser.choose(wrong_tunnel);
  nlohmann::ordered_json told = accuracy_json(chooser.study, chosen, 90, {});
  write_file(folder / "result.json", nlohmann::ordered_json{{"accuracy", told}}.dump());
  const std::optional<SearchRungs> read = rungs_of_run(chooser.study, folder.path());
  ASSERT_TRUE(read.has_value());
  EXPECT_EQ(read->name(), chosen.rungs().name());
  told["branches"].erase(1);
  write_file(folder / "result.json", nlohmann::ordered_json{{"accuracy", told}}.dump());
  EXPECT_THROW(rungs_of_run(chooser.study, folder.path()), IoError);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/population/sorting.h"

#include <csignal>
#include <cstdlib>
#include <set>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/config/key_writer.h"
#include "core/csv.h"
#include "core/rng.h"
#include "metrics/inspection/learn_limits.h"
#include "studies/definition/study_tables.h"
#include "studies/definition/study_text.h"
#include "studies/population/sorting_parts.h"
#include "studies/run/check_study.h"
#include "tests/studies/population/population_support.h"
#include "tests/support/page_data.h"

namespace glint {
namespace {

using population_test::bytes_of;
using population_test::kSorting;
using population_test::run_in;
using population_test::StudyText;
using ::testing::HasSubstr;
using ::testing::StartsWith;

using Json = nlohmann::ordered_json;

constexpr ExpertRule kRule = {.noticed_mm = 1e-3,
                              .perfect_hole_mm = 0.5,
                              .perfect_holes = 2,
                              .acceptable_hole_mm = 1.0,
                              .acceptable_holes = 4,
                              .perfect_scratch_mm = 2.0};

Defect hole(double diameter_mm, double depth_mm = 5e-3) {
  Defect defect;
  defect.type = DefectType::kPit;
  defect.diameter_mm = diameter_mm;
  defect.depth_mm = depth_mm;
  return defect;
}

Defect scratch(double length_mm) {
  Defect defect;
  defect.type = DefectType::kGouge;
  defect.length_mm = length_mm;
  defect.width_mm = 0.3;
  defect.depth_mm = 5e-3;
  return defect;
}

Grade grade(const std::vector<Defect>& defects) {
  return expert_grade(expert_view(defects, kRule), kRule);
}

TEST(ExpertRule, GradesByTheWidestHoleTheirNumberAndTheLongestScratch) {
  EXPECT_EQ(grade({}), Grade::kPerfect);
  EXPECT_EQ(grade({hole(0.5), hole(0.2)}), Grade::kPerfect);
  EXPECT_EQ(grade({hole(0.51)}), Grade::kAcceptable);
  EXPECT_EQ(grade({hole(0.1), hole(0.1), hole(0.1)}), Grade::kAcceptable);
  EXPECT_EQ(grade({hole(1.01)}), Grade::kRejected);
  EXPECT_EQ(grade(std::vector(4, hole(0.1))), Grade::kAcceptable);
  EXPECT_EQ(grade(std::vector(5, hole(0.1))), Grade::kRejected);
  EXPECT_EQ(grade({scratch(2.0)}), Grade::kPerfect);
  EXPECT_EQ(grade({scratch(2.01)}), Grade::kRejected);
}

TEST(ExpertRule, LeavesOutStainsAndWhatIsTooShallow) {
  Defect stain = hole(3.0);
  stain.type = DefectType::kStain;
  EXPECT_EQ(grade({stain, hole(3.0, 0.9e-3)}), Grade::kPerfect);
  EXPECT_EQ(grade({hole(3.0, 1e-3)}), Grade::kRejected);
}

// 5 % of 0.5, 1 and 2 mm: 0.475 to 0.525, 0.95 to 1.05, 1.9 to 2.1 mm.
TEST(ExpertRule, KnowsWhatIsNearABorder) {
  const auto is_near = [](const std::vector<Defect>& defects) {
    return is_near_border(expert_view(defects, kRule), kRule, 0.05);
  };
  EXPECT_FALSE(is_near({}));
  EXPECT_TRUE(is_near({hole(0.476)}));
  EXPECT_FALSE(is_near({hole(0.474)}));
  EXPECT_TRUE(is_near({hole(1.04)}));
  EXPECT_FALSE(is_near({hole(1.06)}));
  EXPECT_TRUE(is_near({scratch(1.91)}));
  EXPECT_FALSE(is_near({scratch(1.89)}));
}

TEST(ExpertRule, MoreDefectsNeverGiveABetterGrade) {
  for (std::uint64_t i = 0; i < 2000; ++i) {
    Rng rng(7, Stream::kTest, i);
    std::vector<Defect> defects;
    Grade last = Grade::kPerfect;
    for (int k = 0; k < 6; ++k) {
      defects.push_back(rng.uniform() < 0.7 ? hole(rng.uniform(0.1, 1.2))
                                            : scratch(rng.uniform(0.5, 2.5)));
      const Grade now = grade(defects);
      EXPECT_GE(now, last);
      last = now;
    }
  }
}

TEST(SortingParts, EverySoManyIsImprintedInBothHalves) {
  for (const int every : {1, 2, 3, 5, 20}) {
    SortingSettings settings;
    settings.imprinted_every = every;
    int total = 0;
    int even = 0;
    for (int number = 0; number < 40 * every; ++number) {
      total += is_imprinted(settings, number) ? 1 : 0;
      even += is_imprinted(settings, number) && number % 2 == 0 ? 1 : 0;
    }
    EXPECT_EQ(total, 40) << every;
    EXPECT_EQ(even, 20) << every;
  }
  EXPECT_FALSE(is_imprinted(SortingSettings{}, 0));
}

// Shares 1 : 3 of 4000 parts: 1000, with a deviation of sqrt(4000 * 0.25 * 0.75) = 27.
TEST(SortingParts, ComeFromTheirSourcesByShare) {
  SortingSettings settings;
  settings.sources = {{.name = "a", .share = 1.0, .groups = {"dent"}},
                      {.name = "b", .share = 3.0, .groups = {"bump", "dent"}}};
  settings.imprinted_every = 10;
  const std::vector<NamedGroup> defects = {
      {"dent", {}}, {"bump", {.type = DefectType::kBump}}, {"stain", {.type = DefectType::kStain}}};
  int of_a = 0;
  for (int number = 0; number < 4000; ++number) {
    const std::vector<NamedGroup> groups = groups_of_part(settings, defects, 3, number);
    ASSERT_TRUE(groups.size() == 1 || groups.size() == 2);
    of_a += groups.size() == 1 ? 1 : 0;
    EXPECT_EQ(groups.front().first, "dent");
    EXPECT_EQ(groups.front().second.realisation,
              is_imprinted(settings, number) ? Realisation::kImprinted : Realisation::kNormal);
  }
  EXPECT_NEAR(of_a, 1000, 4 * 27);
}

TEST(SortingParts, FiguresComeBackFromTheirRecord) {
  const Scores figures = {{"true.hole_mm", 0.7},
                          {"true.holes", 3},
                          {"true.scratch_mm", 2.5},
                          {"expert", 2},
                          {"holes.biggest", 40},
                          {"holes.sum", 90},
                          {"scratches.biggest", 33.5},
                          {"scratches.sum", 34},
                          {"defects", 4},
                          {"found", 3},
                          {"other_kind", 1},
                          {"false_alarms", 2},
                          {"imprinted", 1}};
  const SortedPart part = sorted_part(figures, 5);
  EXPECT_FALSE(part.is_for_learning());
  EXPECT_EQ(part.truth, (ExpertView{.widest_hole_mm = 0.7, .holes = 3, .longest_scratch_mm = 2.5}));
  EXPECT_EQ(part.expert, Grade::kRejected);
  EXPECT_EQ(part.holes.sum, 90.0);
  EXPECT_EQ(part.scratches.biggest, 33.5);
  EXPECT_EQ(part.found, 3);
  EXPECT_TRUE(part.is_imprinted);
}

TEST(SortingTable, ReadsAllAndWritesItBack) {
  const StudyText text(kSorting);
  const Study study = text.load();
  ASSERT_TRUE(study.sorting.has_value());
  EXPECT_EQ(study.sorting->sources.size(), 3U);
  EXPECT_TRUE(study.sorting->sources[2].groups.empty());
  EXPECT_EQ(study.sorting->expert.acceptable_hole_mm, 1.2);
  const TemporaryFolder folder;
  write_file(folder / "again.toml", resolved_text(study));
  EXPECT_EQ(resolved_text(load_study(folder / "again.toml", {})), resolved_text(study));
}

TEST(SortingTable, RefusesWithThePlaceAndWhatIsAllowed) {
  const auto refusal = [](const std::string& tables) { return StudyText(tables).refusal(); };
  EXPECT_THAT(refusal("[sorting]\npart = 20\n"), HasSubstr("sorting.part: unknown key"));
  EXPECT_THAT(
      refusal("[sorting]\nparts = 3\n"),
      ::testing::AllOf(StartsWith("s.toml:53:1: "), HasSubstr("sorting.parts: is 3, must be")));
  EXPECT_THAT(refusal("[sorting.expert]\nperfect_hole_mm = 2\nacceptable_hole_mm = 1\n"),
              HasSubstr("acceptable_hole_mm: must not be smaller than perfect_hole_mm"));
  EXPECT_THAT(refusal("[sorting.sources.a]\ngroups = [\"dint\"]\n"),
              HasSubstr("\"dint\" is no group of [defects]; there are dent, scratch"));
  EXPECT_THAT(refusal("[sorting.sources.a]\ngroups = [\"dent\", \"dent\"]\n"), HasSubstr("twice"));
  EXPECT_THAT(refusal("[sorting.sources.a]\nshare = 1\n"), HasSubstr("groups: is missing"));
  EXPECT_THAT(refusal("[sorting.sources.a]\ngroups = []\nshare = 0\n"),
              HasSubstr("sorting.sources.a.share: is 0, must be > 0"));
  EXPECT_THAT(refusal("[sorting]\nsources = 3\n"), HasSubstr("sorting.sources: must hold tables"));
}

TEST(SortingTable, DoesNotStandBesideVariables) {
  EXPECT_THAT(
      StudyText("[sorting]\n[variables]\n\"lighting.tunnel.period_mm\" = { min = 8, max = 9 "
                "}\n[objective]\nmaximise = \"homogeneity.h_rms\"\n[budget]\nevaluations "
                "= 2\n")
          .refusal(),
      HasSubstr("sorting: cannot be combined with [variables]"));
}

TEST(SortingTable, IsExplained) {
  std::set<std::string> paths;
  for (const KeyRow& row : study_keys()) {
    paths.insert(row.path);
  }
  for (const char* path : {"sorting.parts",
                           "sorting.expert.perfect_hole_mm",
                           "sorting.sources.<name>.groups",
                           "pod.group",
                           "pod.height_um"}) {
    EXPECT_TRUE(paths.contains(path)) << path;
  }
}

TEST(Sorting, GivesTheSameBytesForAnyNumberOfThreads) {
  const StudyText text(kSorting);
  const TemporaryFolder folder;
  for (const int threads : {1, 2, 7}) {
    run_in(folder / std::to_string(threads), text.load(), threads);
  }
  EXPECT_EQ(bytes_of(folder / "1"), bytes_of(folder / "2"));
  EXPECT_EQ(bytes_of(folder / "1"), bytes_of(folder / "7"));
}

TEST(Sorting, CountsEveryPartOnceAndShowsTheSections) {
  const StudyText text(kSorting);
  const TemporaryFolder folder;
  const Json result = run_in(folder / "run", text.load());
  EXPECT_EQ(result.at("status"), "done");
  const Json& designs = result.at("sorting").at("designs");
  EXPECT_EQ(designs.at("baseline").at("parts"), 12);
  EXPECT_EQ(designs.at("coarse").at("parts"), 6);
  for (const auto& [key, design] : designs.items()) {
    int sum = 0;
    int right = 0;
    for (const auto& [expert, row] : design.at("confusion").items()) {
      for (const auto& [sorted, count] : row.items()) {
        sum += count.get<int>();
        right += expert == sorted ? count.get<int>() : 0;
      }
    }
    EXPECT_EQ(sum, design.at("tested").get<int>()) << key;
    EXPECT_EQ(right, design.at("right").get<int>()) << key;
    EXPECT_EQ(sum - right, static_cast<int>(design.at("wrong_parts").size())) << key;
  }
  EXPECT_EQ(designs.at("baseline").at("false_alarms").at("scans"), 6);
  EXPECT_EQ(designs.at("baseline").at("share_right"),
            designs.at("baseline").at("share_right_with_own_limits"));
  const Json charts =
      test::page_data(read_file(folder / "run" / "report.html"))["panels"][0]["charts"];
  ASSERT_EQ(charts.size(), 3U);
  EXPECT_EQ(charts[0]["title"], "Holes and bumps on 12 parts, classes by holes alone");
  EXPECT_EQ(charts[1]["title"], "Scratches on 12 parts, classes by scratches alone");
  EXPECT_EQ(charts[2]["kind"], "lightings");
  EXPECT_EQ(charts[2]["designs"], designs);
  const Json& limits = designs.at("baseline").at("limits");
  for (const auto& [chart, kind] : {std::pair{charts[0], "holes"}, {charts[1], "scratches"}}) {
    EXPECT_EQ(chart["limits"], limits.at(kind));
    ASSERT_EQ(chart["points"].size(), 12U);
    EXPECT_EQ(chart["points"][0]["is_tested"], false);
    EXPECT_EQ(chart["points"][1]["is_tested"], true);
  }
}

/// A part with one hole that an expert has graded.
SortedPart holed_part(int number, double biggest_px, Grade expert) {
  SortedPart part{.number = number, .expert = expert};
  part.holes = {.biggest = biggest_px, .sum = biggest_px};
  return part;
}

// The odd parts would have 100 px pass for perfect.
TEST(SortingParts, LimitsAreLearnedFromEvenNumbersAlone) {
  const std::vector<SortedPart> parts = {holed_part(0, 10, Grade::kPerfect),
                                         holed_part(1, 100, Grade::kPerfect),
                                         holed_part(2, 100, Grade::kRejected),
                                         holed_part(3, 1000, Grade::kRejected)};
  const LearnedLimits limits = limits_from(parts);
  EXPECT_EQ(limits.wrong, 0);
  EXPECT_EQ(grade_of(parts[0], limits), Grade::kPerfect);
  EXPECT_EQ(grade_of(parts[2], limits), Grade::kRejected);
  EXPECT_EQ(grade_of(parts[1], limits), Grade::kRejected);
}

// Counted again from sorting.csv, whose columns are design, part, half, imprinted, expert, sorted.
TEST(Sorting, ConfusionIsThatOfTheTestedHalf) {
  const StudyText text(kSorting);
  const TemporaryFolder folder;
  // Shallow dents are missed, so some parts are sorted wrongly.
  const Json result =
      run_in(folder / "run",
             text.load({{"sorting.parts", "24"}, {"defects.dent.height_um", "[0.02, 1]"}}));
  Json counted = Json::object();
  for (const CsvRow& row : parse_csv(read_file(folder / "run" / "sorting.csv"), "sorting.csv")) {
    if (row.at(0).text == "baseline" && std::stoi(row.at(1).text) % 2 == 1) {
      EXPECT_EQ(row.at(2).text, "tested");
      Json& count = counted[row.at(4).text][row.at(5).text];
      count = count.is_null() ? 1 : count.get<int>() + 1;
    }
  }
  const Json& design = result.at("sorting").at("designs").at("baseline");
  for (const auto& [expert, row] : design.at("confusion").items()) {
    for (const auto& [sorted, count] : row.items()) {
      const bool is_there = counted.contains(expert) && counted[expert].contains(sorted);
      EXPECT_EQ(count, is_there ? counted[expert][sorted] : Json(0)) << expert << " " << sorted;
    }
  }
  EXPECT_LT(design.at("right"), design.at("tested")) << "some must be wrong";
  EXPECT_GT(design.at("found"), 0);
  EXPECT_LT(2 * design.at("other_kind").get<int>(), design.at("found").get<int>());
}

/// Runs with an interrupt after some milliseconds; true when it came in time.
bool run_interrupted(const std::filesystem::path& out, const Study& study, int delay_ms) {
  std::atomic<int> interrupts = 0;
  std::thread bell([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
    interrupts = 1;
  });
  const Json result = run_in(out, study, 2, &interrupts);
  bell.join();
  EXPECT_EQ(result.contains("sorting"), result.at("status") == "done");
  return result.at("status") == "interrupted";
}

TEST(Sorting, GoesOnAfterInterruptsAsIfThereHadBeenNone) {
  const StudyText text(kSorting);
  const TemporaryFolder folder;
  const Study study = text.load();
  run_in(folder / "whole", study);
  int interrupts = 0;
  for (int round = 0; round < 200; ++round) {
    if (!run_interrupted(folder / "pieces", study, 250 + 200 * round)) {
      break;
    }
    ++interrupts;
  }
  EXPECT_GE(interrupts, 1);
  EXPECT_EQ(bytes_of(folder / "pieces"), bytes_of(folder / "whole"));
}

constexpr const char* kChildStudy = "GLINT_TEST_CHILD_STUDY";
constexpr const char* kChildOut = "GLINT_TEST_CHILD_OUT";

/// What the process does that is killed by the test below.
TEST(SortingChild, DISABLED_Runs) {
  const char* study = std::getenv(kChildStudy);
  const char* out = std::getenv(kChildOut);
  ASSERT_TRUE(study != nullptr && out != nullptr);
  run_in(out, load_study(study, {}));
}

/// @return true when the child had ended by itself before it was killed
bool run_child_and_kill(const std::filesystem::path& study,
                        const std::filesystem::path& out,
                        int delay_ms) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::setenv(kChildStudy, study.c_str(), 1);
    ::setenv(kChildOut, out.c_str(), 1);
    ::execl("/proc/self/exe",
            "population",
            "--gtest_filter=SortingChild.*",
            "--gtest_also_run_disabled_tests",
            "--gtest_brief=1",
            nullptr);
    ::_exit(127);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

TEST(Sorting, GoesOnAfterKillsAsIfThereHadBeenNone) {
  const StudyText text(kSorting);
  const TemporaryFolder folder;
  run_in(folder / "whole", text.load());
  int kills = 0;
  for (int delay_ms = 300; delay_ms < 60000; delay_ms = delay_ms * 8 / 5) {
    if (run_child_and_kill(text.path(), folder / "pieces", delay_ms)) {
      break;
    }
    ++kills;
  }
  EXPECT_GE(kills, 1);
  EXPECT_EQ(bytes_of(folder / "pieces"), bytes_of(folder / "whole"));
}

TEST(Sorting, CheckPredictsItsDuration) {
  const Json check = check_study(StudyText(kSorting).load(), {.threads = 2});
  EXPECT_GT(check.at("predicted_s").get<double>(), 0.0);
}

// 12 parts and 6 flawless ones at the study's own lighting, at most 6 and 3 at the prototype's.
TEST(SortingCounts, HoldTheOwnLightingAndEachPrototype) {
  const StudyText text(kSorting);
  EXPECT_EQ(sorting_counts(text.load()).parts, 12 + 6);
  EXPECT_EQ(sorting_counts(text.load()).flawless, 6 + 3);
  EXPECT_EQ(sorting_counts(text.load({{"sorting.parts", "12000"}})).parts, 12000 + 6);
  EXPECT_EQ(sorting_counts(text.load({{"sorting.parts", "4"}})).parts, 4 + 4);
}

}  // namespace
}  // namespace glint

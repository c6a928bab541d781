// SPDX-License-Identifier: GPL-3.0-or-later
//
// What may change of a study whose run has begun: prototypes, wider limits and more choices.
#include <filesystem>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "studies/definition/study_text.h"
#include "studies/run/begun_study.h"
#include "studies/run/run.h"
#include "studies/run/run_texts.h"
#include "studies/tolerance/built_designs.h"
#include "tests/studies/imaging/path_support.h"
#include "tests/studies/run/rendered_plate.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using ::testing::AllOf;
using ::testing::HasSubstr;

const std::string kBegun = "schema = 1\ntitle = \"Plate\"\nlighting_use = \"ring\"\n" + kPathPlate +
                           kPathRing + kPathBar + R"(
[variables]
"lighting_use" = { choices = ["ring", "left"] }
"lighting.ring.height_mm" = { min = 20, max = 40, when = "lighting_use == ring" }
"lighting.left.length_mm" = { min = 10, max = 30, when = "lighting_use == left" }
[objective]
maximise = "defects.min_weber"
[search]
algorithm = "gp"
[budget]
evaluations = 12
)";

const std::string kLonger = replaced(kBegun, "evaluations = 12", "evaluations = 20");
const std::string kPrototype =
    "[prototypes.high]\ntitle = \"High\"\n\"lighting.ring.height_mm\" = 55\n";

Json run_in(const TemporaryFolder& folder, const std::string& text, bool verifies = false) {
  write_file(folder / "study.toml", text);
  return run_study(load_study(folder / "study.toml", {}),
                   {.out = folder / "run",
                    .threads = 2,
                    .jobs = 2,
                    .progress = Progress::Style::kNone,
                    .log_file = {},
                    .verify_replay = verifies});
}

/// A run of that text in its folder: a copy of one that is made once.
void begin_in(const TemporaryFolder& folder, const std::string& text) {
  static std::map<std::string, TemporaryFolder> made;
  const auto [at, is_new] = made.try_emplace(text);
  if (is_new) {
    run_in(at->second, text);
  }
  std::filesystem::copy(
      at->second / "run", folder / "run", std::filesystem::copy_options::recursive);
}

std::string refusal_in(const TemporaryFolder& folder, const std::string& text) {
  try {
    run_in(folder, text);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

Storage record_in(const TemporaryFolder& folder) {
  return Storage::read(folder / "run/study.sqlite");
}

/// Scores and active values by name, of the first trials.
std::vector<std::string> designs_in(const TemporaryFolder& folder, std::size_t count) {
  const Study study = load_study(folder / "run/study.resolved.toml", {});
  std::vector<std::string> designs;
  for (const Trial& trial : record_in(folder).trials(TrialKind::kSearch)) {
    std::string text;
    for (const auto& [path, value] : overrides_of(study, trial.point)) {
      text += path + "=" + (value.is_number() ? std::to_string(value.number) : value.text) + " ";
    }
    for (const auto& [name, value] : trial.outcome->scores) {
      text += name + "=" + std::to_string(value) + " ";
    }
    designs.push_back(text);
  }
  designs.resize(std::min(designs.size(), count));
  return designs;
}

std::ptrdiff_t epochs_in(const TemporaryFolder& folder) {
  const std::vector<Event> events = record_in(folder).events();
  return std::ranges::count(events, EventKind::kEpoch, &Event::kind);
}

TEST(BegunStudy, ANewPrototypeIsScoredWithoutAnEpoch) {
  const TemporaryFolder folder;
  begin_in(folder, kBegun);
  const std::vector<std::string> before = designs_in(folder, 12);
  const Json result = run_in(folder, kBegun + kPrototype);
  EXPECT_TRUE(result["prototypes"]["high"]["scores"].contains("defects.min_weber"));
  EXPECT_EQ(designs_in(folder, 20), before) << "nothing is searched again";
  EXPECT_EQ(epochs_in(folder), 0);
  EXPECT_TRUE(run_in(folder, kBegun)["prototypes"].empty()) << "it may go, too";
}

TEST(BegunStudy, WiderLimitsAndMoreChoicesBeginAnEpochWithTheSameDesigns) {
  const TemporaryFolder folder;
  begin_in(folder, kBegun);
  const std::vector<std::string> before = designs_in(folder, 12);
  // Choices before the known ones: their numbers are others.
  const std::string wider = replaced(
      replaced(replaced(kLonger, R"(["ring", "left"])", R"(["ring+left", "ring", "left"])"),
               "max = 40, when = \"lighting_use == ring\"",
               "max = 60, when = \"lighting_use in [ring, ring+left]\""),
      "min = 10, max = 30",
      "min = 8, max = 30");
  const Json result = run_in(folder, wider);
  EXPECT_EQ(result["evaluations"], 20);
  EXPECT_EQ(designs_in(folder, 12), before);
  EXPECT_EQ(epochs_in(folder), 1);
  const std::vector<Event> events = record_in(folder).events();
  const auto epoch = std::ranges::find(events, EventKind::kEpoch, &Event::kind);
  EXPECT_EQ(
      epoch->text,
      "a wider space: lighting_use: ring+left is a choice; lighting.ring.height_mm: is active "
      "with other values; lighting.ring.height_mm: max is 60, was 40; "
      "lighting.left.length_mm: min is 8, was 10");
  EXPECT_THAT(read_file(folder / "run/log.txt"), HasSubstr("it goes on in a wider space"));
  // The same command resumes, and every ask comes out again.
  const std::vector<std::string> all = designs_in(folder, 20);
  run_in(folder, replaced(wider, "evaluations = 20", "evaluations = 24"), true);
  EXPECT_EQ(designs_in(folder, 20), all);
  EXPECT_EQ(epochs_in(folder), 1);
  // The narrow study is another one now.
  EXPECT_THAT(refusal_in(folder, kBegun), HasSubstr("ring+left is no choice any more"));
}

TEST(BegunStudy, NarrowerRangesAndOtherChangesAreRefusedWithTheReason) {
  const TemporaryFolder folder;
  begin_in(folder, kBegun);
  const auto refused = [&](const std::string& before, const std::string& after) {
    return refusal_in(folder, replaced(kBegun, before, after));
  };
  EXPECT_THAT(refused("max = 40", "max = 35"),
              HasSubstr("lighting.ring.height_mm: max is 35, was 40, a narrower range"));
  EXPECT_THAT(refused("max = 40", "max = 60, log = true"),
              HasSubstr("differs in more than limits and choices"));
  EXPECT_THAT(refused("bits = 0", "bits = 8"), HasSubstr("sensor.bits is 8, was 0"));
  EXPECT_THAT(refused("height_um = 60", "height_um = 70"),
              HasSubstr("defects.dent.height_um is 70, was 60"));
  EXPECT_THAT(refused("maximise", "minimise"), HasSubstr("objective.minimise"));
  EXPECT_EQ(epochs_in(folder), 0);
  EXPECT_EQ(run_in(folder, kBegun)["evaluations"], 12) << "nothing is changed by a refusal";
}

// The way to render was chosen by designs of the space as it was. Nothing needs to be rendered to
// know that.
TEST(BegunStudy, AWiderSpaceBesideAccuracyIsRefusedWithTheReason) {
  const TemporaryFolder folder;
  const auto loaded = [&](const std::string& text) {
    write_file(folder / "study.toml", text);
    return load_study(folder / "study.toml", {});
  };
  const std::string accurate = kBegun + "[accuracy]\ntolerance = \"auto\"\n";
  const Study begun = loaded(accurate);
  write_file(folder / "study.resolved.toml", resolved_text(begun));
  Storage::open(folder / "study.sqlite",
                {.config_hash = config_hash(begun), .config_text = resolved_text(begun)});
  const auto adopted = [&](const std::string& before, const std::string& after) -> std::string {
    StudyIdentity identity;
    try {
      return adopt_begun_study(loaded(replaced(accurate, before, after)), identity, folder.path());
    } catch (const ConfigError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(adopted("evaluations = 12", "evaluations = 20"), "");
  EXPECT_THAT(adopted("max = 40", "max = 60"),
              AllOf(HasSubstr("lighting.ring.height_mm: max is 60, was 40, and [accuracy] has "
                              "chosen how to render for the space as it was; of a study"),
                    HasSubstr("only title and [budget] may change: give another folder")));
  EXPECT_THAT(adopted("max = 40", "max = 30"), HasSubstr("was 40, a narrower range; of a study"));
  EXPECT_THAT(Storage::read(folder / "study.sqlite").events(), testing::IsEmpty());
}

/// Whose steps count from another begin.
TEST(BegunStudy, AWiderRangeWhoseStepsHaveShiftedIsRefused) {
  const TemporaryFolder folder;
  const std::string stepped = replaced(kBegun, "max = 40,", "max = 40, step = 4,");
  begin_in(folder, stepped);
  EXPECT_THAT(refusal_in(folder, replaced(stepped, "min = 20", "min = 18")),
              HasSubstr("steps count from min"));
  EXPECT_EQ(run_in(folder, replaced(stepped, "min = 20", "min = 16"))["evaluations"], 12);
  EXPECT_EQ(epochs_in(folder), 1);
}

// All databases are looked at before anything is changed.
TEST(BegunStudy, ADesignBesideTheRunThatTheWiderSpaceDoesNotHoldChangesNothing) {
  const TemporaryFolder folder;
  const std::string stepped = replaced(kBegun, "max = 40,", "max = 40, step = 4,");
  begin_in(folder, stepped);
  {
    Storage added = Storage::open(folder / "run" / kAddedDesigns, record_in(folder).identity());
    added.append(std::vector<Event>{{.kind = EventKind::kAsk, .trial = 1}},
                 std::vector<Trial>{{.number = 1, .point = {0.0, 21.0, 20.0}}});
  }
  write_file(folder / "run" / kBuiltTrials, "as built");
  EXPECT_THAT(refusal_in(folder, replaced(stepped, "min = 20", "min = 16")),
              HasSubstr("does not hold trial 1"));
  EXPECT_EQ(read_file(folder / "run" / kBuiltTrials), "as built");
  EXPECT_EQ(epochs_in(folder), 0);
}

// 0.2 + 4 * 0.1 and 0.1 + 5 * 0.1 differ in the last digit.
TEST(BegunStudy, StepsFromALowerMinComeToTheSameValues) {
  const auto stepped = [](double low) {
    return SearchSpace{{{.name = "x", .low = low, .high = 1.0, .step = 0.1}}};
  };
  for (int k = 0; k <= 8; ++k) {
    const Point before = canonical(stepped(0.2), Point{0.2 + 0.1 * k});
    const auto now = point_here(stepped(0.1), stepped(0.2), before);
    ASSERT_TRUE(now.has_value()) << before[0];
    EXPECT_EQ(*now, canonical(stepped(0.1), before)) << "a value of the wider space, bit for bit";
    EXPECT_NEAR(now->front(), before[0], 1e-12);
    EXPECT_FALSE(point_here(stepped(0.15), stepped(0.2), before).has_value());
  }
}

TEST(BaselineTitle, TellsTheLightWherePrototypesHaveOthers) {
  const TemporaryFolder folder;
  const auto title_of = [&](const std::string& text) {
    write_file(folder / "study.toml", text);
    return baseline_title(load_study(folder / "study.toml", {}));
  };
  const std::string searched = kBegun + "[prototypes.bar]\nlighting_use = \"left\"\n";
  EXPECT_EQ(title_of(searched), "Baseline") << "the winner of the search stands beside it";
  const std::string compared =
      searched.substr(0, searched.find("[variables]")) +
      "[prototypes.bar]\nlighting_use = \"left\"\n[objective]\nmaximise = \"defects.min_weber\"\n";
  EXPECT_EQ(title_of(compared), "Baseline (ring)");
  EXPECT_EQ(title_of(replaced(compared,
                              "[prototypes.bar]\nlighting_use = \"left\"",
                              "[prototypes.high]\n\"lighting.ring.height_mm\" = 55")),
            "Baseline");
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/study_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "core/text.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr const char* kStudy = R"(title = "First"
[lighting.tunnel]
radius_mm = 90
[defects.dent]
x_mm = [5]
y_mm = [10]
[variables]
"lighting.tunnel.radius_mm" = { min = 60, max = 200 }
[objective]
maximise = "homogeneity.h_rms"
[budget]
evaluations = 10
)";

class StudyChanges : public ::testing::Test {
 protected:
  Study load(const std::vector<KeyValue>& sets = {}) { return load_with("", sets); }

  Study load_with(const std::string& tables, const std::vector<KeyValue>& sets = {}) {
    write_file(folder_ / "s.toml", kStudy + tables);
    return load_study(folder_ / "s.toml", sets);
  }

 private:
  TemporaryFolder folder_;
};

TEST_F(StudyChanges, TitleAndBudgetChangeNothing) {
  const Study study = load();
  const Study renamed = load({{"title", "Second"}, {"budget.evaluations", "500"}});
  EXPECT_NE(config_hash(renamed), config_hash(study)) << "the title is part of what is recorded";
  EXPECT_THAT(changed_keys(renamed, resolved_text(study)), IsEmpty());
  const Study again = with_title_of(renamed, resolved_text(study));
  EXPECT_EQ(again.title, "First");
  EXPECT_EQ(config_hash(again), config_hash(study));
}

const std::string kWide = "[prototypes.wide]\n\"lighting.tunnel.radius_mm\" = 150\n";

/// A recorded text as hashes take it.
std::string hashed_text(const Study& study) {
  Study plain = study;
  plain.budget = {};
  std::string text = resolved_text(plain);
  for (const std::string line : {"lighting_use = \"all\"\n", "expose_to = 0.0\n"}) {
    text.erase(text.find(line), line.size());
  }
  return text;
}

TEST_F(StudyChanges, PrototypesChangeNothingThatIsRecorded) {
  const Study study = load();
  const Study more = load_with(kWide);
  ASSERT_EQ(more.prototypes.size(), 1U);
  EXPECT_EQ(config_hash(more), config_hash(study));
  EXPECT_EQ(config_hash(study), sha256_hex(hashed_text(study))) << "as ever";
  EXPECT_THAT(changed_keys(more, resolved_text(study)), IsEmpty());
  EXPECT_THAT(changed_keys(study, resolved_text(more)), IsEmpty());
  // By earlier programs prototypes counted.
  const std::string former = sha256_hex(hashed_text(more));
  EXPECT_NE(former, config_hash(more));
  EXPECT_TRUE(is_recorded_as(more, former, resolved_text(more)));
  EXPECT_TRUE(is_recorded_as(study, former, resolved_text(more))) << "without it now";
  const Study other = load_with(kWide, {{"sensor.gain", "1.7"}});
  EXPECT_FALSE(is_recorded_as(other, former, resolved_text(more)));
}

TEST_F(StudyChanges, PrototypesCountWhereSomethingKeptDependsOnThem) {
  const std::string accuracy = "[accuracy]\ntolerance = \"auto\"\n";
  const Study study = load_with(accuracy);
  const Study more = load_with(accuracy + kWide);
  EXPECT_NE(config_hash(more), config_hash(study));
  EXPECT_FALSE(is_recorded_as(more, config_hash(study), resolved_text(study)));
  EXPECT_THAT(
      changed_keys(more, resolved_text(study)),
      ElementsAre(ChangedKey{
          .path = "prototypes.wide.lighting.tunnel.radius_mm", .is = "150", .was = std::nullopt}));
}

TEST_F(StudyChanges, AreToldWithBothValues) {
  const std::string recorded = resolved_text(load());
  const Study changed = load({{"lighting.tunnel.radius_mm", "95"},
                              {"defects.dent.x_mm", "[7]"},
                              {"variables.\"lighting.tunnel.radius_mm\".max", "150"}});
  const std::vector<ChangedKey> changes = changed_keys(changed, recorded);
  ASSERT_EQ(changes.size(), 3U);
  EXPECT_EQ(changes[0], (ChangedKey{.path = "lighting.tunnel.radius_mm", .is = "95", .was = "90"}));
  EXPECT_THAT(change_texts(changes),
              ElementsAre("lighting.tunnel.radius_mm is 95, was 90",
                          "defects.dent.x_mm is [7], was [5]",
                          "variables.lighting.tunnel.radius_mm.max is 150, was 200"));
  const Study other = load({{"title", "Second"}, {"sensor.gain", "1.7"}});
  EXPECT_NE(config_hash(with_title_of(other, recorded)), config_hash(load()));
}

TEST_F(StudyChanges, KeysThatCameAndWentAreToldToo) {
  const std::string recorded = resolved_text(load());
  const std::string more = recorded + "\n[pod]\nlevels = 5\n";
  const std::vector<ChangedKey> gone = changed_keys(load(), more);
  EXPECT_THAT(gone, ElementsAre(ChangedKey{.path = "pod.levels", .is = std::nullopt, .was = "5"}));
  EXPECT_THAT(change_texts(gone), ElementsAre("pod.levels was 5, is gone"));
  const auto at = recorded.find("[imprint]");
  ASSERT_NE(at, std::string::npos);
  const std::string less = recorded.substr(0, recorded.find("seed = 1\n", at)) +
                           recorded.substr(recorded.find("seed = 1\n", at) + 9);
  const std::vector<ChangedKey> came = changed_keys(load(), less);
  EXPECT_THAT(came,
              ElementsAre(ChangedKey{.path = "imprint.seed", .is = "1", .was = std::nullopt}));
  EXPECT_THAT(change_texts(came), ElementsAre("imprint.seed is 1, was not there"));
}

}  // namespace
}  // namespace glint

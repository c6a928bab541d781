// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/inspection/grading.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/error.h"
#include "core/rng.h"
#include "metrics/inspection/learn_limits.h"

namespace glint {
namespace {

FoundDefect defect_of(DefectKind kind, int area_px, double weight) {
  FoundDefect defect;
  defect.kind = kind;
  defect.area_px = area_px;
  defect.weight = weight;
  return defect;
}

LabelledPart part_of(std::array<double, 4> measures, Grade grade) {
  return {.holes = {.biggest = measures[0], .sum = measures[1]},
          .scratches = {.biggest = measures[2], .sum = measures[3]},
          .grade = grade};
}

Grade graded(const LabelledPart& part, const LearnedLimits& limits) {
  return std::max(grade_by(part.holes, limits.holes), grade_by(part.scratches, limits.scratches));
}

int count_misgraded(const std::vector<LabelledPart>& parts, const LearnedLimits& limits) {
  return static_cast<int>(std::ranges::count_if(
      parts, [&](const LabelledPart& part) { return graded(part, limits) != part.grade; }));
}

void expect_ordered(const GradeLimits& limits) {
  EXPECT_GE(limits.perfect_biggest, 0.0);
  EXPECT_GE(limits.perfect_sum, 0.0);
  EXPECT_LE(limits.perfect_biggest, limits.acceptable_biggest);
  EXPECT_LE(limits.perfect_sum, limits.acceptable_sum);
}

TEST(SizesOf, TakesTheBiggestAndTheSumOfOneKind) {
  const std::vector<FoundDefect> defects = {defect_of(DefectKind::kHole, 5, 1.5),
                                            defect_of(DefectKind::kScratch, 50, 9.0),
                                            defect_of(DefectKind::kHole, 7, 0.5)};
  const auto by_area = sizes_of(defects, DefectKind::kHole, InspectionSettings::Measure::kArea);
  EXPECT_EQ(by_area.biggest, 7.0);
  EXPECT_EQ(by_area.sum, 12.0);
  const auto by_weight = sizes_of(defects, DefectKind::kHole, InspectionSettings::Measure::kWeight);
  EXPECT_EQ(by_weight.biggest, 1.5);
  EXPECT_EQ(by_weight.sum, 2.0);
  const auto none = sizes_of({}, DefectKind::kScratch, InspectionSettings::Measure::kArea);
  EXPECT_EQ(none.biggest, 0.0);
  EXPECT_EQ(none.sum, 0.0);
}

TEST(GradeBy, AsksBothFigures) {
  const GradeLimits limits{.perfect_biggest = 2.0,
                           .perfect_sum = 4.0,
                           .acceptable_biggest = 6.0,
                           .acceptable_sum = 10.0};
  EXPECT_EQ(grade_by({.biggest = 2.0, .sum = 4.0}, limits), Grade::kPerfect);
  EXPECT_EQ(grade_by({.biggest = 2.0, .sum = 4.5}, limits), Grade::kAcceptable);
  EXPECT_EQ(grade_by({.biggest = 2.5, .sum = 3.0}, limits), Grade::kAcceptable);
  EXPECT_EQ(grade_by({.biggest = 6.0, .sum = 10.0}, limits), Grade::kAcceptable);
  EXPECT_EQ(grade_by({.biggest = 6.5, .sum = 6.5}, limits), Grade::kRejected);
  EXPECT_EQ(grade_by({.biggest = 3.0, .sum = 11.0}, limits), Grade::kRejected);
}

TEST(GradeOf, IsTheWorseOfHolesAndScratches) {
  InspectionSettings settings;
  settings.holes = {.perfect_biggest = 10.0,
                    .perfect_sum = 10.0,
                    .acceptable_biggest = 20.0,
                    .acceptable_sum = 20.0};
  const std::vector<FoundDefect> hole = {defect_of(DefectKind::kHole, 12, 1.0)};
  EXPECT_EQ(grade_of({}, settings), Grade::kPerfect);
  EXPECT_EQ(grade_of(hole, settings), Grade::kAcceptable);
  const std::vector<FoundDefect> both = {hole[0], defect_of(DefectKind::kScratch, 1, 1.0)};
  EXPECT_EQ(grade_of(both, settings), Grade::kRejected);
}

// Perfect up to 4, acceptable 9 to 12, rejected from 30: limits 6.5 and 21.
TEST(LearnLimits, TakesTheMiddleOfTheGaps) {
  std::vector<LabelledPart> parts;
  for (const double size : {0.0, 2.0, 4.0}) {
    parts.push_back(part_of({size, size, 0.0, 0.0}, Grade::kPerfect));
  }
  for (const double size : {9.0, 12.0}) {
    parts.push_back(part_of({size, size, 0.0, 0.0}, Grade::kAcceptable));
  }
  parts.push_back(part_of({30.0, 30.0, 0.0, 0.0}, Grade::kRejected));
  const LearnedLimits limits = learn_limits(parts);
  EXPECT_EQ(limits.wrong, 0);
  EXPECT_TRUE(limits.is_proven);
  EXPECT_EQ(limits.holes.perfect_biggest, 6.5);
  EXPECT_EQ(limits.holes.acceptable_biggest, 21.0);
}

// A perfect part of 4 among worse ones from 3 on: a limit behind 2 has the part of 4 wrong, one
// behind 4 that of 3. The gap from 4 to 9 is wider than that from 2 to 3.
TEST(LearnLimits, TakesTheWidestGapAmongEquals) {
  const std::vector<LabelledPart> parts = {part_of({1.0, 1.0, 0.0, 0.0}, Grade::kPerfect),
                                           part_of({2.0, 2.0, 0.0, 0.0}, Grade::kPerfect),
                                           part_of({3.0, 3.0, 0.0, 0.0}, Grade::kRejected),
                                           part_of({4.0, 4.0, 0.0, 0.0}, Grade::kPerfect),
                                           part_of({9.0, 9.0, 0.0, 0.0}, Grade::kRejected)};
  const LearnedLimits limits = learn_limits(parts);
  EXPECT_EQ(limits.wrong, 1);
  EXPECT_EQ(limits.holes.perfect_biggest, 6.5);
}

// The other way round: behind 9 and behind 1 one part is wrong each, and the gap from 9 to 9.5 is
// narrower than that from 1 to 8. One figure is enough to keep 8 and 9.5 outside.
TEST(LearnLimits, TakesTheWidestGapAmongEqualsThatAreLowerToo) {
  const std::vector<LabelledPart> parts = {part_of({1.0, 1.0, 0.0, 0.0}, Grade::kPerfect),
                                           part_of({8.0, 8.0, 0.0, 0.0}, Grade::kRejected),
                                           part_of({9.0, 9.0, 0.0, 0.0}, Grade::kPerfect),
                                           part_of({9.5, 9.5, 0.0, 0.0}, Grade::kRejected)};
  const LearnedLimits limits = learn_limits(parts);
  EXPECT_EQ(limits.wrong, 1);
  EXPECT_EQ(std::min(limits.holes.perfect_biggest, limits.holes.perfect_sum), 4.5);
}

// The scratches of the first seed's figure 25 know no Acceptable: both limits come out alike.
TEST(LearnLimits, GivesTwoClassesOneLimit) {
  const std::vector<LabelledPart> parts = {part_of({0.0, 0.0, 5.0, 8.0}, Grade::kPerfect),
                                           part_of({0.0, 0.0, 0.0, 0.0}, Grade::kPerfect),
                                           part_of({0.0, 0.0, 15.0, 40.0}, Grade::kRejected)};
  const LearnedLimits limits = learn_limits(parts);
  EXPECT_EQ(limits.wrong, 0);
  EXPECT_EQ(limits.scratches.perfect_biggest, limits.scratches.acceptable_biggest);
  EXPECT_EQ(limits.scratches.perfect_sum, 24.0);
}

TEST(LearnLimits, KeepsTheOnlyClassItHasSeen) {
  for (const Grade grade : {Grade::kPerfect, Grade::kAcceptable}) {
    const std::vector<LabelledPart> parts = {part_of({3.0, 5.0, 1.0, 1.0}, grade),
                                             part_of({1.0, 9.0, 2.0, 2.0}, grade)};
    EXPECT_EQ(learn_limits(parts).wrong, 0);
  }
}

// A part without any defect is always perfect, whatever its label: limits are not below 0.
TEST(LearnLimits, CannotRejectAPartWithoutDefects) {
  const std::vector<LabelledPart> parts = {part_of({0.0, 0.0, 0.0, 0.0}, Grade::kRejected)};
  const LearnedLimits limits = learn_limits(parts);
  EXPECT_EQ(limits.wrong, 1);
  EXPECT_EQ(limits.holes.acceptable_biggest, 0.0);
}

TEST(LearnLimits, RefusesPartsItCannotUse) {
  EXPECT_THROW(learn_limits({}), ConfigError);
  const std::vector<LabelledPart> negative = {part_of({-1.0, 0.0, 0.0, 0.0}, Grade::kPerfect)};
  EXPECT_THROW(learn_limits(negative), ConfigError);
  const std::vector<LabelledPart> no_number = {
      part_of({0.0, std::numeric_limits<double>::quiet_NaN(), 0.0, 0.0}, Grade::kPerfect)};
  EXPECT_THROW(learn_limits(no_number), ConfigError);
}

LearnedLimits random_rule(Rng& rng) {
  LearnedLimits rule;
  for (GradeLimits* limits : {&rule.holes, &rule.scratches}) {
    limits->perfect_biggest = rng.uniform(2.0, 10.0);
    limits->perfect_sum = limits->perfect_biggest * rng.uniform(1.0, 3.0);
    limits->acceptable_biggest = limits->perfect_biggest * rng.uniform(1.0, 3.0);
    limits->acceptable_sum = limits->perfect_sum * rng.uniform(1.5, 3.0);
  }
  return rule;
}

/// Half the parts without defects of a kind, the others with one to five.
DefectSizes random_sizes(Rng& rng) {
  DefectSizes sizes;
  const int count = static_cast<int>(rng.uniform(-5.0, 6.0));
  for (int i = 0; i < count; ++i) {
    const double size = rng.uniform(0.0, 18.0);
    sizes.biggest = std::max(sizes.biggest, size);
    sizes.sum += size;
  }
  return sizes;
}

std::vector<LabelledPart> random_parts(Rng& rng, const LearnedLimits& rule, int count) {
  std::vector<LabelledPart> parts;
  for (int i = 0; i < count; ++i) {
    LabelledPart part{.holes = random_sizes(rng), .scratches = random_sizes(rng)};
    part.grade = graded(part, rule);
    parts.push_back(part);
  }
  return parts;
}

// Limits of a rule of this form leave no part wrong; on parts not learned from, most of the rest of
// the errors are parts close to a limit.
TEST(LearnLimits, RecoversTheRuleOfSeparableParts) {
  int wrong_of_new = 0;
  constexpr int kTimes = 1000;
  for (std::uint64_t i = 0; i < kTimes; ++i) {
    Rng rng(1, Stream::kTest, i);
    const LearnedLimits rule = random_rule(rng);
    const auto parts = random_parts(rng, rule, 100);
    const LearnedLimits learned = learn_limits(parts);
    ASSERT_EQ(learned.wrong, 0) << i;
    ASSERT_TRUE(learned.is_proven) << i;
    expect_ordered(learned.holes);
    expect_ordered(learned.scratches);
    wrong_of_new += count_misgraded(random_parts(rng, rule, 20), learned);
  }
  RecordProperty("share_wrong_of_new", std::to_string(wrong_of_new / (20.0 * kTimes)));
  EXPECT_LT(wrong_of_new, 0.05 * 20 * kTimes);
}

/// The fewest wrong of all pairs of boxes, by trying all.
int fewest_wrong(const std::vector<LabelledPart>& parts, int values) {
  std::vector<std::array<double, 4>> boxes;
  const int count = values * values * values * values;
  for (int code = 0; code < count; ++code) {
    const int highest = code / (values * values * values);
    boxes.push_back({static_cast<double>(code % values),
                     static_cast<double>(code / values % values),
                     static_cast<double>(code / (values * values) % values),
                     static_cast<double>(highest)});
  }
  int fewest = static_cast<int>(parts.size());
  for (const auto& inner : boxes) {
    for (const auto& outer : boxes) {
      if (inner[0] > outer[0] || inner[1] > outer[1] || inner[2] > outer[2] ||
          inner[3] > outer[3]) {
        continue;
      }
      LearnedLimits limits;
      limits.holes = {inner[0], inner[1], outer[0], outer[1]};
      limits.scratches = {inner[2], inner[3], outer[2], outer[3]};
      fewest = std::min(fewest, count_misgraded(parts, limits));
    }
  }
  return fewest;
}

TEST(LearnLimits, HasAsFewWrongAsTryingEverything) {
  constexpr int kValues = 3;
  int hard = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(2, Stream::kTest, i);
    const auto measure = [&] { return std::floor(rng.uniform(0.0, kValues)); };
    std::vector<LabelledPart> parts;
    const int count = 2 + static_cast<int>(rng.uniform(0.0, 9.0));
    for (int k = 0; k < count; ++k) {
      const auto grade = static_cast<Grade>(static_cast<int>(rng.uniform(0.0, 3.0)));
      parts.push_back(part_of({measure(), measure(), measure(), measure()}, grade));
    }
    const LearnedLimits learned = learn_limits(parts);
    const int fewest = fewest_wrong(parts, kValues);
    ASSERT_EQ(learned.wrong, fewest) << i;
    ASSERT_EQ(learned.wrong, count_misgraded(parts, learned)) << i;
    expect_ordered(learned.holes);
    expect_ordered(learned.scratches);
    hard += fewest > 0 ? 1 : 0;
  }
  EXPECT_GT(hard, 500);  // most of these sets cannot be separated
}

// Random labels are the worst case of the search: it must end, with an answer no worse than calling
// everything by its commonest grade.
TEST(LearnLimits, EndsOnRandomLabels) {
  std::vector<LabelledPart> parts;
  Rng rng(3, Stream::kTest, 0);
  for (int i = 0; i < 200; ++i) {
    LabelledPart part{.holes = random_sizes(rng), .scratches = random_sizes(rng)};
    part.grade = static_cast<Grade>(static_cast<int>(rng.uniform(0.0, 3.0)));
    parts.push_back(part);
  }
  const LearnedLimits learned = learn_limits(parts);
  EXPECT_EQ(learned.wrong, count_misgraded(parts, learned));
  EXPECT_LT(learned.wrong, 134);
}

}  // namespace
}  // namespace glint

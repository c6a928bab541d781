// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/inspection/match_detections.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace glint {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

/// Defects on a line, hit within 2 radii.
struct Disc {
  double x_px = 0.0;
  double radius_px = 1.0;
};

DetectionMatches match(const std::vector<double>& blobs_px,
                       const std::vector<Disc>& discs,
                       double echo_px = 0.0) {
  std::vector<FoundDefect> found;
  for (const double x_px : blobs_px) {
    found.emplace_back().x_px = x_px;
  }
  const auto distance = [&](const FoundDefect& blob, std::size_t i, double slack_px) {
    const double away_px = std::abs(blob.x_px - discs[i].x_px);
    return away_px <= 2.0 * discs[i].radius_px + slack_px
               ? std::optional(away_px / discs[i].radius_px)
               : std::nullopt;
  };
  return match_detections(found, discs.size(), echo_px, distance);
}

// 2 radii of 4 px and 1.5 px of slack: up to 9.5 px.
TEST(MatchDetections, FindsWithinReachAndSlack) {
  const DetectionMatches near = match({59.5}, {{50, 4}});
  EXPECT_THAT(near.blob_of_defect, ElementsAre(0));
  EXPECT_TRUE(near.is_found(0));
  EXPECT_EQ(near.false_alarms(), 0);
  const DetectionMatches far = match({59.6}, {{50, 4}});
  EXPECT_THAT(far.blob_of_defect, ElementsAre(-1));
  EXPECT_THAT(far.defect_of_blob, ElementsAre(-1));
  EXPECT_EQ(far.found(), 0);
  EXPECT_EQ(far.false_alarms(), 1);
}

// Blob 0: 7 px or 7/6 radii from the first, 5 px or 5/2 radii from the second. Blob 1: 1/3 radius
// from the first, which it stands for.
TEST(MatchDetections, GivesABlobToTheDefectThatIsNearestInRadii) {
  const DetectionMatches matches = match({27, 22, 31}, {{20, 6}, {32, 2}, {90, 2}});
  EXPECT_THAT(matches.defect_of_blob, ElementsAre(0, 0, 1));
  EXPECT_THAT(matches.blob_of_defect, ElementsAre(1, 2, -1));
  EXPECT_EQ(matches.found(), 2);
  EXPECT_EQ(matches.false_alarms(), 0);
}

// 9.5 px as above, and 3 px more.
TEST(MatchDetections, ASideLobeFindsNothingAndIsNoFalseAlarm) {
  const DetectionMatches matches = match({62.5, 62.6}, {{50, 4}}, 3.0);
  EXPECT_THAT(matches.defect_of_blob, ElementsAre(0, -1));
  EXPECT_EQ(matches.found(), 0);
  EXPECT_EQ(matches.false_alarms(), 1);
}

// 2.5 radii from the first, but out of its reach (9.5 px); 3 radii from the second, within 3.5 px.
TEST(MatchDetections, ABlobThatFindsOneDefectIsNoEchoOfANearerOne) {
  const DetectionMatches matches = match({30}, {{20, 4}, {33, 1}}, 12.0);
  EXPECT_THAT(matches.defect_of_blob, ElementsAre(1));
  EXPECT_THAT(matches.blob_of_defect, ElementsAre(-1, 0));
}

TEST(MatchDetections, TheFirstOfTwoAtEqualDistanceGetsTheBlob) {
  EXPECT_THAT(match({25}, {{20, 5}, {30, 5}}).defect_of_blob, ElementsAre(0));
  EXPECT_THAT(match({19, 21}, {{20, 5}}).blob_of_defect, ElementsAre(0));
}

TEST(MatchDetections, NothingFoundOrNothingThere) {
  EXPECT_THAT(match({}, {{20, 5}}).blob_of_defect, ElementsAre(-1));
  EXPECT_THAT(match({}, {}).defect_of_blob, IsEmpty());
  EXPECT_EQ(match({1, 2, 3}, {}).false_alarms(), 3);
}

}  // namespace
}  // namespace glint

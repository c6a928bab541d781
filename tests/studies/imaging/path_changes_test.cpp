// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/path_changes.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

namespace glint {
namespace {

/// Two pixels beside each other under one group of lights, four samples each.
PathBatch two_pixels(float left, float right) {
  PathBatch batch;
  batch.samples = Image<std::int32_t>(2, 1);
  batch.samples.values() = {4, 4};
  ImageF channel(2, 1);
  channel.values() = {left, right};
  batch.groups.push_back({.channels = {channel}});
  return batch;
}

// The right pixel gains 4 and 8 over four samples: 1 and 2 in the mean.
RenderedChanges some_changes() {
  const Halves without = {two_pixels(10.0F, 20.0F), two_pixels(10.0F, 20.0F)};
  const Halves with = {two_pixels(10.0F, 24.0F), two_pixels(10.0F, 28.0F)};
  return changes_between(without, with);
}

TEST(ChangesBetween, AreOfTheMeanInPixelsThatDiffer) {
  const RenderedChanges changes = some_changes();
  EXPECT_EQ(changes.pixels, std::vector<std::size_t>{1});
  EXPECT_EQ(changes.values[0], std::vector<float>{1.0F});
  EXPECT_EQ(changes.values[1], std::vector<float>{2.0F});
}

// A frame that shows half of the group: 0.5 and 1. Both halves agree on 0.5 * 1 / 0.75^2 = 8/9 of
// the square; of one pixel a half may be scatter, so (8/9 - 1/2) / (1/2) = 7/9 are left.
TEST(FrameChanges, AreWeighedAndKnowWhatIsNoNoise) {
  const FrameChanges changes = frame_changes(some_changes(), {{0.5F}}, 2, 1);
  ASSERT_EQ(changes.values.size(), 1U);
  EXPECT_EQ(changes.values[0][0], 0.5F);
  EXPECT_EQ(changes.values[0][1], 1.0F);
  EXPECT_NEAR(changes.gains.at(0), std::sqrt(7.0 / 9.0), 1e-6);
}

TEST(FrameChanges, AreAddedToTheRadianceWhichStaysPositive) {
  const FrameChanges changes = {
      .pixels = {0, 1}, .values = {{1.0F, 3.0F}, {-8.0F, -8.0F}}, .gains = {0.5F, 1.0F}};
  ImageF radiance(2, 1);
  radiance.values() = {10.0F, 5.0F};
  add_changes(changes, 0, radiance);
  EXPECT_EQ(radiance(0, 0), 11.0F);  // 10 + 0.5 * (1 + 3) / 2
  EXPECT_EQ(radiance(1, 0), 0.0F);
}

// Two frames of one pixel that changes: (1 + 3) / 2 in the first half, (2 + 6) / 2 in the second.
TEST(MeanChanges, AreOverAllFrames) {
  const FrameChanges changes = {
      .pixels = {1}, .values = {{1.0F, 2.0F}, {3.0F, 6.0F}}, .gains = {1.0F}};
  const std::vector<ImageF> means = mean_changes(changes, 2, 1);
  ASSERT_EQ(means.size(), 2U);
  EXPECT_EQ(means[0](1, 0), 2.0F);
  EXPECT_EQ(means[1](1, 0), 4.0F);
  EXPECT_EQ(means[0](0, 0), 0.0F);
  EXPECT_TRUE(mean_changes({}, 2, 1).empty());
}

}  // namespace
}  // namespace glint

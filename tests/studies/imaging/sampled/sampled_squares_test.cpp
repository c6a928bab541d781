// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/sampled/sampled_squares.h"

#include <set>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/imaging/scene_picture.h"
#include "tests/studies/imaging/path_support.h"

namespace glint {
namespace {

using ::testing::SizeIs;

/// A plate that fills the picture; its sensor has noise and a blur.
SceneSettings square_plate(int samples) {
  SceneSettings scene = test::scene_from(kPathView + kPathRing + R"(
[sensor]
bits = 0
full_well_e = 10000
read_noise_e = 5
)");
  scene.camera.width_px = 96;
  scene.camera.height_px = 72;
  scene.camera.object_pixel_mm = 0.08;
  scene.paths.samples = samples;
  scene.paths.batches = 4;
  scene.paths.max_reflections = 1;
  return scene;
}

/// Values of a pixel in two pictures, in the region of interest.
using ValuePairs = std::set<std::pair<double, double>>;

ValuePairs pairs_of_whole(SceneStore& store,
                          const SceneSettings& cheap,
                          const SceneSettings& dearer) {
  const auto coarse = picture_of(store, cheap, {.has_flawless = false});
  const auto fine = picture_of(store, dearer, {.has_flawless = false});
  const ImageF coarse_aspect = coarse->mean({}).aspect;
  const ImageF fine_aspect = fine->mean({}).aspect;
  const Mask& region = coarse->traced()->region.mask;
  ValuePairs pairs;
  for (std::size_t i = 0; i < region.size(); ++i) {
    if (region.values()[i] != 0) {
      pairs.emplace(static_cast<double>(coarse_aspect.values()[i]),
                    static_cast<double>(fine_aspect.values()[i]));
    }
  }
  return pairs;
}

ValuePairs pairs_of_squares(const std::vector<SampledSquare>& squares) {
  ValuePairs pairs;
  for (const SampledSquare& square : squares) {
    for (const GreyPair& pair : square) {
      pairs.emplace(pair.cheap, pair.dearer);
    }
  }
  return pairs;
}

TEST(SampledSquares, HaveTheValuesOfTheWholePictures) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings cheap = square_plate(8);
  const SceneSettings dearer = square_plate(16);
  const auto squares = sampled_squares(store, cheap, dearer, Rng(1, Stream::kTest, 0));
  ASSERT_TRUE(squares);
  EXPECT_THAT(*squares, SizeIs(kSampledSquares));
  const ValuePairs whole = pairs_of_whole(store, cheap, dearer);
  EXPECT_GT(whole.size(), 500U) << "else they would tell no pixels apart";
  std::size_t missing = 0;
  for (const SampledSquare& square : *squares) {
    EXPECT_GE(square.size(), 1U);
    EXPECT_LE(square.size(), 64U);
    for (const GreyPair& pair : square) {
      missing += whole.contains({pair.cheap, pair.dearer}) ? 0U : 1U;
    }
  }
  EXPECT_EQ(missing, 0U);
}

TEST(SampledSquares, FollowFromTheRandomNumbersAlone) {
  ThreadPool one(1);
  ThreadPool three(3);
  SceneStore store(one);
  SceneStore other(three);
  const SceneSettings scene = square_plate(4);
  const auto draw = [&](SceneStore& from, std::uint64_t index) {
    return pairs_of_squares(
        sampled_squares(from, scene, scene, Rng(1, Stream::kTest, index)).value());
  };
  EXPECT_EQ(draw(store, 7), draw(other, 7));
  EXPECT_NE(draw(store, 7), draw(store, 8));
}

TEST(SampledSquares, AreNoneWhereAPixelNeedsTheWholePicture) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings scene = square_plate(4);
  const auto is_drawn = [&](const SceneSettings& cheap) {
    return sampled_squares(store, cheap, scene, Rng(1, Stream::kTest, 0)).has_value();
  };
  EXPECT_TRUE(is_drawn(scene));
  SceneSettings exposed = scene;
  exposed.expose_to = 0.9;
  EXPECT_FALSE(is_drawn(exposed)) << "its exposure follows from all pixels";
  SceneSettings adaptive = scene;
  adaptive.paths.relative_error = 0.1;
  EXPECT_FALSE(is_drawn(adaptive)) << "and so do its samples";
  SceneSettings smaller = scene;
  smaller.camera.width_px = 32;
  EXPECT_FALSE(is_drawn(smaller)) << "it is another picture";
  EXPECT_FALSE(sampled_squares(store, smaller, smaller, Rng(1, Stream::kTest, 0)))
      << "which has few squares";
}

// A blur of 0.7 px reaches less than 4 pixels: 16 x 16 pixels are rendered for a square.
TEST(SampledSquares, TakeTheirShareOfThePicture) {
  SceneSettings scene = square_plate(4);
  const double pixels = 96.0 * 72.0;
  EXPECT_DOUBLE_EQ(share_of_squares(scene), 32.0 * 256.0 / pixels);
  scene.sensor.blur_px = 0.0;
  EXPECT_DOUBLE_EQ(share_of_squares(scene), 32.0 * 64.0 / pixels);
  scene.sensor.blur_px = 2.0;  // 5 to 12 pixels
  EXPECT_DOUBLE_EQ(share_of_squares(scene), 32.0 * 1024.0 / pixels);
}

}  // namespace
}  // namespace glint

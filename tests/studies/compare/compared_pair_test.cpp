// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/compared_pair.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "core/thread_pool.h"
#include "studies/compare/causes.h"
#include "studies/compare/compare_page.h"
#include "studies/compare/compare_result.h"
#include "studies/compare/grab_cut.h"
#include "studies/compare/inspected_pair.h"
#include "tests/studies/compare/compare_fixture.h"
#include "tests/studies/compare/known_defects.h"

namespace glint {
namespace {

class ComparePairTest : public CompareFiles {
 protected:
  ComparedPair compare(const ImageF& simulated,
                       const ImageF& real,
                       const PairOptions& options = {}) {
    return compare_pair({.simulated = {.name = "s", .picture = write("s.png", simulated)},
                         .real = {.name = "r", .picture = write("r.png", real)}},
                        options);
  }
};

TEST_F(ComparePairTest, OfAPictureAndItselfWithOtherNoiseAgrees) {
  const ComparedPair pair = compare(drawn_blade(), drawn_blade({.index = 1}));
  EXPECT_EQ(pair.geometry.outlines.real.method, OutlineMethod::kThreshold);
  EXPECT_GE(pair.geometry.iou.value(), 0.998);
  EXPECT_LE(pair.geometry.distance.mean_px, 0.03);
  EXPECT_GT(pair.geometry.distance.share, 0.85);
  EXPECT_GT(pair.appearance.ssim, 0.97);
  EXPECT_LT(pair.appearance.histogram_distance, 0.002);
  EXPECT_FALSE(pair.better_turn.has_value());
  EXPECT_TRUE(pair.notes.empty());
}

// 1 % larger: at the radius r the edge lies 0.01 r outside, whatever was done to find it.
TEST_F(ComparePairTest, MeasuresAScale) {
  const ComparedPair pair = compare(drawn_blade(), drawn_blade({.scale = 1.01, .index = 1}));
  ASSERT_TRUE(pair.geometry.rings.radial_slope.has_value());
  EXPECT_NEAR(pair.geometry.rings.radial_slope->value, 10.0, 1.0);
  EXPECT_GT(pair.geometry.distance.offset_px, 0.2);
}

/// Least squares of the offsets along the normals.
double shift_x_px(const ComparedPair& pair) {
  double along = 0.0;
  double weight = 0.0;
  for (const EdgeOffset& edge : pair.geometry.offsets) {
    along += edge.offset_px * edge.normal.x();
    weight += edge.normal.x() * edge.normal.x();
  }
  return along / weight;
}

TEST_F(ComparePairTest, MeasuresAShiftAlongNormals) {
  const ComparedPair pair = compare(drawn_blade(), drawn_blade({.shift_x_px = 0.8, .index = 1}));
  EXPECT_NEAR(shift_x_px(pair), 0.8, 0.03);
  EXPECT_NEAR(pair.geometry.distance.offset_px, 0.0, 0.03);
}

TEST_F(ComparePairTest, MatchesTheExposureBeforeGreysAreCompared) {
  const ComparedPair pair = compare(drawn_blade(), drawn_blade({.gain = 1.3, .index = 1}));
  EXPECT_NEAR(pair.appearance.exposure.gain, 1.3, 0.005);
  EXPECT_LT(pair.appearance.histogram_distance, 0.003);
}

// A shadow in the lower right of the real part is told there, and nowhere else.
TEST_F(ComparePairTest, TellsInWhichRegionGreysDiffer) {
  const auto surface = [](double shadow) {
    ImageF picture(150, 120);
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 150; ++x) {
        const double grey = 0.5 + 0.2 * std::sin(0.5 * x) * std::sin(0.4 * y);
        picture(x, y) = static_cast<float>(x >= 100 && y >= 80 ? shadow * grey : grey);
      }
    }
    return picture;
  };
  const ComparedPair pair = compare(surface(1.0), surface(0.8), {.outline = OutlineChoice::kInner});
  ASSERT_EQ(pair.regions.size(), 9U);
  EXPECT_EQ(pair.regions[8].name, "bottom right");
  EXPECT_EQ(pair.regions[8].pixels, 2000U);
  EXPECT_NEAR(pair.regions[8].difference, -0.1, 0.02);
  EXPECT_GT(pair.regions[8].correlation, 0.999);
  // All of its greys lie on one side, as far as the mean does; structure differs at its rims, which
  // it shares with its neighbours.
  EXPECT_NEAR(pair.regions[8].histogram_distance, -pair.regions[8].difference, 1e-3);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_LT(pair.regions[i].histogram_distance, 0.02) << pair.regions[i].name;
    EXPECT_LT(std::abs(pair.regions[i].difference), 0.02) << pair.regions[i].name;
    EXPECT_GT(pair.regions[i].ssim, pair.regions[8].ssim) << pair.regions[i].name;
  }
  EXPECT_GT(pair.regions[8].gmsd, 0.05);
  for (const std::size_t away : {0U, 1U, 2U, 3U, 6U}) {
    EXPECT_LT(pair.regions[away].gmsd, 0.01) << pair.regions[away].name;
  }
}

// Both pictures have the dark signal of the scene, whatever the light: the gain is the light's.
TEST_F(ComparePairTest, OfMoreLightHasItsGainBesideTheDarkSignal) {
  const auto before_dark = [](ImageF picture) {
    for (float& grey : picture.values()) {
      grey += 0.2F;
    }
    return picture;
  };
  ComparedPair pair = compare(before_dark(drawn_blade({.noise = 0.002})),
                              before_dark(drawn_blade({.gain = 0.8, .noise = 0.002, .index = 1})));
  pair.simulated.source.scene = folder() / "scene.toml";
  write_file(pair.simulated.source.scene,
             "schema = 1\n[sensor]\nfull_well_e = 10000\ndark_e = 2000\n");
  const PairCauses causes = find_causes(pair);
  ASSERT_EQ(causes.told.size(), 1U);
  EXPECT_EQ(causes.told[0].name, "gain");
  EXPECT_NEAR(causes.told[0].value, 0.8, 0.002);
}

// Noise of the simulated picture makes the gain of a regression too small: that is no cause.
TEST_F(ComparePairTest, HasNoGainOfNoise) {
  const ComparedPair equal =
      compare(drawn_blade({.noise = 0.03}), drawn_blade({.noise = 0.01, .index = 1}));
  EXPECT_LT(equal.appearance.exposure.gain, 0.997);
  EXPECT_TRUE(find_causes(equal).told.empty());
  const ComparedPair with_offset = compare(drawn_blade({.noise = 0.03}),
                                           drawn_blade({.noise = 0.01, .index = 1}),
                                           {.exposure = ExposureModel::kGainAndOffset});
  EXPECT_TRUE(find_causes(with_offset).told.empty());
  const ComparedPair brighter =
      compare(drawn_blade({.noise = 0.03}), drawn_blade({.gain = 1.1, .noise = 0.01, .index = 1}));
  const PairCauses causes = find_causes(brighter);
  ASSERT_EQ(causes.told.size(), 1U);
  EXPECT_NEAR(causes.told[0].value, 1.1, 3.0 * causes.told[0].sigma);
}

// Noise is alike in both, and makes a tenth of the brighter picture clip: a regression of one on
// the other is too flat, and what noise brightened to full scale is missing.
TEST_F(ComparePairTest, HasTheGainBetweenNoisyPictures) {
  constexpr double kGain = 1.55;
  constexpr std::uint64_t kPairs = 6;
  double off = 0.0;
  double flat_off = 0.0;
  for (std::uint64_t i = 0; i < kPairs; ++i) {
    const ComparedPair pair =
        compare(drawn_blade({.noise = 0.02, .index = 2 * i}),
                drawn_blade({.gain = kGain, .noise = 0.031, .index = 2 * i + 1}));
    const PairCauses causes = find_causes(pair);
    ASSERT_EQ(causes.told.size(), 1U);
    ASSERT_EQ(causes.told[0].name, "gain");
    off += (causes.told[0].value - kGain) / causes.told[0].sigma;
    flat_off += (pair.appearance.exposure.gain - kGain) / causes.told[0].sigma;
  }
  EXPECT_LT(std::abs(off / static_cast<double>(kPairs)), 0.8);
  EXPECT_LT(flat_off / static_cast<double>(kPairs), -1.6) << "the regression alone";
}

/// A surface whose greys have a deviation of 0.1, and noise of 0.005.
ImageF waves(double gain, double offset, std::uint64_t index) {
  ImageF picture(200, 160);
  for (int y = 0; y < 160; ++y) {
    for (int x = 0; x < 200; ++x) {
      const double grey = 0.5 + 0.2 * std::sin(0.5 * x) * std::sin(0.4 * y);
      picture(x, y) = static_cast<float>(gain * grey + offset);
    }
  }
  add_normal_noise(picture, 0.005, index);
  return picture;
}

// real = 1.01 simulated + 0.1. Beyond the common offset greys differ by 0.01 x 0.1 = 0.001 of the
// gain and root 2 x 0.005 = 0.0071 of noise: the gain's share is 0.001^2 / (0.001^2 + 0.0071^2), or
// 0.02. Nearly all of the misfit with its offset (0.105^2) would be the offset's.
TEST_F(ComparePairTest, HasAShareOfTheGainBesideAnOffset) {
  const ComparedPair pair =
      compare(waves(1.0, 0.0, 0),
              waves(1.01, 0.1, 1),
              {.outline = OutlineChoice::kInner, .exposure = ExposureModel::kGainAndOffset});
  const PairCauses causes = find_causes(pair);
  ASSERT_EQ(causes.told.size(), 1U);
  EXPECT_EQ(causes.told[0].name, "gain");
  EXPECT_NEAR(causes.told[0].value, 1.01, 4.0 * causes.told[0].sigma);
  EXPECT_NEAR(causes.told[0].share, 0.02, 0.02);
}

// Another picture altogether is not this one in another exposure.
TEST_F(ComparePairTest, HasNoGainWithoutCorrelation) {
  ImageF noise(200, 160, 0.1F);
  add_normal_noise(noise, 0.01, 7);
  EXPECT_TRUE(find_causes(compare(drawn_blade(), noise)).told.empty());
}

// Nothing could be looked for in the real picture.
TEST_F(ComparePairTest, HasNoGeometryOfASimulatedPictureWithoutAPart) {
  ImageF noise(200, 160, 0.1F);
  add_normal_noise(noise, 0.003, 7);
  const ComparedPair pair = compare(noise, drawn_blade());
  EXPECT_EQ(pair.geometry.outlines.simulated.method, OutlineMethod::kInner);
  EXPECT_FALSE(pair.geometry.iou.has_value());
  EXPECT_LT(pair.appearance.correlation, 0.1);
  EXPECT_THAT(pair.notes, ::testing::Contains(::testing::HasSubstr("no silhouette")));
}

ImageF brighter_background(ImageF picture) {
  for (float& grey : picture.values()) {
    grey = 0.9F - grey;
  }
  return picture;
}

// A dark part on a bright ground is found by a cut that begins with the simulated part.
TEST_F(ComparePairTest, FindsAPartThatIsDarkerThanItsBackground) {
  const ComparedPair pair = compare(drawn_blade(), brighter_background(drawn_blade({.index = 1})));
  EXPECT_EQ(pair.geometry.outlines.real.method, OutlineMethod::kGrabCut);
  EXPECT_GE(pair.geometry.iou.value(), 0.99);
  EXPECT_LE(pair.geometry.distance.mean_px, 0.1);
}

/// Five times as large in a picture that is segmented at a quarter of its size.
ImageF large_blade(double shift_px, double dark, double bright) {
  ImageF picture = drawn(2400, 640, [=](double x, double y) {
    const double u = x - 1200.0 - shift_px;
    const double v = y - 320.0;
    const double disc = std::hypot(u + 300.0, v) - 190.0;
    const double bar = std::fmax(std::abs(u - 200.0) - 400.0, std::abs(v + 70.0) - 45.0);
    const double share = 0.5 * std::erfc(std::fmin(disc, bar) / (std::sqrt(2.0) * 0.6));
    return dark + (bright - dark) * share;
  });
  add_normal_noise(picture, 0.004, 3);
  return picture;
}

TEST_F(ComparePairTest, FindsALargePartByACutOfAQuarterOfItsSize) {
  const ComparedPair pair = compare(large_blade(0.0, 0.05, 0.6),
                                    large_blade(1.5, 0.7, 0.1),
                                    {.outline = OutlineChoice::kGrabCut});
  EXPECT_EQ(pair.geometry.outlines.real.method, OutlineMethod::kGrabCut);
  EXPECT_NEAR(shift_x_px(pair), 1.5, 0.05);
  EXPECT_GE(pair.geometry.distance.share, 0.95);
}

// A part of grey 0.6 under 60 % of red (0.86, 0.16, 0.12), the ground beside it grey as it is.
TEST_F(ComparePairTest, IsShownAsRedOnThePhotograph) {
  const ComparedPair pair = compare(drawn_blade(), drawn_blade({.shift_x_px = 6.0, .index = 1}));
  const ImageRgb overlay = overlay_of(pair);
  const auto& on = overlay(80, 80);
  EXPECT_GT(on[0], on[1] + 80);
  EXPECT_NEAR(on[0] - on[2], 255.0 * 0.6 * (0.86 - 0.12), 2.0);
  EXPECT_NEAR(on[1] - on[2], 255.0 * 0.6 * (0.16 - 0.12), 2.0);
  const auto& beside = overlay(180, 140);
  EXPECT_EQ(beside[0], beside[1]);
  EXPECT_EQ(beside[1], beside[2]);
  // Of the photograph's part alone, 3 px beyond the simulated bar's end: bright, and not red.
  const auto& beyond = overlay(173, 66);
  EXPECT_EQ(beyond[0], beyond[2]);
  EXPECT_GT(beyond[0], 100);
}

TEST_F(ComparePairTest, TakesAGivenMask) {
  ImageF whole = drawn_blade({.noise = 0.0});
  for (float& grey : whole.values()) {
    grey = grey > 0.25F ? 1.0F : 0.0F;
  }
  const ComparedPair pair =
      compare(drawn_blade(), drawn_blade({.index = 1}), {.real_mask = write("m.png", whole)});
  EXPECT_EQ(pair.geometry.outlines.real.method, OutlineMethod::kMask);
  EXPECT_GE(pair.geometry.iou.value(), 0.998);
  EXPECT_THAT(pair.notes,
              ::testing::Not(::testing::Contains(::testing::HasSubstr("white all over"))));
  std::ranges::fill(whole.values(), 1.0F);
  const ComparedPair white =
      compare(drawn_blade(), drawn_blade({.index = 1}), {.real_mask = write("w.png", whole)});
  EXPECT_THAT(white.notes, ::testing::Contains(::testing::HasSubstr("white all over")));
}

// A surface that fills both pictures: its own edges serve.
TEST_F(ComparePairTest, UsesInnerEdgesWhereThereIsNoSilhouette) {
  const auto squares = [](double shift_px) {
    return drawn(160, 120, [=](double x, double y) {
      return std::sin(0.16 * (x - shift_px)) * std::sin(0.16 * y) > 0.0 ? 0.8 : 0.2;
    });
  };
  const ComparedPair pair = compare(squares(0.0), squares(0.5), {.outline = OutlineChoice::kInner});
  EXPECT_EQ(pair.geometry.outlines.real.method, OutlineMethod::kInner);
  EXPECT_FALSE(pair.geometry.iou.has_value());
  EXPECT_GT(pair.geometry.distance.points, 500U);
  EXPECT_NEAR(pair.geometry.distance.mean_px, 0.25, 0.08);  // half of the edges are upright
}

// By one square every edge lies on one of the other sign: none is the same.
TEST_F(ComparePairTest, TakesNoInnerEdgesOfTheOtherSign) {
  const auto squares = [](double shift_px) {
    return drawn(160, 120, [=](double x, double y) {
      return std::sin(0.16 * (x - shift_px)) * std::sin(0.16 * y) > 0.0 ? 0.8 : 0.2;
    });
  };
  const ComparedPair pair =
      compare(squares(0.0), squares(std::numbers::pi / 0.16), {.outline = OutlineChoice::kInner});
  EXPECT_EQ(pair.geometry.distance.points, 0U);
  EXPECT_THAT(pair.geometry.outlines.notes, ::testing::Contains(::testing::HasSubstr(" 0 %")));
}

class KnownDentTest : public KnownDefects {
 protected:
  /// A blade whose simulated side knows a dent of radius 5 px, 40 px left of the picture's middle.
  ComparedPair compared() const {
    return compared_with(
        R"({"id": 0, "label": "dent_1", "kind": "dent", "centre_mm": [-4, 0, 0], "area_px": 78.5})");
  }

  ThreadPool pool_{1};
};

TEST_F(KnownDentTest, IsNotMissedOutsideThePhotograph) {
  ComparedPair pair = compared();
  pair.geometry.outlines.motion = OutlineMotion{.shift_px = {-75.0, 0.0}};
  pair.geometry.outlines.shown = 1.0;
  const auto inspected = inspect_pair(pair, pool_);
  ASSERT_TRUE(inspected.has_value());
  EXPECT_EQ(inspected->simulated.found + inspected->simulated.missed, 1);
  EXPECT_EQ(inspected->real.found, 0);
  EXPECT_EQ(inspected->real.missed, 0);
  EXPECT_THAT(inspected->notes,
              ::testing::Contains(::testing::HasSubstr("1 of 1 defects lie outside")));
  EXPECT_TRUE(inspection_json(*inspected)["defects"][0]["real"]["found"].is_null());
}

// Edges that all run one way leave open where along them the dent lies.
TEST_F(KnownDentTest, IsNotSurelyWhereEdgesOfOneDirectionHaveIt) {
  ComparedPair pair = compared();
  pair.geometry.outlines.motion = OutlineMotion{.shift_px = {0.0, 1.0}};
  pair.geometry.outlines.shown = 1.0;
  EXPECT_FALSE(inspection_json(*inspect_pair(pair, pool_))["moved"].contains("untold"));
  pair.geometry.outlines.motion->untold = {1.0, 0.0};
  const auto inspected = inspect_pair(pair, pool_);
  ASSERT_TRUE(inspected.has_value());
  EXPECT_THAT(inspected->notes,
              ::testing::Contains(::testing::HasSubstr("run along (1.00, 0.00)")));
  EXPECT_EQ(inspection_json(*inspected)["moved"]["untold"][0], 1.0);
}

// Without pixels on both parts contrasts are those of all pixels.
TEST_F(KnownDentTest, HasContrastsWhereThePartsDoNotOverlap) {
  ComparedPair pair = compared();
  pair.better_turn = BetterTurn{.name = "turned by 180 degrees"};  // so nothing is moved
  pair.geometry.outlines.real.coverage = ImageF(200, 160);
  const auto inspected = inspect_pair(pair, pool_);
  ASSERT_TRUE(inspected.has_value());
  EXPECT_FALSE(inspected->moved.has_value());
  EXPECT_TRUE(inspected->simulated.defects[0].contrast.has_value());
  EXPECT_TRUE(inspected->real.defects[0].contrast.has_value());
}

TEST(GrabCut, HasNoAnswerWithoutABackground) {
  EXPECT_FALSE(grab_cut(ImageF(30, 30, 0.5F), Mask(30, 30, 1)).has_value());
  EXPECT_FALSE(grab_cut(ImageF(30, 30, 0.5F), Mask(30, 30)).has_value());
}

}  // namespace
}  // namespace glint

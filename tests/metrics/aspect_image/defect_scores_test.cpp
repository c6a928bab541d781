// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/aspect_image/defect_scores.h"

#include <gmock/gmock.h>

#include <cmath>

#include "core/rng.h"
#include "tests/metrics/aspect_image/disc_view.h"

namespace glint {
namespace {

constexpr int kDentSide = 40;

/// A dent of radius 3 px whose middle is a corner of four pixels in the middle of the image.
std::vector<DefectPixels> middle_dent() {
  const std::vector<DefectView> views = {disc_view("dent", 20.0, 20.0, 3.0, kDentSide, kDentSide)};
  return defect_pixels(views, Mask(kDentSide, kDentSide, 1));
}

/// A chessboard of background -+ texture with the dent's pixels at one value.
ImageF dent_on_chessboard(float background, float texture, float dent) {
  ImageF image(kDentSide, kDentSide);
  for (int y = 0; y < kDentSide; ++y) {
    for (int x = 0; x < kDentSide; ++x) {
      image(x, y) = background + ((x + y) % 2 == 0 ? texture : -texture);
    }
  }
  const std::vector<DefectPixels> dents = middle_dent();
  for (const std::size_t pixel : dents[0].inside) {
    image.values()[pixel] = dent;
  }
  return image;
}

// (i + 1/2)^2 + (j + 1/2)^2 <= 9 holds for 8 pixels of a quadrant: 32 in D. The chessboard turns
// over in the mirror, so mean_B = 0.4 and s_B = 0.02. Weber 0.2 / 0.4, CNR 0.2 / 0.02, signature
// 32 / (9 pi) = 1.131768; d'^2 = (32 x 0.2^2 - 32 x 0.02^2) / 0.02^2 = 32 x 99, root 56.2850.
TEST(DefectScores, MatchAHandWorkedDent) {
  const auto dents = middle_dent();
  ASSERT_EQ(dents[0].inside.size(), 32U);
  const DefectScores scores = defect_scores(dent_on_chessboard(0.4f, 0.02f, 0.6f), dents, 0.001)[0];
  EXPECT_EQ(scores.label, "dent");
  EXPECT_NEAR(scores.weber, 0.5, 1e-5);
  EXPECT_NEAR(scores.peak, 0.5, 1e-5);
  EXPECT_NEAR(scores.cnr, 10.0, 1e-4);
  EXPECT_NEAR(scores.signature, 1.131768, 1e-6);
  EXPECT_NEAR(scores.dprime, 56.2850, 1e-3);
  EXPECT_NEAR(scores.michelson, (0.6 - 0.38) / (0.6 + 0.38), 1e-6);
}

// Without texture the floor divides: 0.2 / 0.001 = 200, sqrt(32 x 0.04) / 0.001 = 1131.37.
TEST(DefectScores, DivideByTheFloorOnAPerfectlyEvenBackground) {
  const DefectScores scores =
      defect_scores(dent_on_chessboard(0.4f, 0.0f, 0.6f), middle_dent(), 0.001)[0];
  EXPECT_NEAR(scores.cnr, 200.0, 1e-3);
  EXPECT_NEAR(scores.dprime, 1131.37, 0.01);
}

TEST(DefectScores, KeepTheSignOfADarkDefect) {
  const DefectScores scores =
      defect_scores(dent_on_chessboard(0.4f, 0.02f, 0.1f), middle_dent(), 0.001)[0];
  EXPECT_NEAR(scores.weber, -0.75, 1e-5);
  EXPECT_NEAR(scores.peak, -0.75, 1e-5);
  EXPECT_NEAR(scores.cnr, 15.0, 1e-4);
}

// A ring of +0.3 and a core of -0.3 in equal numbers cancel in the mean and not in d' and peak.
TEST(DefectScores, SeeADefectWhoseMeanCancels) {
  ImageF image = dent_on_chessboard(0.5f, 0.0f, 0.5f);
  const auto dents = middle_dent();
  for (std::size_t i = 0; i < dents[0].inside.size(); ++i) {
    image.values()[dents[0].inside[i]] = i % 2 == 0 ? 0.8f : 0.2f;
  }
  const DefectScores scores = defect_scores(image, dents, 0.01)[0];
  EXPECT_NEAR(scores.weber, 0.0, 1e-6);
  EXPECT_NEAR(std::abs(scores.peak), 0.6, 1e-6);
  EXPECT_NEAR(scores.dprime, std::sqrt(32 * 0.09) / 0.01, 1e-3);
}

// Without the correction for the window's own noise, d'^2 of nothing would be |W| = 112.
TEST(DefectScores, FindNothingInPureNoise) {
  Rng rng(7, Stream::kTest, 0);
  const auto dents = middle_dent();
  double energy = 0.0;
  constexpr int kImages = 1000;
  for (int trial = 0; trial < kImages; ++trial) {
    ImageF image(kDentSide, kDentSide);
    for (float& value : image.values()) {
      value = static_cast<float>(0.5 + 0.02 * rng.normal());
    }
    const DefectScores scores = defect_scores(image, dents, 1e-4)[0];
    energy += scores.dprime * scores.dprime / kImages;
    EXPECT_LT(scores.cnr, 1.0);  // sigma / sqrt(32) = 0.18 sigma, 5 times that
  }
  EXPECT_EQ(dents[0].window.size(), 112U);
  EXPECT_LT(energy,
            12.0);  // half of the 15 = sqrt(2 x 112) by which the sum scatters, and the ring
  EXPECT_GT(energy, 1.0);
}

TEST(DefectScores, SeeAWeakDefectBelowTheSignatureThreshold) {
  // 0.41 against 0.40: 2.5 %, but below 2 % of full scale.
  const DefectScores scores =
      defect_scores(dent_on_chessboard(0.4f, 0.0f, 0.41f), middle_dent(), 0.001)[0];
  EXPECT_EQ(scores.signature, 0.0);
  EXPECT_NEAR(scores.weber, 0.025, 1e-5);
}

TEST(DefectScores, StayFiniteOnABlackBackground) {
  const DefectScores scores =
      defect_scores(dent_on_chessboard(0.0f, 0.0f, 0.1f), middle_dent(), 0.001)[0];
  EXPECT_NEAR(scores.weber, 100.0, 1e-4);
  EXPECT_EQ(defect_scores(ImageF(kDentSide, kDentSide), middle_dent(), 0.001)[0].michelson, 0.0);
}

TEST(DefectPixels, LeaveNeighboursOutOfTheBackground) {
  const std::vector<DefectView> views = {disc_view("left", 20.0, 20.0, 3.0, 60, 40),
                                         disc_view("right", 31.0, 20.0, 3.0, 60, 40)};
  const Mask part(60, 40, 1);
  const auto pixels = defect_pixels(views, part);
  ImageF image(60, 40, 0.5f);
  for (const std::size_t pixel : pixels[0].inside) {
    image.values()[pixel] = 0.6f;
  }
  const double alone = defect_scores(image, pixels, 0.001)[0].cnr;
  for (const std::size_t pixel : pixels[1].inside) {
    image.values()[pixel] = 1.0f;
  }
  EXPECT_EQ(defect_scores(image, pixels, 0.001)[0].cnr, alone);
  const auto blind = defect_pixels({views.data(), 1}, part);
  EXPECT_LT(defect_scores(image, blind, 0.001)[0].cnr, 0.5 * alone) << "neighbours do matter";
}

TEST(DefectPixels, GiveADefectSmallerThanAPixelThePixelItLiesIn) {
  const std::vector<DefectView> views = {disc_view("speck", 20.1, 10.9, 0.05, 40, 40, 100.0)};
  MetricsSettings settings;
  settings.ring_inner_radii = 40.0;
  settings.ring_outer_radii = 100.0;
  const auto pixels = defect_pixels(views, Mask(40, 40, 1), settings);
  EXPECT_THAT(pixels[0].inside, ::testing::ElementsAre(10U * 40U + 20U));
}

// On the corner of four pixels no middle is nearer than 0.71 px, which is 2.8 radii: one of the
// four is the defect's, the other three are its background.
TEST(DefectPixels, GiveADefectBetweenTheMiddlesOfPixelsOneOfThem) {
  const Mask part(40, 40, 1);
  const std::vector<DefectView> views = {disc_view("speck", 20.0, 20.0, 0.25, 40, 40)};
  const auto pixels = defect_pixels(views, part);
  EXPECT_THAT(pixels[0].inside, ::testing::ElementsAre(19U * 40U + 19U));
  EXPECT_EQ(pixels[0].window, pixels[0].inside);
  EXPECT_THAT(pixels[0].ring,
              ::testing::ElementsAre(19U * 40U + 20U, 20U * 40U + 19U, 20U * 40U + 20U));
  // The ring of an even smaller one holds no middle of a pixel.
  const std::vector<DefectView> tiny = {disc_view("speck", 20.0, 20.0, 0.1, 40, 40, 30.0)};
  EXPECT_THAT([&] { defect_pixels(tiny, part); },
              ::testing::ThrowsMessage<ConfigError>(
                  ::testing::HasSubstr("speck is smaller than a pixel and has no background")));
}

// A scratch 0.2 px wide between two rows.
TEST(DefectPixels, GiveAScratchBetweenTwoRowsAPixel) {
  DefectView view{.label = "scratch", .left_px = 10, .top_px = 15, .distance = ImageF(20, 10)};
  view.area_px = 4.0;
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 20; ++x) {
      view.distance(x, y) = std::abs(static_cast<float>(y) - 4.5F) / 0.1F;
    }
  }
  MetricsSettings settings;
  settings.ring_outer_radii = 20.0;
  const auto pixels = defect_pixels(std::vector{view}, Mask(40, 40, 1), settings);
  EXPECT_THAT(pixels[0].inside, ::testing::ElementsAre(19U * 40U + 10U));
  EXPECT_EQ(pixels[0].ring.size(), 4U * 20U - 1U);
}

// One whose middle is not on the part stays unseen, however near its ring comes.
TEST(DefectPixels, GiveADefectOffThePartNoPixel) {
  Mask part(40, 40, 1);
  for (int y = 0; y < 40; ++y) {
    for (int x = 0; x < 22; ++x) {
      part(x, y) = 0;
    }
  }
  const auto refused = ::testing::ThrowsMessage<ConfigError>(::testing::HasSubstr("is not in"));
  for (const double radius_px : {0.25, 0.5, 0.8}) {
    const std::vector<DefectView> views = {
        disc_view("dent", 20.0, 20.0, radius_px, 40, 40, 8.0 / radius_px)};
    EXPECT_THAT([&] { defect_pixels(views, part); }, refused) << radius_px;
  }
}

TEST(DefectPixels, RefuseADefectOffThePartOrWithoutBackground) {
  using ::testing::HasSubstr;
  const std::vector<DefectView> views = {disc_view("dent", 20.0, 20.0, 3.0, 40, 40)};
  Mask part(40, 40);
  EXPECT_THAT(
      [&] { defect_pixels(views, part); },
      ::testing::ThrowsMessage<ConfigError>(HasSubstr("defects.dent: dent is not in the pic")));
  part(20, 20) = 1;
  EXPECT_THAT(
      [&] { defect_pixels(views, part); },
      ::testing::ThrowsMessage<ConfigError>(HasSubstr("defects.dent: dent has no background")));
}

TEST(DefectPixels, NameTheTableOfADefectAndWhatToDo) {
  EXPECT_EQ(defect_table("dent_2"), "defects.dent");
  EXPECT_EQ(defect_table("dent2_12"), "defects.dent2");
  EXPECT_EQ(defect_table("small_dent_1"), "defects.small_dent");
  EXPECT_EQ(defect_table("dent_"), "defects.dent_");
  EXPECT_EQ(defect_table("_1"), "defects._1");
  const std::vector<DefectView> views = {disc_view("dent2_2", 20.0, 20.0, 3.0, 40, 40)};
  try {
    defect_pixels(views, Mask(40, 40));
    FAIL() << "a defect without pixels";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.problems()[0].key, "defects.dent2");
    EXPECT_THAT(error.problems()[0].text, ::testing::HasSubstr("facing_deg"));
  }
}

TEST(Summarise, TakesTheWorstDefect) {
  const std::vector<DefectScores> scores = {
      {.label = "a", .weber = -0.3, .cnr = 5.0, .dprime = 9.0, .signature = 0.2},
      {.label = "b", .weber = 0.1, .cnr = 7.0, .dprime = 4.0, .signature = 0.6}};
  const DefectSummary summary = summarise(scores);
  EXPECT_EQ(summary.min_cnr, 5.0);
  EXPECT_EQ(summary.min_weber, 0.1);
  EXPECT_NEAR(summary.mean_weber, 0.2, 1e-12);
  EXPECT_EQ(summary.min_dprime, 4.0);
  EXPECT_EQ(summary.min_signature, 0.2);
}

// Frames: 0.6 on 0.5 (difference 0.1, Weber 0.2); 0.1 on 0.4 (0.3, 0.75); 0.1 on 0 (0.1 and
// 0.1 / 0.05 = 2, the floor dividing).
TEST(BestFrames, KeepTheFrameThatShowsTheDefectBest) {
  const auto dents = middle_dent();
  BestFrames frames(dents, 0.05);
  EXPECT_EQ(frames.best()[0].frame, -1);
  frames.add(dent_on_chessboard(0.5f, 0.02f, 0.6f));
  EXPECT_NEAR(frames.best()[0].weber, 0.2, 1e-5);
  frames.add(dent_on_chessboard(0.4f, 0.02f, 0.1f));
  EXPECT_NEAR(frames.best()[0].weber, 0.75, 1e-5);
  frames.add(dent_on_chessboard(0.0f, 0.0f, 0.1f));
  EXPECT_NEAR(frames.best()[0].weber, 2.0, 1e-5);
  EXPECT_NEAR(frames.best()[0].difference, 0.3, 1e-5);
  EXPECT_EQ(frames.best()[0].frame, 1);
}

// Half of the dent's pixels differ by 0.4, the others by 0: a mean change of 0.2. The next frame
// equals the flawless one and changes nothing, however far it is from its background.
TEST(BestFrames, KeepTheLargestChangeAgainstTheFlawlessSurface) {
  const auto dents = middle_dent();
  BestFrames frames(dents, 0.05);
  const std::size_t count = dents[0].inside.size();
  std::vector<float> flawless(count, 0.6f);
  for (std::size_t i = 0; i < count / 2; ++i) {
    flawless[i] = 0.2f;
  }
  const auto half = count / 2;
  const double expected = 0.4 * static_cast<double>(half) / static_cast<double>(count);
  const ImageF frame = dent_on_chessboard(0.5f, 0.02f, 0.6f);
  using Values = std::vector<std::vector<float>>;
  frames.add(frame, Values(1, flawless));
  EXPECT_NEAR(frames.best()[0].change, expected, 1e-6);
  const ImageF other = dent_on_chessboard(0.0f, 0.0f, 0.1f);
  frames.add(other, Values(1, std::vector<float>(count, 0.1f)));
  EXPECT_NEAR(frames.best()[0].change, expected, 1e-6);
  frames.add(other);
  EXPECT_NEAR(frames.best()[0].change, expected, 1e-6);
}

// 32 pixels of 0.6 in D, 604 in B of 0.4 -+ 0.02: mean 0.410063; variance (32 x 0.189937^2 + 604 x
// (0.010063^2 + 0.0004)) / 636 = 0.00229119, root 0.0478664, over the mean 0.116729.
TEST(DefectScores, HaveTheRmsContrastOfDefectAndBackgroundTogether) {
  const auto dents = middle_dent();
  ASSERT_EQ(dents[0].ring.size(), 604U);
  const DefectScores scores = defect_scores(dent_on_chessboard(0.4f, 0.02f, 0.6f), dents, 0.001)[0];
  EXPECT_NEAR(scores.rms_contrast, 0.116729, 1e-5);
  const ImageF even = dent_on_chessboard(0.4f, 0.0f, 0.4f);
  EXPECT_NEAR(defect_scores(even, dents, 0.001)[0].rms_contrast, 0.0, 1e-7);
  EXPECT_EQ(defect_scores(ImageF(kDentSide, kDentSide), dents, 0.001)[0].rms_contrast, 0.0);
}

// The first 10 of 32 pixels change in the first frame, pixels 5 to 15 in the second: 16 in all, of
// an area of 9 pi. Changes of less than the least do not count.
TEST(BestFrames, UniteWhatChangesInAnyFrame) {
  const auto dents = middle_dent();
  BestFrames frames(dents, 0.05, 0.1);
  const ImageF frame = dent_on_chessboard(0.5f, 0.0f, 0.6f);
  const auto add = [&](std::size_t begin, std::size_t end, float change) {
    std::vector<float> flawless(dents[0].inside.size(), 0.6f);
    for (std::size_t i = begin; i < end; ++i) {
      flawless[i] += change;
    }
    frames.add(frame, std::vector<std::vector<float>>(1, flawless));
    return frames.best()[0].union_area;
  };
  const double area_px = 9.0 * 3.14159265358979;
  EXPECT_EQ(add(0, 32, 0.09f), 0.0);
  EXPECT_NEAR(add(0, 10, 0.2f), 10.0 / area_px, 1e-12);
  EXPECT_NEAR(add(5, 16, -0.2f), 16.0 / area_px, 1e-12);
  EXPECT_NEAR(add(0, 0, 0.0f), 16.0 / area_px, 1e-12);
  frames.add(frame);
  EXPECT_NEAR(frames.best()[0].union_area, 16.0 / area_px, 1e-12);
}

TEST(Summarise, TakesTheSmallestRmsContrastBestFrameAndUnion) {
  const std::vector<DefectScores> scores = {
      {.label = "a", .rms_contrast = 0.3, .best_frame = 0.1, .union_area = 0.9},
      {.label = "b", .rms_contrast = 0.2, .best_frame = 0.4, .union_area = 1.0}};
  const DefectSummary summary = summarise(scores);
  EXPECT_EQ(summary.min_rms_contrast, 0.2);
  EXPECT_EQ(summary.min_best_frame, 0.1);
  EXPECT_EQ(summary.min_union, 0.9);
}

TEST(Summarise, TakesTheWorstAndTheMeanChange) {
  const std::vector<DefectScores> scores = {{.label = "a", .change = 0.6},
                                            {.label = "b", .change = 0.2}};
  EXPECT_DOUBLE_EQ(summarise(scores).min_change, 0.2);
  EXPECT_DOUBLE_EQ(summarise(scores).mean_change, 0.4);
}

}  // namespace
}  // namespace glint

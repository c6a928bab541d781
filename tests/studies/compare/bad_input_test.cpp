// SPDX-License-Identifier: GPL-3.0-or-later
//
// What people will give `glint compare` by mistake.
#include <algorithm>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/image/exr_layers.h"
#include "studies/compare/causes.h"
#include "studies/compare/compare_result.h"
#include "studies/compare/compared_pair.h"
#include "tests/studies/compare/compare_fixture.h"
#include "tests/support/oriented_tiff.h"

namespace glint {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

class BadInput : public CompareFiles {
 protected:
  ComparedPair compare(const std::filesystem::path& simulated,
                       const std::filesystem::path& real,
                       const PairOptions& options = {}) {
    return compare_pair(
        {.simulated = {.name = "s", .picture = simulated}, .real = {.name = "r", .picture = real}},
        options);
  }

  std::filesystem::path good() { return write("good.png", drawn_blade()); }
};

template <class Place>
ImageF rearranged(const ImageF& picture, int width, int height, const Place& place) {
  ImageF result(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      result(x, y) = place(picture, x, y);
    }
  }
  return result;
}

TEST_F(BadInput, PicturesOfOtherSizeAreRefusedWithBothSizes) {
  const auto other = write("other.png", drawn_disc(100, 50, 50, 30, 0.7));
  EXPECT_THAT([&] { compare(good(), other); },
              ThrowsMessage<ConfigError>(AllOf(HasSubstr("200 x 160"), HasSubstr("100 x 100"))));
}

TEST_F(BadInput, APictureTurnedByAQuarterIsTold) {
  const auto turned =
      write("turned.png", rearranged(drawn_blade(), 160, 200, [](const ImageF& p, int x, int y) {
              return p(y, 159 - x);
            }));
  EXPECT_THAT([&] { compare(good(), turned); },
              ThrowsMessage<ConfigError>(HasSubstr("turned by 90 degrees")));
}

TEST_F(BadInput, AMirroredOrTurnedPictureIsTold) {
  const auto mirrored =
      write("mirrored.png", rearranged(drawn_blade(), 200, 160, [](const ImageF& p, int x, int y) {
              return p(199 - x, y);
            }));
  EXPECT_EQ(compare(good(), mirrored).better_turn->name, "mirrored from left to right");
  const auto turned =
      write("turned.png", rearranged(drawn_blade(), 200, 160, [](const ImageF& p, int x, int y) {
              return p(199 - x, 159 - y);
            }));
  const ComparedPair pair = compare(good(), turned);
  EXPECT_EQ(pair.better_turn->name, "turned by 180 degrees");
  EXPECT_THAT(pair.notes, Contains(HasSubstr("turned by 180 degrees")));
}

/// The same mistakes with a square picture, whose size does not tell.
TEST_F(BadInput, ASquarePictureThatIsTurnedOrMirroredAboutADiagonalIsTold) {
  const ImageF square = rearranged(
      drawn_blade(), 160, 160, [](const ImageF& p, int x, int y) { return p(x + 20, y); });
  const auto simulated = write("square.png", square);
  const auto told = [&](const auto& place) {
    const ComparedPair pair =
        compare(simulated, write("turned.png", rearranged(square, 160, 160, place)));
    return pair.better_turn ? pair.better_turn->name : std::string("as it is");
  };
  EXPECT_EQ(told([](const ImageF& p, int x, int y) { return p(x, y); }), "as it is");
  EXPECT_EQ(told([](const ImageF& p, int x, int y) { return p(159 - y, x); }),
            "turned by 90 degrees");
  EXPECT_EQ(told([](const ImageF& p, int x, int y) { return p(y, 159 - x); }),
            "turned by 270 degrees");
  EXPECT_EQ(told([](const ImageF& p, int x, int y) { return p(y, x); }),
            "mirrored about a diagonal");
  EXPECT_EQ(told([](const ImageF& p, int x, int y) { return p(159 - y, 159 - x); }),
            "mirrored about the other diagonal");
}

// Mirrored it lies where it lies in the photograph, but a shift says the same with less.
TEST_F(BadInput, ASymmetricPartOnTheOtherSideOfTheMiddleIsNotMirrored) {
  const auto disc = [](double x_px, std::uint64_t index) {
    ImageF picture = drawn(200, 160, [=](double x, double y) {
      const double excess = std::hypot(x - x_px, y - 80.0) - 40.0;
      return 0.01 + 0.5 * std::erfc(excess / std::sqrt(2.0)) * (0.5 - 0.001 * std::abs(y - 80.0));
    });
    add_normal_noise(picture, 0.004, index);
    return picture;
  };
  const ComparedPair pair =
      compare(write("left.png", disc(82.0, 1)), write("right.png", disc(118.0, 2)));
  EXPECT_FALSE(pair.better_turn.has_value()) << pair.better_turn->name;
}

ImageF mirrored_in_x(const ImageF& picture) {
  return rearranged(picture, picture.width(), picture.height(), [](const ImageF& p, int x, int y) {
    return p(p.width() - 1 - x, y);
  });
}

/// A bar of 150 x 14 px with a bright line along it, turned by some degrees about the middle, and a
/// lug of 28 px beside it near one end.
ImageF turned_bar(double turn_deg, std::uint64_t index, bool has_lug = false) {
  const double cosine = std::cos(turn_deg * std::numbers::pi / 180.0);
  const double sine = std::sin(turn_deg * std::numbers::pi / 180.0);
  ImageF picture = drawn(200, 160, [=](double x, double y) {
    const double u = cosine * (x - 100.0) + sine * (y - 80.0);
    const double v = cosine * (y - 80.0) - sine * (x - 100.0);
    const double bar = std::fmax(std::abs(u) - 75.0, std::abs(v) - 7.0);
    const double lug = std::fmax(std::abs(u - 50.0) - 14.0, std::abs(v + 20.0) - 14.0);
    const double beyond = has_lug ? std::fmin(bar, lug) : bar;
    const double share = 0.5 * std::erfc(beyond / (std::sqrt(2.0) * 0.6));
    return 0.01 + share * (0.3 + 0.2 * std::exp(-0.1 * v * v));
  });
  add_normal_noise(picture, 0.004, index);
  return picture;
}

// Mirrored it lies where the other one lies, but a turn by so little says the same with less. The
// bar with a lug lies elsewhere however it is turned.
TEST_F(BadInput, ASymmetricBarThatLiesAskewIsNotMirrored) {
  for (const double turn_deg : {3.0, 4.3, 6.0, 8.0}) {
    const auto simulated = write("simulated.png", turned_bar(-0.5 * turn_deg, 1));
    const ComparedPair pair = compare(simulated, write("askew.png", turned_bar(0.5 * turn_deg, 2)));
    EXPECT_FALSE(pair.better_turn.has_value())
        << turn_deg << " " << pair.better_turn->name << " " << pair.better_turn->correlation << " "
        << pair.better_turn->correlation_as_is;
    const auto lugged = write("lugged.png", turned_bar(-0.5 * turn_deg, 1, true));
    const ComparedPair other =
        compare(lugged, write("mirrored.png", mirrored_in_x(turned_bar(-0.5 * turn_deg, 2, true))));
    ASSERT_TRUE(other.better_turn.has_value()) << turn_deg;
    EXPECT_EQ(other.better_turn->name, "mirrored from left to right");
  }
}

/// A disc with marks to its right, whose outline no mirror changes; light falls off by `slope`.
ImageF marked_disc(double slope, std::uint64_t index, double mark = 0.25) {
  ImageF picture = drawn(200, 160, [=](double x, double y) {
    const double u = x - 100.0;
    const double v = y - 80.0;
    const double share = 0.5 * std::erfc((std::hypot(u, v) - 60.0) / (std::sqrt(2.0) * 0.6));
    const bool is_marked =
        std::hypot(u - 30.0, v + 12.0) < 11.0 || std::hypot(u - 4.0, v - 38.0) < 8.0;
    return 0.01 + share * (0.5 + slope * u - (is_marked ? mark : 0.0));
  });
  add_normal_noise(picture, 0.004, index);
  return picture;
}

TEST_F(BadInput, TheVerdictNamesWhatACauseCannotBeToldFrom) {
  const auto picture = write("disc.png", marked_disc(0.0, 1));
  const ComparedPair pair = compare(picture, picture);
  auto pairs = nlohmann::ordered_json::array({pair_json(pair, find_causes(pair))});
  pairs[0]["causes"] = nlohmann::ordered_json::parse(
      R"([{"name": "centre_x", "value": 12.2, "unit": "px", "sigma": 0.01, "share": 0.7,
           "group": ["centre_x", "shift_x"]}])");
  EXPECT_THAT(
      compare_verdict(pairs, std::nullopt),
      HasSubstr(
          "explained by centre_x = 12.2 px +- 0.01 (or shift_x, which cannot be distinguished "
          "from it)."));
}

TEST_F(BadInput, AMirroredOrTurnedPartWithASymmetricOutlineIsToldByItsInside) {
  const auto simulated = write("disc.png", marked_disc(0.0, 1));
  const auto real = write("mirrored.png", mirrored_in_x(marked_disc(0.001, 2)));
  const ComparedPair pair = compare(simulated, real);
  ASSERT_TRUE(pair.better_turn.has_value());
  EXPECT_EQ(pair.better_turn->name, "mirrored from left to right");
  EXPECT_THAT(pair.notes, Contains(HasSubstr("what is on the part correlates")));
  // Its silhouette fits all the same: the verdict does not begin with that.
  const auto pairs = nlohmann::ordered_json::array({pair_json(pair, find_causes(pair))});
  EXPECT_EQ(pairs[0]["better_turn"]["name"], "mirrored from left to right");
  EXPECT_THAT(compare_verdict(pairs, std::nullopt),
              StartsWith("The real picture seems to be mirrored from left to right. The "
                         "silhouettes overlap by 99"));
  const auto turned = write(
      "turned.png", rearranged(marked_disc(0.0, 3), 200, 160, [](const ImageF& p, int x, int y) {
        return p(199 - x, 159 - y);
      }));
  EXPECT_EQ(compare(simulated, turned).better_turn->name, "turned by 180 degrees");
}

/// A disc with upright waves 80 px long that a mirror image has the other way around.
ImageF waved_disc(double amplitude, std::uint64_t index) {
  ImageF picture = drawn(200, 160, [=](double x, double y) {
    const double u = x - 100.0;
    const double share = 0.5 * std::erfc((std::hypot(u, y - 80.0) - 60.0) / (std::sqrt(2.0) * 0.6));
    return 0.01 + share * (0.5 + amplitude * std::sin(std::numbers::pi * u / 40.0));
  });
  add_normal_noise(picture, 0.004, index);
  return picture;
}

// As it is, and turned by at most 12 degrees, bright lies on dark: that is less than nothing alike.
TEST_F(BadInput, APartThatIsLessAlikeThanNothingSaysSo) {
  const ComparedPair pair =
      compare(write("simulated.png", waved_disc(0.1, 1)), write("real.png", waved_disc(-0.1, 2)));
  ASSERT_TRUE(pair.better_turn.has_value());
  EXPECT_TRUE(pair.better_turn->is_inside);
  EXPECT_LT(pair.better_turn->correlation_as_is, -0.5);
}

// Light from the other side mirrors nothing, nor does a part that looks alike both ways.
TEST_F(BadInput, OtherLightOnASymmetricPartIsNoMirrorImage) {
  const auto simulated = write("disc.png", marked_disc(0.002, 1));
  EXPECT_FALSE(compare(simulated, write("same.png", marked_disc(-0.002, 2))).better_turn);
  const auto plain = write("plain.png", marked_disc(0.002, 3, 0.0));
  EXPECT_FALSE(compare(plain, write("other.png", marked_disc(-0.002, 4, 0.0))).better_turn);
}

TEST_F(BadInput, BlackWhiteAndEmptyPicturesAreRefused) {
  EXPECT_THAT([&] { compare(good(), write("black.png", ImageF(200, 160))); },
              ThrowsMessage<ConfigError>(HasSubstr("black.png: is black all over")));
  EXPECT_THAT([&] { compare(write("white.png", ImageF(200, 160, 1.0F)), good()); },
              ThrowsMessage<ConfigError>(HasSubstr("white.png: is at full scale all over")));
  EXPECT_THAT([&] { compare(good(), write("grey.png", ImageF(200, 160, 0.3F))); },
              ThrowsMessage<ConfigError>(HasSubstr("one grey value all over")));
}

// Where a dead light is no mistake, black and plain pictures have neither edges nor texture.
TEST_F(BadInput, PlainPicturesAreComparedWhereTheyMayBe) {
  const auto black = write("black.png", ImageF(200, 160));
  const auto grey = write("grey.png", ImageF(200, 160, 0.3F));
  for (const ComparedPair& pair : {compare(good(), black, {.may_be_plain = true}),
                                   compare(grey, good(), {.may_be_plain = true})}) {
    EXPECT_EQ(pair.geometry.distance.points, 0);
    EXPECT_FALSE(pair.geometry.iou);
    EXPECT_FALSE(pair.appearance.texture);
    EXPECT_THAT(pair.notes, Contains(HasSubstr("has one grey value all over")));
    EXPECT_THAT(pair_json(pair, {})["mean_distance_px"].dump(), "null");
  }
  EXPECT_THAT(
      [&] { compare(good(), write("white.png", ImageF(200, 160, 1.0F)), {.may_be_plain = true}); },
      ThrowsMessage<ConfigError>(HasSubstr("white.png: is at full scale all over")));
}

// The lens was covered: a sensor's noise about its dark level.
TEST_F(BadInput, ADarkPictureOfNoiseAloneIsRefused) {
  for (std::uint64_t i = 0; i < 20; ++i) {
    ImageF dark(200, 160, 0.004F);
    add_normal_noise(dark, 0.003, i);
    const ComparedPair pair = compare(good(), write("dark.png", dark));
    EXPECT_THAT([&] { check_shows_part(pair); },
                ThrowsMessage<ConfigError>(HasSubstr("dark.png: shows no part")));
  }
  // A part in the same darkness is compared, and fine stripes that look like noise are.
  const ComparedPair faint =
      compare(good(), write("faint.png", drawn_blade({.gain = 0.08, .noise = 0.003})));
  EXPECT_NO_THROW(check_shows_part(faint));
  const auto stripes = [&](const std::string& name, std::uint64_t index) {
    ImageF picture =
        drawn(200, 160, [](double x, double) { return 0.02 + 0.01 * std::sin(1.6 * x); });
    add_normal_noise(picture, 0.002, index);
    return write(name, picture);
  };
  EXPECT_NO_THROW(check_shows_part(compare(stripes("a.png", 1), stripes("b.png", 2))));
}

// Overexposed all over: codes of 253 to 255 of a picture of 8 bits.
TEST_F(BadInput, AnOverexposedPictureOfNoiseAloneIsRefused) {
  Rng rng(22, Stream::kTest, 0);
  ImageF white(200, 160);
  for (float& grey : white.values()) {
    grey = static_cast<float>((253.0 + std::floor(rng.uniform(0.0, 3.0))) / 255.0);
  }
  const ComparedPair pair = compare(good(), write("white.png", white, PixelDepth::k8Bit));
  EXPECT_THAT(
      [&] { check_shows_part(pair); },
      ThrowsMessage<ConfigError>(HasSubstr("white.png: shows no part: it is at full scale")));
}

// Noise alone has no silhouette and no edges; appearance is still compared.
TEST_F(BadInput, APictureWithoutAPartHasNoGeometry) {
  ImageF noise(200, 160, 0.1F);
  add_normal_noise(noise, 0.01, 7);
  const ComparedPair pair = compare(good(), write("noise.png", noise));
  EXPECT_EQ(pair.geometry.outlines.real.method, OutlineMethod::kInner);
  EXPECT_FALSE(pair.geometry.iou.has_value());
  EXPECT_LT(pair.geometry.distance.share, 0.1);
  EXPECT_LT(pair.appearance.correlation, 0.1);
  EXPECT_THAT(pair.notes, Contains(HasSubstr("no silhouette")));
}

TEST_F(BadInput, ColourAgainstGreyComparesLuminance) {
  const ImageF blade = drawn_blade();
  write_png(folder() / "colour.png", rgb_of(std::vector<ImageF>{blade, blade, blade}));
  const ComparedPair pair = compare(good(), folder() / "colour.png");
  EXPECT_GT(pair.geometry.iou.value(), 0.99);
  EXPECT_THAT(pair.notes, Contains(HasSubstr("luminance")));
}

TEST_F(BadInput, OtherDepthIsTheSamePicture) {
  const auto coarse = write("coarse.png", drawn_blade({.index = 1}), PixelDepth::k8Bit);
  const ComparedPair pair = compare(good(), coarse);
  EXPECT_GT(pair.geometry.iou.value(), 0.998);
  EXPECT_NEAR(pair.appearance.exposure.gain, 1.0, 0.005);
  EXPECT_THAT(pair.notes, Contains(HasSubstr("16 and 8 bits")));
}

// Radiance of any scale against codes: exposures are matched.
TEST_F(BadInput, FloatsAgainstCodesAreTheSamePictureInAnotherExposure) {
  ImageF radiance = drawn_blade();
  for (float& value : radiance.values()) {
    value = std::max(20.0F * value, 0.0F);
  }
  const ComparedPair pair = compare(write("radiance.exr", radiance), good());
  EXPECT_GT(pair.geometry.iou.value(), 0.998);
  EXPECT_LT(pair.appearance.histogram_distance, 0.003);
  EXPECT_THAT(pair.notes, Contains(HasSubstr("floats")));
  // Of which unit they are nobody knows: what brings them to codes is no gain of the camera.
  EXPECT_GT(std::abs(pair.appearance.exposure.gain - 1.0), 0.05);
  EXPECT_THAT(pair.notes, Contains(HasSubstr("no gain is named")));
  EXPECT_TRUE(find_causes(pair).told.empty());
}

// As cameras of telephones write them: viewers turn what is stored.
TEST_F(BadInput, APictureThatViewersTurnIsTold) {
  const ImageF blade = drawn_blade({.index = 1});
  Image<std::uint8_t> codes(blade.width(), blade.height());
  std::ranges::transform(blade.values(), codes.values().begin(), [](float grey) {
    return static_cast<std::uint8_t>(std::clamp(255.0F * grey + 0.5F, 0.0F, 255.0F));
  });
  write_file(folder() / "turned.tif", test::oriented_tiff(codes, 6));
  const ComparedPair pair = compare(good(), folder() / "turned.tif");
  EXPECT_GT(pair.geometry.iou.value(), 0.998);
  EXPECT_THAT(pair.notes,
              Contains(AllOf(HasSubstr("turned.tif is shown turned"), HasSubstr("orientation 6"))));
}

TEST_F(BadInput, OnePictureOnBothSidesIsTold) {
  EXPECT_THAT(compare(good(), good()).notes, Contains(HasSubstr("equal in every pixel")));
  const auto other = write("other.png", drawn_blade({.index = 1}));
  EXPECT_THAT(compare(good(), other).notes, Not(Contains(HasSubstr("equal"))));
}

TEST_F(BadInput, ValuesThatAreNoNumbersAreRefused) {
  ImageF broken = drawn_blade();
  broken(3, 4) = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT([&] { compare(write("broken.exr", broken), good()); },
              ThrowsMessage<ConfigError>(HasSubstr("no finite number")));
}

TEST_F(BadInput, AMaskOfAnotherSizeIsRefused) {
  const auto mask = write("mask.png", ImageF(50, 50, 1.0F));
  EXPECT_THAT([&] { compare(good(), good(), {.real_mask = mask}); },
              ThrowsMessage<ConfigError>(HasSubstr("mask")));
}

// A picture of a view was replaced by a smaller one, its mask and its geometry were not.
TEST_F(BadInput, AViewWhoseMaskHasAnotherSizeIsRefused) {
  const CompareSource view = {
      .name = "s", .picture = good(), .mask = write("part_mask.png", ImageF(50, 40, 1.0F))};
  const CompareSource real = {.name = "r", .picture = good()};
  EXPECT_THAT([&] { compare_pair({.simulated = view, .real = real}, {}); },
              ThrowsMessage<ConfigError>(
                  AllOf(HasSubstr("part_mask.png"), HasSubstr("50 x 40"), HasSubstr("200 x 160"))));
}

TEST_F(BadInput, AViewWhoseGeometryHasAnotherSizeIsRefused) {
  const auto geometry = folder() / "geometry.exr";
  const ImageF values(50, 40, 1.0F);
  std::vector<ExrChannel> channels;
  for (const char* name : {"depth_mm",
                           "normal.x",
                           "normal.y",
                           "normal.z",
                           "position_mm.x",
                           "position_mm.y",
                           "position_mm.z"}) {
    channels.push_back(exr_channel(name, values));
  }
  write_exr_channels(geometry, 50, 40, channels);
  ComparedPair pair = compare(good(), good());
  pair.simulated.source.geometry = geometry;
  pair.simulated.source.scene =
      std::string(GLINT_SOURCE_DIR) + "/studies/gallery/viewpoints/scene.toml";
  EXPECT_THAT([&] { find_causes(pair); },
              ThrowsMessage<ConfigError>(
                  AllOf(HasSubstr("geometry.exr"), HasSubstr("50 x 40"), HasSubstr("200 x 160"))));
}

TEST_F(BadInput, WhatWasChosenAndCannotBeDoneIsRefused) {
  ImageF noise(200, 160, 0.1F);
  add_normal_noise(noise, 0.01, 7);
  const auto real = write("noise.png", noise);
  EXPECT_THAT([&] { compare(good(), real, {.outline = OutlineChoice::kThreshold}); },
              ThrowsMessage<ConfigError>(HasSubstr("--outline threshold")));
  EXPECT_THROW(outline_choice("edges"), ConfigError);
}

}  // namespace
}  // namespace glint

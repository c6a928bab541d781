// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/material/texture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "core/rng.h"
#include "simulator/material/material_settings.h"
#include "tests/simulator/material/material_cases.h"

namespace glint {
namespace {

using ::testing::HasSubstr;
using ::testing::Throws;
using ::testing::ThrowsMessage;

constexpr std::array<double, 1> kGreyPicture_nm = {630};
constexpr std::array<double, 3> kColourPicture_nm = {630, 550, 450};

std::filesystem::path picture_file(const std::string& name, std::string_view bytes) {
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / "glint_texture";
  std::filesystem::create_directories(folder);
  write_file(folder / name, bytes);
  return folder / name;
}

/// 2 x 2 codes of 8 bits, top row first: 0 51 / 102 255.
std::filesystem::path four_greys() {
  return picture_file("four.pgm", "P2\n2 2\n255\n0 51\n102 255\n");
}

/// One pixel: red 255, green 128, blue 0.
std::filesystem::path orange() {
  return picture_file("orange.ppm", "P3\n1 1\n255\n255 128 0\n");
}

TEST(TexturePicture, DecodesSrgbOfEightBitsOnly) {
  // (51 / 255 + 0.055) / 1.055 = 0.241706; to the power of 2.4: 0.033105.
  const TexturePicture srgb = read_texture_picture(four_greys(), TextureEncoding::kAuto);
  EXPECT_NEAR(srgb(1, 0)[0], 0.033105F, 1e-5F);
  EXPECT_EQ(srgb(1, 1)[2], 1.0F);
  EXPECT_NEAR(read_texture_picture(four_greys(), TextureEncoding::kLinear)(1, 0)[1], 0.2F, 1e-6F);
  const auto deep = picture_file("deep.pgm", "P2\n1 1\n65535\n13107\n");
  EXPECT_NEAR(read_texture_picture(deep, TextureEncoding::kAuto)(0, 0)[0], 0.2F, 1e-6F);
  EXPECT_NEAR(read_texture_picture(deep, TextureEncoding::kSrgb)(0, 0)[0], 0.033105F, 1e-5F);
}

TEST(TexturePicture, ReadsOpenExrAsItIs) {
  ImageF image(2, 1, 0.25F);
  image(1, 0) = 0.75F;
  const auto path = picture_file("half.exr", "");
  write_exr(path, image);
  const TexturePicture read = read_texture_picture(path, TextureEncoding::kAuto);
  EXPECT_EQ(read(0, 0)[0], 0.25F);
  EXPECT_EQ(read(1, 0)[1], 0.75F);
}

TEST(TexturePicture, RefusesWhatIsNoFactor) {
  for (const float bad : {-0.1F, 1.5F, std::numeric_limits<float>::quiet_NaN()}) {
    const auto path = picture_file("bad.exr", "");
    write_exr(path, ImageF(1, 1, bad));
    EXPECT_THROW(read_texture_picture(path, TextureEncoding::kAuto), ConfigError) << bad;
  }
}

TEST(TexturePicture, NamesAFileThatIsMissingOrNoPicture) {
  EXPECT_THAT([] { read_texture_picture("absent.png", TextureEncoding::kAuto); },
              ThrowsMessage<IoError>(HasSubstr("absent.png")));
  const auto text = picture_file("text.png", "no picture");
  EXPECT_THAT([&] { read_texture_picture(text, TextureEncoding::kAuto); },
              ThrowsMessage<ConfigError>(HasSubstr("text.png: is no picture")));
}

// Centres of the 2 x 2 pixels lie at 0.25 and 0.75; linear values 0, 0.2, 0.4, 1.
TEST(Bilinear, MatchesHandWorkedNumbers) {
  const TexturePicture picture = read_texture_picture(four_greys(), TextureEncoding::kLinear);
  EXPECT_NEAR(bilinear(picture, {0.75, 0.25})[0], 0.2, 1e-7);
  EXPECT_NEAR(bilinear(picture, {0.25, 0.75})[0], 0.4, 1e-7);
  EXPECT_NEAR(bilinear(picture, {0.5, 0.5})[0], 0.4, 1e-7);      // mean of all: 1.6 / 4
  EXPECT_NEAR(bilinear(picture, {0.375, 0.25})[0], 0.05, 1e-7);  // a quarter of the way to 0.2
  // At the corner the four neighbours are all pixels of repeated pictures: the mean again.
  EXPECT_NEAR(bilinear(picture, {0.0, 0.0})[0], 0.4, 1e-7);
  EXPECT_NEAR(bilinear(picture, {1.0, 0.25})[0], 0.1, 1e-7);
}

TEST(Bilinear, RepeatsAndIsContinuous) {
  const TexturePicture picture = read_texture_picture(four_greys(), TextureEncoding::kLinear);
  Rng rng(1, Stream::kTest, 0);
  for (int i = 0; i < 2000; ++i) {
    const Eigen::Vector2d place(rng.uniform(-3, 3), rng.uniform(-3, 3));
    const double value = bilinear(picture, place)[0];
    ASSERT_NEAR(bilinear(picture, place + Eigen::Vector2d(4, -7))[0], value, 1e-6);
    // Steepest between 0.2 and 1: 0.8 in half a picture.
    ASSERT_NEAR(bilinear(picture, place + Eigen::Vector2d(1e-4, 0))[0], value, 1.7e-4);
    ASSERT_GE(value, 0.0);
    ASSERT_LE(value, 1.0);
  }
  for (const double edge : {-1.0, -1e-17, 0.0, 1.0, 1e5}) {
    EXPECT_NEAR(bilinear(picture, {edge, edge})[0], 0.4, 1e-4) << edge;
  }
}

TEST(TextureMapping, LaysAPictureUprightAcrossAnAxis) {
  const TextureSettings settings = {.center_mm = {10, 20, 30}, .size_mm = {4, 2}};
  const TextureMapping mapping(settings);
  EXPECT_TRUE(mapping.at({10, 20, 99}).isApprox(Eigen::Vector2d(0.5, 0.5)));
  // A quarter of the width to the right, half of the height up: the top edge.
  EXPECT_TRUE(mapping.at({11, 21, 0}).isApprox(Eigen::Vector2d(0.75, 0.0)));
}

TEST(TextureMapping, TurnsAboutTheAxis) {
  TextureSettings settings = {.rotation_rad = kPi / 2.0, .size_mm = {10}};
  // What lies along y is now to the right, what lies along -x is up.
  EXPECT_LT((TextureMapping(settings).at({-1, 2, 0}) - Eigen::Vector2d(0.7, 0.4)).norm(), 1e-12);
  settings.rotation_rad = 0.0;
  settings.axis = {0, -3, 0};  // seen from -y: x to the right, z up
  EXPECT_LT((TextureMapping(settings).at({1, 7, 2}) - Eigen::Vector2d(0.6, 0.3)).norm(), 1e-12);
}

TEST(TextureMapping, WindsAPictureAroundAnAxis) {
  const TextureSettings settings = {
      .mapping = TextureSettings::Mapping::kCylindrical, .size_mm = {99, 10}, .around = 4};
  const TextureMapping mapping(settings);
  // 45 degrees are an eighth of a turn: half a repeat. 2 mm up are a fifth of the height.
  EXPECT_LT((mapping.at({3, 3, 2}) - Eigen::Vector2d(1.0, 0.3)).norm(), 1e-12);
  EXPECT_LT((mapping.at({3, 0, 0}) - Eigen::Vector2d(0.5, 0.5)).norm(), 1e-12);
  // Either side of the seam at -x is the same place of a repeat.
  const Eigen::Vector2d above = mapping.at({-1, 1e-12, 0});
  const Eigen::Vector2d below = mapping.at({-1, -1e-12, 0});
  EXPECT_NEAR(above.x() - below.x(), 4.0, 1e-9);
}

TEST(TextureMapping, ShowsEveryFaceOfABoxFromOutside) {
  const TextureSettings settings = {
      .mapping = TextureSettings::Mapping::kBox, .size_mm = {10}, .box_mm = {2, 2, 1}};
  const TextureMapping mapping(settings);
  const auto place = [&](double x, double y, double z) { return mapping.at({x, y, z}); };
  EXPECT_LT((place(2, 1, 0.5) - Eigen::Vector2d(0.6, 0.45)).norm(), 1e-12);     // +x: y right
  EXPECT_LT((place(-2, 1, 0.5) - Eigen::Vector2d(0.4, 0.45)).norm(), 1e-12);    // -x: y left
  EXPECT_LT((place(1, 2, 0.5) - Eigen::Vector2d(0.4, 0.45)).norm(), 1e-12);     // +y: x left
  EXPECT_LT((place(1, -2, 0.5) - Eigen::Vector2d(0.6, 0.45)).norm(), 1e-12);    // -y: x right
  EXPECT_LT((place(1, 0.5, 1.2) - Eigen::Vector2d(0.6, 0.45)).norm(), 1e-12);   // top: x right
  EXPECT_LT((place(1, 0.5, -1.2) - Eigen::Vector2d(0.4, 0.45)).norm(), 1e-12);  // bottom: x left
}

TEST(Texture, GivesColoursToAColourCameraAndTheirMeanToAGreyOne) {
  const TextureSettings settings = {.colour_file = orange(), .encoding = TextureEncoding::kLinear};
  const double green = 128.0 / 255.0;
  EXPECT_LT((Texture(settings, false).at({1, 2, 3}).colour - Colour(1, green, 0)).abs().maxCoeff(),
            1e-6);
  EXPECT_LT((Texture(settings, true).at({1, 2, 3}).colour - (1 + green) / 3).abs().maxCoeff(),
            1e-6);
}

// Codes 0, 51, 102, 255 are shares 0, 0.2, 0.4, 1 of the way from 0.5 to 2.
TEST(Texture, VariesTheRoughnessBetweenTheFactorsOfBlackAndWhite) {
  const TextureSettings settings = {
      .roughness_file = four_greys(), .roughness_factor = {0.5, 2.0}, .size_mm = {4}};
  const Texture texture(settings, true);
  EXPECT_EQ(texture.roughness_factors().min, 0.5);
  EXPECT_EQ(texture.roughness_factors().max, 2.0);
  EXPECT_NEAR(texture.at({1, 1, 0}).roughness, 0.8, 1e-6);  // top right: 0.5 + 0.2 * 1.5
  EXPECT_TRUE((texture.at({1, 1, 0}).colour == 1.0).all());
}

TEST(SurfaceMaterial, MultipliesPatternAndTexture) {
  const MaterialSettings settings = {
      .type = MaterialSettings::Type::kConductor,
      .roughness = 0.4,
      .pattern = {.kind = PatternSettings::Kind::kConcentric, .density = 0.7, .roughness = 0.5},
      .texture = {.colour_file = orange(), .roughness_file = four_greys(), .size_mm = {2}}};
  const SurfaceMaterial material(settings, kColourPicture_nm);
  EXPECT_TRUE(material.has_pattern());
  // At (3, 4) the pattern is 0.1 and 1 + 0.5 (2/7 - 1) = 0.642857; the picture's middle, whose
  // roughness is 0.4 of the way from 0.5 to 1.5, repeats there: 3 / 2 + 0.5 and 0.5 - 4 / 2.
  const auto metal = std::get<Conductor>(material.at({3, 4, 0}));
  EXPECT_NEAR(metal.tint[0], 0.1, 1e-6);
  EXPECT_NEAR(metal.tint[1], 0.1 * linear_from_srgb(128), 1e-6);
  const double factor = 0.642857 * 0.9;
  EXPECT_NEAR(metal.alpha.x, 0.16 * factor * factor, 1e-6);
}

TEST(SurfaceMaterial, KnowsThatATextureVaries) {
  const SurfaceMaterial material(MaterialSettings{.texture = {.colour_file = four_greys()}},
                                 kGreyPicture_nm);
  EXPECT_TRUE(material.has_pattern());
  EXPECT_FALSE(SurfaceMaterial(MaterialSettings{}, kGreyPicture_nm).has_pattern());
}

// The conformance suite's demands, of materials as a picture of roughness makes them: all light
// returns from white metal, and both directions may be exchanged.
TEST(SurfaceMaterial, ConformsAtEveryPointOfATexture) {
  const MaterialSettings settings = {
      .type = MaterialSettings::Type::kConductor,
      .roughness = 0.5,
      .texture = {.roughness_file = four_greys(), .roughness_factor = {0.4, 1.8}}};
  const SurfaceMaterial material(settings, kGreyPicture_nm);
  Rng rng(3, Stream::kTest, 0);
  for (int i = 0; i < 8; ++i) {
    const Material here = material.at({rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(-9, 9)});
    const LocalDirection viewer = material_cases::random_direction(rng);
    EXPECT_NEAR(material_cases::albedo(here, viewer, 40'000)[0], 1.0, 0.002);
    for (int k = 0; k < 200; ++k) {
      const LocalDirection a = material_cases::random_direction(rng);
      const LocalDirection b = material_cases::random_direction(rng);
      const double forth = evaluate(here, a, b).value[0] / b.z;
      ASSERT_NEAR(forth, evaluate(here, b, a).value[0] / a.z, 1e-9 * forth);
    }
  }
}

TEST(SurfaceMaterial, RefusesATextureThatIsMissing) {
  EXPECT_THAT(
      [] {
        SurfaceMaterial(MaterialSettings{.texture = {.colour_file = "absent.png"}},
                        kGreyPicture_nm);
      },
      Throws<IoError>());
}

TEST(TextureSettings, AreReadWithTheirUnits) {
  const auto path = four_greys();
  const ConfigNode root =
      parse_toml("[texture]\ncolour_file = \"" + path.string() +
                     "\"\nmapping = \"cylindrical\"\nrotation_deg = 90\nsize_mm = [5, 6]\n",
                 "");
  std::vector<Problem> errors;
  KeyReader reader(root.find("texture"), "texture", errors);
  TextureSettings settings;
  visit_keys(reader, settings);
  reader.report_unknown();
  EXPECT_THAT(errors, ::testing::IsEmpty());
  EXPECT_EQ(settings.mapping, TextureSettings::Mapping::kCylindrical);
  EXPECT_NEAR(settings.rotation_rad, kPi / 2.0, 1e-12);
  EXPECT_EQ(settings.size_mm[1], 6.0);
}

TEST(TextureSettings, RefuseAnAxisWithoutALength) {
  const ConfigNode root = parse_toml("[texture]\naxis = [0, 0, 0]\n", "");
  std::vector<Problem> errors;
  KeyReader reader(root.find("texture"), "texture", errors);
  TextureSettings settings;
  visit_keys(reader, settings);
  EXPECT_THAT(messages_of(errors), ::testing::ElementsAre(HasSubstr("must have a length")));
}

}  // namespace
}  // namespace glint

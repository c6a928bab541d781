// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/material/material_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/key_digest.h"
#include "core/config/key_writer.h"
#include "core/config/toml.h"
#include "core/error.h"
#include "core/file.h"
#include "tests/simulator/material/material_cases.h"

namespace glint {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::array<double, 1> kRed_nm = {630};
constexpr std::array<double, 3> kRgb_nm = {630, 550, 450};

std::vector<std::string> read_material(std::string_view text, MaterialSettings* read = nullptr) {
  const ConfigNode root = parse_toml(text, "scene.toml");
  std::vector<Problem> errors;
  KeyReader reader(root.find("material"), "material", errors);
  MaterialSettings settings;
  visit_keys(reader, settings);
  reader.report_unknown();
  if (read != nullptr) {
    *read = settings;
  }
  return messages_of(errors);
}

SurfaceMaterial material_of(std::string_view text,
                            std::span<const double> wavelengths_nm = kRgb_nm) {
  MaterialSettings settings;
  EXPECT_THAT(read_material(text, &settings), IsEmpty());
  return {settings, wavelengths_nm};
}

constexpr std::string_view kSeedMetal = R"([material]
type = "conductor"
colour_srgb = [196, 199, 199]
roughness = 0.25
anisotropy = 0.7
[material.lay]
kind = "turned"
[material.pattern]
kind = "concentric"
density = 0.5
)";

TEST(MaterialSettings, ExpressTheSecondSeedsMetal) {
  const SurfaceMaterial material = material_of(kSeedMetal);
  const auto& metal = std::get<Conductor>(material.plain());
  EXPECT_NEAR(metal.alpha.x, 0.102749, 1e-6);
  EXPECT_NEAR(metal.alpha.y, 0.038017, 1e-6);
  EXPECT_NEAR(metal.fresnel.normal[0], 0.5520, 1e-4);
  EXPECT_NEAR(metal.fresnel.normal[1], 0.5711, 1e-4);
  EXPECT_EQ(metal.fresnel.kind, Fresnel::Kind::kSchlick);
  // v(3, 4) = 5 mod 0.5 = 0, v(3, 4.4): see the pattern's own tests.
  EXPECT_NEAR(std::get<Conductor>(material.at({3, 4, 9})).tint[2], 0.0, 1e-12);
  const ShadingFrame frame = material.frame_at({3, 4, 9}, {0, 0, 1});
  EXPECT_LT((frame.tangent - Eigen::Vector3d(-0.8, 0.6, 0)).norm(), 1e-12);
}

TEST(MaterialSettings, AreAPerfectMirrorByDefault) {
  const SurfaceMaterial material(MaterialSettings{}, kRed_nm);
  const auto light = sample(material.plain(), {0.6, 0.0, 0.8}, {0.1, 0.2, 0.3});
  ASSERT_TRUE(light.has_value());
  EXPECT_TRUE(light->is_mirror);
  EXPECT_EQ(light->weight[0], 1.0);
  EXPECT_EQ(light->to_light.x, -0.6);
}

TEST(MaterialSettings, MakeAMirrorOfMetalWithoutRoughness) {
  const SurfaceMaterial material =
      material_of("[material]\ntype = \"conductor\"\nroughness = 0\nreflectance = [0.5]\n");
  EXPECT_TRUE(std::holds_alternative<Mirror>(material.plain()));
}

TEST(MaterialSettings, TakeOneWavelengthOrThree) {
  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) / "glint_material";
  std::filesystem::create_directories(folder);
  write_file(folder / "m.csv", "wl,n,k\n0.4,1,2\n0.7,4,2\n");
  MaterialSettings settings = {.type = MaterialSettings::Type::kConductor,
                               .nk_file = folder / "m.csv"};
  // n rises by 1 in 100 nm: 3.3 at 630, 2.5 at 550, 1.5 at 450.
  const SurfaceMaterial colour(settings, kRgb_nm);
  const Fresnel& fresnel = std::get<Conductor>(colour.plain()).fresnel;
  EXPECT_NEAR(fresnel.n[0], 3.3, 1e-12);
  EXPECT_NEAR(fresnel.n[2], 1.5, 1e-12);
  EXPECT_NEAR(fresnel.normal[1], (1.5 * 1.5 + 4.0) / (3.5 * 3.5 + 4.0), 1e-12);
  const SurfaceMaterial grey(settings, kRed_nm);
  EXPECT_NEAR(std::get<Conductor>(grey.plain()).fresnel.n[2], 3.3, 1e-12);
  const std::array<double, 1> infrared_nm = {850};
  EXPECT_THROW(SurfaceMaterial(settings, infrared_nm), ConfigError);
  settings.nk_file = folder / "absent.csv";
  EXPECT_THROW(SurfaceMaterial(settings, kRed_nm), IoError);
}

TEST(MaterialSettings, MakeACoatOverAnyBase) {
  for (const char* type : {"mirror", "conductor", "diffuse"}) {
    const SurfaceMaterial material =
        material_of(std::string("[material]\ntype = \"") + type + "\"\ncoat = { index = 1.5 }\n");
    EXPECT_TRUE(std::holds_alternative<Coated>(material.plain())) << type;
  }
}

// Points of a pattern in roughness keep all the light of a white metal.
TEST(SurfaceMaterial, KeepsAllLightAtEveryPointOfAPattern) {
  const SurfaceMaterial material = material_of(R"([material]
type = "conductor"
roughness = 0.5
pattern = { kind = "concentric", roughness = 0.5, colour = 0 }
)");
  Rng rng(1, Stream::kTest, 0);
  for (int i = 0; i < 6; ++i) {
    const Material here = material.at({rng.uniform(-9, 9), rng.uniform(-9, 9), 0});
    const LocalDirection to_viewer = material_cases::random_direction(rng);
    EXPECT_NEAR(material_cases::albedo(here, to_viewer, 40'000)[0], 1.0, 0.002);
  }
}

TEST(MaterialSettings, RefuseWhatContradictsItself) {
  EXPECT_THAT(read_material("[material]\nreflectance = [0.5]\ncolour_srgb = [1, 2, 3]"),
              ElementsAre(HasSubstr("scene.toml:3:")));
  EXPECT_THAT(read_material("[material]\nalpha = [0.1]\nroughness = 0.3"),
              ElementsAre(HasSubstr("give one of the two")));
  EXPECT_THAT(read_material("[material]\nreflectance = [0.5, 0.5]"),
              ElementsAre(HasSubstr("must have 1 or 3")));
  EXPECT_THAT(read_material("[material]\nreflectance = [1.5]"), ElementsAre(HasSubstr("[0, 1]")));
  EXPECT_THAT(read_material("[material]\nroughnes = 0.5"), ElementsAre(HasSubstr("roughness")));
  EXPECT_THAT(read_material("[material.lay]\ndirection = [0, 0, 2]"),
              ElementsAre(HasSubstr("must lie across it")));
  EXPECT_THAT(read_material("[material.lay]\nlane_mm = 90"),
              ElementsAre(HasSubstr("at most 2 mill_radius_mm")));
  EXPECT_THAT(read_material("[material.pattern]\nkind = \"concentric\"\ndensity = 2"),
              ElementsAre(HasSubstr("scaled = true")));
  EXPECT_THAT(read_material("[material]\nnk_file = \"absent.yml\""),
              ElementsAre(HasSubstr("does not exist")));
}

TEST(MaterialSettings, AreWrittenAsTheyWereRead) {
  MaterialSettings settings;
  ASSERT_THAT(read_material(kSeedMetal, &settings), IsEmpty());
  ConfigNode root = ConfigNode::table();
  ConfigNode table = ConfigNode::table();
  KeyWriter writer(table);
  visit_keys(writer, settings);
  set_path(root, "material", table);
  MaterialSettings again;
  // The resolved file holds both of reflectance and colour_srgb, roughness and alpha.
  EXPECT_THAT(read_material(to_toml(root), &again), IsEmpty());
  std::string first;
  std::string second;
  KeyDigest digest_first(first);
  KeyDigest digest_second(second);
  visit_keys(digest_first, settings);
  visit_keys(digest_second, again);
  EXPECT_EQ(first, second);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What every material must do, over all of material_cases.h. How samples follow their density is in
// chi_square_test.cpp.
#include <gtest/gtest.h>

#include "tests/simulator/material/material_cases.h"

namespace glint {
namespace {

using material_cases::albedo;
using material_cases::Case;
using material_cases::coloured_cases;
using material_cases::direction_at;
using material_cases::random_direction;
using material_cases::white_cases;

constexpr std::array<double, 6> kCosines = {1.0, 0.8, 0.5, 0.2, 0.05, 0.01};

double furnace_error(const Case& c) {
  constexpr int kSamples = 60'000;
  double worst = 0.0;
  for (std::size_t i = 0; i < kCosines.size(); ++i) {
    const LocalDirection to_viewer = direction_at(kCosines[i], 0.4 * static_cast<double>(i));
    const Colour returned = albedo(c.material, to_viewer, kSamples);
    worst = std::max(worst, (returned - 1.0).abs().maxCoeff());
  }
  return worst;
}

// In a white furnace a surface that absorbs nothing cannot be seen.
TEST(Material, ReturnsAllLightInAWhiteFurnace) {
  for (const Case& c : white_cases()) {
    EXPECT_LT(furnace_error(c), c.is_isotropic ? 0.001 : 0.005) << c.name;
  }
}

// The negative control: without the light between microfacets 0.4 of it is missing at alpha 0.6 to
// a viewer straight above.
TEST(Material, LosesLightWithoutSeveralReflections) {
  EXPECT_GT(furnace_error({.name = "single", .material = Conductor{.alpha = {0.6, 0.6}}}), 0.2);
}

TEST(Material, NeverReturnsMoreThanItReceives) {
  constexpr int kSamples = 2000;
  Rng rng(1, Stream::kTest, 0);
  for (const Case& c : coloured_cases()) {
    for (int i = 0; i < 60; ++i) {
      const LocalDirection to_viewer = random_direction(rng);
      EXPECT_LT(albedo(c.material, to_viewer, kSamples).maxCoeff(), 1.0)
          << c.name << " at cosine " << to_viewer.z;
    }
  }
}

TEST(Material, IsReciprocal) {
  Rng rng(2, Stream::kTest, 0);
  for (const Case& c : coloured_cases()) {
    for (int i = 0; i < 1000; ++i) {
      const LocalDirection a = random_direction(rng);
      const LocalDirection b = random_direction(rng);
      const Colour forth = evaluate(c.material, a, b).value / b.z;
      const Colour back = evaluate(c.material, b, a).value / a.z;
      ASSERT_LE((forth - back).abs().maxCoeff(), 1e-9 * forth.maxCoeff()) << c.name;
    }
  }
}

TEST(Material, IsMirrorSymmetricAcrossItsTangent) {
  Rng rng(3, Stream::kTest, 0);
  for (const Case& c : coloured_cases()) {
    for (int i = 0; i < 200; ++i) {
      const LocalDirection a = random_direction(rng);
      const LocalDirection b = random_direction(rng);
      const Colour value = evaluate(c.material, a, b).value;
      const Colour other = evaluate(c.material, {a.x, -a.y, a.z}, {b.x, -b.y, b.z}).value;
      ASSERT_LE((value - other).abs().maxCoeff(), 1e-9 * value.maxCoeff()) << c.name;
    }
  }
}

TEST(Material, SamplesWhatItEvaluates) {
  Rng rng(4, Stream::kTest, 0);
  for (const Case& c : coloured_cases()) {
    for (int i = 0; i < 1000; ++i) {
      const LocalDirection to_viewer = random_direction(rng);
      const auto light =
          sample(c.material, to_viewer, {rng.uniform(), rng.uniform(), rng.uniform()});
      if (!light || light->is_mirror) {
        continue;
      }
      ASSERT_NEAR(dot(light->to_light, light->to_light), 1.0, 1e-9) << c.name;
      const Reflection r = evaluate(c.material, to_viewer, light->to_light);
      ASSERT_NEAR(r.density, light->density, 1e-9 * r.density) << c.name;
      const Colour value = light->weight * light->density;
      ASSERT_LE((value - r.value).abs().maxCoeff(), 1e-9 * r.value.maxCoeff()) << c.name;
    }
  }
}

TEST(Material, IsBlackFromBehindAndForLightFromBehind) {
  Rng rng(5, Stream::kTest, 0);
  for (const Case& c : coloured_cases()) {
    const LocalDirection above = random_direction(rng);
    const LocalDirection below = {above.x, above.y, -above.z};
    EXPECT_EQ(evaluate(c.material, above, below).value.maxCoeff(), 0.0) << c.name;
    EXPECT_EQ(evaluate(c.material, below, above).density, 0.0) << c.name;
    EXPECT_FALSE(sample(c.material, below, {0.3, 0.4, 0.5}).has_value()) << c.name;
  }
}

bool is_sound(const Colour& value) {
  return value.isFinite().all() && value.minCoeff() >= 0.0;
}

std::vector<Case> cases_at_their_limits() {
  std::vector<Case> cases = coloured_cases();
  for (const double x : {kMinAlpha, 1.0, 3.16}) {
    for (const double y : {kMinAlpha, 1.0, 3.16}) {
      cases.push_back({.name = "bare conductor", .material = Conductor{.alpha = {x, y}}});
    }
  }
  return cases;
}

TEST(Material, StaysFiniteAtGrazingAndAtTheEndsOfItsRange) {
  constexpr double kLast = 1.0 - 0x1p-53;
  const std::array<double, 5> numbers = {0.0, 0x1p-53, 0.5, 1.0 - 1e-9, kLast};
  for (const Case& c : cases_at_their_limits()) {
    for (const double cosine : {1.0, 1.0 - 1e-12, 0.3, 1e-3, 1e-6, 1e-11, 1e-300, 0.0}) {
      for (const double phi_rad : {0.0, 0.7, kPi}) {
        const LocalDirection a = direction_at(cosine, phi_rad);
        for (const double other : {1.0, 1e-3, 1e-9, 1e-300}) {
          const Reflection r = evaluate(c.material, a, direction_at(other, 0.0));
          ASSERT_TRUE(is_sound(r.value)) << c.name << " " << cosine << " " << other;
          ASSERT_TRUE(std::isfinite(r.density) && r.density >= 0.0) << c.name;
        }
        for (const double u : numbers) {
          for (const double v : numbers) {
            const auto light = sample(c.material, a, {u, v, v});
            ASSERT_TRUE(!light || is_sound(light->weight)) << c.name << " " << cosine << " " << u;
          }
        }
      }
    }
  }
}

// Widths of 1e-4 blur by some tenth of a milliradian, and what comes back is the mirror's share.
TEST(Conductor, BecomesAMirrorAsItsWidthVanishes) {
  const Fresnel nickel = conductor_fresnel({1.70, 1.92, 1.99}, {2.94, 3.61, 4.08});
  const GgxAlbedo table({kMinAlpha, kMinAlpha});
  const Conductor metal = {.alpha = table.lowest(), .fresnel = nickel, .albedo = &table};
  for (const double cosine : {1.0, 0.7, 0.3, 0.1}) {
    const LocalDirection to_viewer = direction_at(cosine, 1.0);
    const auto mirrored = sample(Mirror{.fresnel = nickel}, to_viewer, {0.5, 0.5, 0.5});
    const Colour returned = albedo(metal, to_viewer, 20'000);
    EXPECT_LT((returned - mirrored->weight).abs().maxCoeff(), 0.001) << cosine;
    const auto light = sample(metal, to_viewer, {0.3, 0.5, 0.99});
    EXPECT_NEAR(light->to_light.x, mirrored->to_light.x, 5e-4);
    EXPECT_NEAR(light->to_light.y, mirrored->to_light.y, 5e-4);
    EXPECT_NEAR(light->to_light.z, mirrored->to_light.z, 5e-4);
  }
}

// The table serves all widths between its ends: half way in the logarithm of 4, at alpha 0.3.
TEST(Conductor, KeepsAllLightWhereATextureChangesItsRoughness) {
  const GgxAlbedo table({0.1, 0.1}, 16.0);
  const Conductor metal = {.alpha = {0.4, 0.4}, .albedo = &table, .albedo_scale = 4.0};
  for (const double roughness : {0.6, 0.87, 1.0, 1.3, 1.9}) {
    const Case c = {.name = "textured",
                    .material = textured(Material(metal), {.roughness = roughness})};
    EXPECT_LT(furnace_error(c), 0.002) << roughness;
  }
}

TEST(Material, IsDarkenedByATexture) {
  const LocalDirection a = direction_at(0.6, 0.2);
  const LocalDirection b = direction_at(0.7, 2.5);
  for (const Case& c : coloured_cases()) {
    const Colour plain = evaluate(c.material, a, b).value;
    const Colour dark =
        evaluate(textured(c.material, {.colour = Colour::Constant(0.25)}), a, b).value;
    EXPECT_LE(dark.maxCoeff(), plain.maxCoeff()) << c.name;
    if (!std::holds_alternative<Coated>(c.material)) {
      EXPECT_LE((dark - 0.25 * plain).abs().maxCoeff(), 1e-12 * plain.maxCoeff()) << c.name;
    }
  }
}

// A smooth metal loses light at grazing only; what is added back must not come in rare bright
// specks.
TEST(Conductor, SpreadsCompensatedLightWithoutSpecks) {
  const GgxAlbedo table({0.002, 0.002});
  const Conductor metal = {.alpha = table.lowest(), .albedo = &table};
  Rng rng(6, Stream::kTest, 0);
  for (int i = 0; i < 20'000; ++i) {
    const LocalDirection to_viewer = direction_at(0.003, 0.0);
    const auto light = sample(metal, to_viewer, {rng.uniform(), rng.uniform(), rng.uniform()});
    ASSERT_TRUE(!light || light->weight[0] < 10.0) << light->to_light.z;
  }
}

// Straight down through index 1.5: 0.04 at the face; of the 0.96 inside the mirror returns 0.5.
TEST(Coated, MatchesAHandWorkedMirrorUnderLacquer) {
  const Coat coat = {.index = 1.5, .transmittance = Colour::Constant(0.5)};
  const CoatTables tables(coat, Mirror{});
  const Coated coated = {.coat = coat, .base = Mirror{}, .tables = &tables};
  // 0.04 + 0.96 * 0.5 = 0.52.
  EXPECT_NEAR(albedo(coated, {0, 0, 1}, 20'000)[0], 0.52, 1e-3);
}

TEST(RoughDiffuse, IsLambertsAtRoughnessZero) {
  const RoughDiffuse matt = {.colour = {0.5, 0.25, 1.0}};
  const Reflection r = evaluate(matt, direction_at(0.4, 1.0), direction_at(0.8, 2.0));
  EXPECT_NEAR(r.value[0], 0.5 * 0.8 / kPi, 1e-12);
  EXPECT_NEAR(r.value[1], 0.25 * 0.8 / kPi, 1e-12);
  EXPECT_NEAR(r.density, 0.8 / kPi, 1e-12);
}

// Matt surfaces return more of a grazing light to where it comes from.
TEST(RoughDiffuse, ShinesBackTowardsTheLight) {
  const RoughDiffuse matt = {.roughness = 1.0};
  const LocalDirection viewer = direction_at(0.3, 0.0);
  EXPECT_GT(evaluate(matt, viewer, direction_at(0.3, 0.0)).value[0],
            1.5 * evaluate(matt, viewer, direction_at(0.3, kPi)).value[0]);
}

}  // namespace
}  // namespace glint

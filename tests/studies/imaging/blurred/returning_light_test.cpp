// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/blurred/returning_light.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "studies/imaging/scene_store.h"
#include "tests/studies/imaging/blurred/satin_scene.h"

namespace glint::satin_test {
namespace {

using ::testing::HasSubstr;

std::string refusal_of(const SceneSettings& scene) {
  ThreadPool pool(2);
  SceneStore store(pool);
  try {
    store.trace(scene);
    return "";
  } catch (const ConfigError& error) {
    return error.what();
  }
}

TEST(ReturningLight, OfAConvexPartThereIsNone) {
  EXPECT_EQ(refusal_of(satin_scene()), "") << "the strip's concave back is not seen";
  SceneSettings cylinder = satin_scene();
  cylinder.part = {.shape = PartSettings::Shape::kCylinder, .length_mm = 40.0, .radius_mm = 9.0};
  EXPECT_EQ(refusal_of(cylinder), "");
}

TEST(ReturningLight, OfADeepBowlIsRefused) {
  SceneSettings bowl = satin_scene();
  bowl.defects.clear();
  bowl.part.radius_across_mm = -10.0;
  EXPECT_THAT(
      refusal_of(bowl),
      AllOf(HasSubstr("part: "), HasSubstr("meets the part again"), HasSubstr("\"paths\"")));
  bowl.render.method = RenderSettings::Method::kPaths;
  EXPECT_EQ(refusal_of(bowl), "") << "paths follow it";
}

TEST(ReturningLight, OfAGearIsRefused) {
  SceneSettings gear = satin_scene();
  gear.defects.clear();
  gear.part = {.shape = PartSettings::Shape::kSpurGear};
  EXPECT_THAT(refusal_of(gear), HasSubstr("part: "));
}

TEST(ReturningLight, OfASteepDentIsRefusedAndOfAShallowOneNot) {
  SceneSettings dented = satin_scene();
  DefectGroup& dent = dented.defects.front().second;
  dent.realisation = Realisation::kDisplaced;
  EXPECT_EQ(refusal_of(dented), "");
  dent.height_mm = 2.0;
  EXPECT_THAT(refusal_of(dented), HasSubstr("meets the part again"));
}

}  // namespace
}  // namespace glint::satin_test

// SPDX-License-Identifier: GPL-3.0-or-later
//
// An inspection line whose parts are rendered by the sum of direct light.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "studies/imaging/line_camera.h"
#include "studies/imaging/scene_picture.h"
#include "tests/studies/imaging/direct/lamp_scene.h"

namespace glint::lamp_test {
namespace {

double largest_difference(const ImageF& a, const ImageF& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, std::abs(static_cast<double>(a.values()[i] - b.values()[i])));
  }
  return largest;
}

TEST(DirectLine, ShowsThePictureThatIsScored) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings scene = lamp_scene(kRing);
  SceneSettings flawless = scene;
  flawless.defects.clear();
  const auto line = line_camera_of(store, scene, store.trace(flawless));
  const LineScan part = line->part(*store.build_defects(scene), scene.sensor);
  const ImageF scored = picture_of(store, scene)->mean({}).aspect;
  // Around the dent's window light is interpolated otherwise, by up to 1e-3 of full scale.
  EXPECT_LT(largest_difference(part.aspect, scored), 1e-3);
  EXPECT_GT(largest_difference(line->flawless(scene.sensor).aspect, scored), 0.01) << "the dent";
}

TEST(DirectLine, HasNoNoiseOfRendering) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const SceneSettings scene = lamp_scene(kRing);
  SceneSettings flawless = scene;
  flawless.defects.clear();
  const auto line = line_camera_of(store, scene, store.trace(flawless));
  EXPECT_TRUE(line->expected().renderings.empty());
  EXPECT_TRUE(line->part(*store.build_defects(scene), scene.sensor).changes.empty());
  EXPECT_LT(largest_difference(line->expected().aspect, line->flawless(scene.sensor).aspect), 1e-6)
      << "a sensor without noise";
}

}  // namespace
}  // namespace glint::lamp_test

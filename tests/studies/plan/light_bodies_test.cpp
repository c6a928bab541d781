// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/reach/light_bodies.h"

#include <algorithm>
#include <iterator>

#include <gmock/gmock.h>

#include "tests/studies/scene_from.h"

namespace glint {
namespace {

// A flat ring 80 mm before the pinhole, between 30 and 60 mm from its axis.
TEST(LightBodies, OfARingOnTheCameraAreInItsFrame) {
  const std::vector<SolidBody> bodies = light_bodies(
      test::scene_from(
          "schema = 1\n[part]\nshape = \"plate\"\n[lighting.ring]\nmount = \"camera\"\n"
          "inner_radius_mm = 30\nouter_radius_mm = 60\nheight_mm = 80\n"),
      2.0);
  ASSERT_EQ(bodies.size(), 1U);
  EXPECT_EQ(bodies[0].kind, SolidBody::Kind::kCarried);
  EXPECT_EQ(bodies[0].name, "ring light");
  EXPECT_EQ(bodies[0].radius_mm, 2.0);
  const BoundingBox box = bounding_box(bodies[0].mesh);
  EXPECT_NEAR(box.max_mm.x(), 60.0, 0.2);
  EXPECT_NEAR(box.min_mm.z(), 80.0, 1e-9);
  EXPECT_NEAR(box.max_mm.z(), 80.0, 1e-9);
  EXPECT_NEAR(surface_area_mm2(bodies[0].mesh), kPi * (3600.0 - 900.0), 40.0);
}

TEST(LightBodies, OfADomeStandInTheScene) {
  const std::vector<SolidBody> bodies = light_bodies(
      test::scene_from(
          "schema = 1\n[part]\nshape = \"plate\"\n[lighting.dome]\ntype = \"dome\"\n"
          "radius_mm = 100\nopening_mm = 30\n[lighting.sky]\ntype = \"environment\"\n"),
      1.0);
  ASSERT_EQ(bodies.size(), 1U) << "an environment is no body";
  EXPECT_EQ(bodies[0].kind, SolidBody::Kind::kStanding);
  for (const Eigen::Vector3d& vertex_mm : bodies[0].mesh.vertices_mm) {
    EXPECT_NEAR(vertex_mm.norm(), 100.0, 1e-9);
  }
}

TEST(LightBodies, OfATunnelAreItsWall) {
  const std::vector<SolidBody> bodies = light_bodies(
      test::scene_from("schema = 1\n[part]\nshape = \"plate\"\n[lighting.tunnel]\n"), 1.0);
  ASSERT_EQ(bodies.size(), 1U);
  EXPECT_GT(bodies[0].mesh.num_triangles(), 4U);
}

/// A ring, a dome and a tunnel of which those shine that are used.
std::vector<std::string> names_of_bodies(const std::string& use) {
  const SceneSettings scene =
      test::scene_from("schema = 1\nlighting_use = \"" + use +
                       "\"\n[part]\nshape = \"plate\"\n[lighting.ring]\nmount = \"camera\"\n"
                       "[lighting.dome]\nradius_mm = 100\nopening_mm = 30\n"
                       "[lighting.tunnel]\nled_ripple = 0.1\norientation_deg = 90\n");
  std::vector<std::string> names;
  std::ranges::transform(light_bodies(scene, 1.0), std::back_inserter(names), &SolidBody::name);
  return names;
}

// An arm that comes near a dome runs into it whether or not the dome shines.
TEST(LightBodies, AreThoseOfLightsThatDoNotShineToo) {
  using testing::UnorderedElementsAre;
  EXPECT_THAT(names_of_bodies("ring"), UnorderedElementsAre("ring light", "dome light", "tunnel"));
  EXPECT_THAT(names_of_bodies("dome"), UnorderedElementsAre("ring light", "dome light", "tunnel"));
}

}  // namespace
}  // namespace glint

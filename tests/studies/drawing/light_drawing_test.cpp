// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/light_drawing.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/units.h"
#include "studies/drawing/light_section.h"
#include "studies/imaging/path_picture.h"
#include "studies/imaging/scene_store.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using ::testing::HasSubstr;

/// A plate 100 mm below the camera, which looks down.
SceneSettings lit_plate(std::vector<NamedLight> lights) {
  SceneSettings scene;
  scene.part.shape = PartSettings::Shape::kPlate;
  scene.part.length_mm = 16.0;
  scene.part.width_mm = 12.0;
  scene.camera.width_px = 40;
  scene.camera.height_px = 30;
  scene.camera.working_distance_mm = 100.0;
  scene.viewpoint() = default_viewpoint(scene.camera);
  scene.has_tunnel = false;
  scene.lights = std::move(lights);
  return scene;
}

struct DrawnScene {
  explicit DrawnScene(const SceneSettings& the_scene)
      : scene(the_scene),
        pool(1),
        store(pool),
        view(scene, store.build_defects(scene), scene.viewpoint()) {}

  SceneSettings scene;
  ThreadPool pool;
  SceneStore store;
  PathView view;
};

TEST(LightLines, CutATiltedRingTwice) {
  RingSettings ring;
  ring.placement.mount = LightPlacement::Mount::kCamera;
  ring.inner_radius_mm = 20.0;
  ring.outer_radius_mm = 40.0;
  ring.tilt_rad = 30.0 * kRadPerDeg;
  const DrawnScene drawn(lit_plate({{.name = "ring", .settings = ring}}));
  const DrawingPlane plane = drawing_plane(drawn.view.physical());
  EXPECT_EQ(plane.across_name, "y");
  const LightLines lines = light_lines_in(drawn.view.physical(), plane);
  ASSERT_EQ(lines.cut.size(), 2U);
  EXPECT_TRUE(lines.seen.empty());
  for (const PlaneLine& cut : lines.cut) {
    ASSERT_EQ(cut.size(), 2U);
    // The middle is 30 mm from the axis; half the width, 10 mm, goes 10 cos 30 = 8.66 mm outwards
    // and 10 sin 30 = 5 mm down, so that the front shines inwards.
    EXPECT_NEAR(std::abs(cut[0].x()), 21.34, 0.005);
    EXPECT_NEAR(cut[0].y(), 105.0, 1e-9);
    EXPECT_NEAR(std::abs(cut[1].x()), 38.66, 0.005);
    EXPECT_NEAR(cut[1].y(), 95.0, 1e-9);
  }
  EXPECT_LT(lines.cut[0][0].x() * lines.cut[1][0].x(), 0.0) << "one on each side";
}

TEST(LightLines, CutOfADomeIsAnArcFromItsOpeningToItsRim) {
  DomeSettings dome;
  dome.radius_mm = 50.0;
  dome.opening_mm = 60.0;
  const DrawnScene drawn(lit_plate({{.name = "dome", .settings = dome}}));
  const LightLines lines =
      light_lines_in(drawn.view.physical(), drawing_plane(drawn.view.physical()));
  ASSERT_EQ(lines.cut.size(), 2U);
  for (const PlaneLine& arc : lines.cut) {
    // An opening of radius 30 in a sphere of 50 lies at a height of 40.
    EXPECT_NEAR(std::abs(arc.front().x()), 30.0, 1e-6);
    EXPECT_NEAR(arc.front().y(), 40.0, 1e-6);
    EXPECT_NEAR(std::abs(arc.back().x()), 50.0, 1e-6);
    EXPECT_NEAR(arc.back().y(), 0.0, 1e-6);
    for (const Vector2d& point : arc) {
      EXPECT_NEAR(point.norm(), 50.0, 1e-6);
    }
  }
}

TEST(DrawingPlane, ShowsABarThatStandsAside) {
  BarSettings bar;
  bar.placement.position_mm = {80.0, 0.0, 40.0};
  bar.placement.direction = {-1.0, 0.0, 0.0};
  const DrawnScene drawn(lit_plate({{.name = "bar", .settings = bar}}));
  const DrawingPlane plane = drawing_plane(drawn.view.physical());
  EXPECT_EQ(plane.across_name, "x");
  const LightLines lines = light_lines_in(drawn.view.physical(), plane);
  ASSERT_EQ(lines.seen.size(), 1U);
  for (const Vector2d& corner : lines.seen[0]) {
    EXPECT_NEAR(corner.x(), 80.0, 1e-9);
  }
}

// A bar 40 mm above a plate that is lowered by 20 mm.
TEST(LightLines, AreDrawnWhereThePoseTakesALightOnThePart) {
  BarSettings bar;
  bar.placement.position_mm = {0.0, 30.0, 40.0};
  const auto lowest_mm = [&](LightPlacement::Mount mount) {
    bar.placement.mount = mount;
    SceneSettings scene = lit_plate({{.name = "bar", .settings = bar}});
    scene.part.position_mm = {0.0, 0.0, -20.0};
    const DrawnScene drawn(scene);
    const LightLines lines =
        light_lines_in(drawn.view.physical(), drawing_plane(drawn.view.physical()));
    return lines.seen.at(0)[0].y();
  };
  EXPECT_NEAR(lowest_mm(LightPlacement::Mount::kPart), 20.0, 1e-9);
  EXPECT_NEAR(lowest_mm(LightPlacement::Mount::kScene), 40.0, 1e-9);
}

TEST(PartOutline, HoldsTheWholePart) {
  const DrawnScene drawn(lit_plate({{.name = "ring", .settings = RingSettings{}}}));
  const DrawingPlane plane = drawing_plane(drawn.view.physical());
  double widest = 0.0;
  for (const Vector2d& point : part_outline(drawn.view.physical().part.mesh, plane)) {
    widest = std::max(widest, std::abs(point.x()));
  }
  EXPECT_NEAR(widest, 6.0, 1e-6);
}

TEST(AreaLightsSvg, NamesLightsAndCamera) {
  RingSettings ring;
  ring.placement.mount = LightPlacement::Mount::kCamera;
  ring.tilt_rad = 0.5;
  const DrawnScene drawn(lit_plate({{.name = "upper", .settings = ring}}));
  const std::string svg = area_lights_svg(drawn.scene, drawn.view.physical(), "Plate & ring");
  EXPECT_THAT(svg, HasSubstr("upper: ring, radii 25 to 40 mm, tilted by 28.6"));
  EXPECT_THAT(svg, HasSubstr("camera 100 mm away"));
  EXPECT_THAT(svg, HasSubstr("Plate &amp; ring"));
  EXPECT_EQ(svg, area_lights_svg(drawn.scene, drawn.view.physical(), "Plate & ring"));
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/drawing/light_drawing.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/units.h"
#include "studies/drawing/light_dimensions.h"
#include "studies/drawing/light_section.h"
#include "studies/drawing/svg_page.h"
#include "studies/imaging/path_picture.h"
#include "studies/imaging/scene_store.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using ::testing::HasSubstr;
using ::testing::Not;

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

std::vector<std::string> words_of(const DrawnScene& drawn) {
  std::vector<std::string> words;
  for (const PlaneDimension& one :
       light_dimensions(drawn.view.physical(), drawing_plane(drawn.view.physical()))) {
    words.push_back(one.words);
  }
  return words;
}

// As in CutATiltedRingTwice: edges at 30 +- 8.66 mm from the axis, 100 mm up.
TEST(LightDimensions, OfATiltedRingAreTheDiametersOfItsEdges) {
  RingSettings ring;
  ring.placement.mount = LightPlacement::Mount::kCamera;
  ring.inner_radius_mm = 20.0;
  ring.outer_radius_mm = 40.0;
  ring.tilt_rad = 30.0 * kRadPerDeg;
  for (const int segments : {1, 8}) {
    ring.segments.segments = segments;
    const DrawnScene drawn(lit_plate({{.name = "ring", .settings = ring}}));
    EXPECT_THAT(words_of(drawn),
                ::testing::ElementsAre("\u00d8 77.32 mm", "\u00d8 42.68 mm", "z 100 mm"))
        << segments;
    const auto dimensions =
        light_dimensions(drawn.view.physical(), drawing_plane(drawn.view.physical()));
    EXPECT_NEAR(dimensions[0].a_mm.x(), -38.66, 0.005);
    EXPECT_NEAR(dimensions[0].a_mm.y(), 95.0, 1e-9);
    EXPECT_NEAR(dimensions[1].b_mm.x(), 21.34, 0.005);
  }
}

TEST(LightDimensions, OfLedsAreThoseOfTheirCircle) {
  RingSettings ring;
  ring.placement.mount = LightPlacement::Mount::kCamera;
  ring.inner_radius_mm = 20.0;
  ring.outer_radius_mm = 40.0;
  ring.leds = 12;
  EXPECT_THAT(words_of(DrawnScene(lit_plate({{.name = "ring", .settings = ring}}))),
              ::testing::ElementsAre("\u00d8 60 mm", "z 100 mm"));
}

TEST(LightDimensions, OfADomeAreRimAndOpening) {
  DomeSettings dome;
  dome.radius_mm = 50.0;
  dome.opening_mm = 60.0;
  EXPECT_THAT(words_of(DrawnScene(lit_plate({{.name = "dome", .settings = dome}}))),
              ::testing::ElementsAre("\u00d8 100 mm", "\u00d8 60 mm"))
      << "its rim lies level with the origin";
  dome.placement.position_mm = {0.0, 0.0, 25.0};
  EXPECT_THAT(words_of(DrawnScene(lit_plate({{.name = "dome", .settings = dome}}))),
              ::testing::Contains("z 25 mm"))
      << "the height of its rim, not that of the middle between rim and opening";
}

// It faces the origin from 120 mm aside and 160 mm up: its width leans by atan(120 / 160).
TEST(LightDimensions, OfABarThatStandsAsideTellPlaceAndAngle) {
  BarSettings bar;
  bar.length_mm = 90.0;
  bar.width_mm = 15.0;
  bar.placement.position_mm = {0.0, -120.0, 160.0};
  bar.placement.direction = {0.0, 120.0, -160.0};
  EXPECT_THAT(words_of(DrawnScene(lit_plate({{.name = "bar", .settings = bar}}))),
              ::testing::ElementsAre("15 mm at 36.9\u00b0", "y -120 mm", "z 160 mm"));
}

// A bar along y, 80 mm aside: the drawing across x shows its width; one across y its length.
TEST(LightDimensions, OfABarAreTheSidesThatLieInThePlane) {
  BarSettings bar;
  bar.length_mm = 90.0;
  bar.width_mm = 15.0;
  bar.placement.position_mm = {0.0, 0.0, 40.0};
  for (const int segments : {1, 3}) {
    bar.segments.segments = segments;
    const DrawnScene drawn(lit_plate({{.name = "bar", .settings = bar}}));
    DrawingPlane plane = drawing_plane(drawn.view.physical());
    plane.across = Eigen::Vector3d::UnitX();
    const auto along = light_dimensions(drawn.view.physical(), plane);
    plane.across = Eigen::Vector3d::UnitY();
    const auto across = light_dimensions(drawn.view.physical(), plane);
    ASSERT_EQ(along.size(), 2U);
    EXPECT_EQ(along[0].words, "90 mm");
    EXPECT_NEAR(along[0].b_mm.x(), 45.0, 1e-9);
    EXPECT_EQ(along[1].words, "z 40 mm");
    ASSERT_EQ(across.size(), 2U);
    EXPECT_EQ(across[0].words, "15 mm");
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

/// The longest line of words in a drawing.
std::size_t longest_text(const std::string& svg) {
  std::size_t longest = 0;
  for (auto at = svg.find("<text"); at != std::string::npos; at = svg.find("<text", at + 1)) {
    const auto start = svg.find('>', at) + 1;
    longest = std::max(longest, svg.find('<', start) - start);
  }
  return longest;
}

// 416 units of 6.7 a letter are 62 letters.
TEST(AreaLightsSvg, BreaksLinesThatThePageWouldCut) {
  RingSettings ring;
  ring.placement.mount = LightPlacement::Mount::kCamera;
  ring.inner_radius_mm = 43.5734;
  ring.outer_radius_mm = 67.4651;
  ring.height_mm = 42.517;
  ring.tilt_rad = 0.4555;
  ring.leds = 48;
  const DrawnScene drawn(lit_plate({{.name = "ring", .settings = ring}}));
  const std::string svg = area_lights_svg(
      drawn.scene,
      drawn.view.physical(),
      "Which ring shows a dent on a brushed plate best, seen from the side: Winner of the search");
  EXPECT_LE(longest_text(svg), 62U);
  EXPECT_THAT(svg, HasSubstr(">ring, radii 43.57 to 67.47 mm, at 42.52 mm"));
  EXPECT_THAT(svg, HasSubstr("on the camera<"));
}

/// The values of an attribute.
std::vector<double> values_of(const std::string& svg, const std::string& name) {
  std::vector<double> values;
  const std::string start = " " + name + "=\"";
  for (auto at = svg.find(start); at != std::string::npos; at = svg.find(start, at + 1)) {
    values.push_back(std::stod(svg.substr(at + start.size(), 12)));
  }
  return values;
}

// A ring about a camera that looks up at the part from aside: its axis is oblique, its middle below
// the origin.
TEST(AreaLightsSvg, KeepsDimensionsOnThePageAndApart) {
  RingSettings ring;
  ring.placement.mount = LightPlacement::Mount::kCamera;
  ring.inner_radius_mm = 35.0;
  ring.outer_radius_mm = 65.0;
  ring.height_mm = 20.0;
  SceneSettings scene = lit_plate({{.name = "ring", .settings = ring}});
  scene.viewpoint() = {
      .position_mm = {-120.0, 0.0, -70.0}, .direction = {120.0, 0.0, 70.0}, .up = {0.0, 1.0, 0.0}};
  const DrawnScene drawn(scene);
  const std::string svg = area_lights_svg(drawn.scene, drawn.view.physical(), "");
  for (const char* name : {"x1", "x2"}) {
    for (const double value : values_of(svg, name)) {
      EXPECT_GE(value, 0.0);
      EXPECT_LE(value, 440.0);
    }
  }
  const auto place = [&](const std::string& words) {
    const std::string before = svg.substr(0, svg.find(">" + words + "<"));
    return values_of(before.substr(before.rfind("<text")), "x").at(0);
  };
  EXPECT_GT(std::abs(place("\u00d8 130 mm") - place("\u00d8 70 mm")), 8.0);
}

// Words that are too long for their line stand right of it, or left of it where the page ends.
TEST(SvgPage, PutsWordsBesideALineWhereThePageHasRoom) {
  const auto drawn = [](double x) {
    SvgPage page;
    page.dimension({x, 100.0}, {x + 20.0, 110.0}, 22.0, "60 mm at 45 deg");
    return page.document(kDrawingWidth, 300.0, "", 1.0);
  };
  EXPECT_THAT(drawn(200.0), Not(HasSubstr("text-anchor=\"end\"")));
  EXPECT_THAT(drawn(390.0), HasSubstr("text-anchor=\"end\""));
}

// At 100 % the sheet has a usual scale and fits between the margins of A4, 190 mm wide.
TEST(PaperScale, IsTheLargestUsualOneThatFits) {
  // 1.54 units a mm over 440 units: 285.7 mm are drawn; at 1 : 2 they are 142.9 mm of paper.
  EXPECT_EQ(paper_scale(1.54, 440.0, 600.0).words, "1 : 2");
  EXPECT_NEAR(paper_scale(1.54, 440.0, 600.0).unit_mm, 1.0 / (1.54 * 2.0), 1e-12);
  EXPECT_EQ(paper_scale(1.54, 440.0, 900.0).words, "1 : 5") << "292 mm would be too high";
  EXPECT_EQ(paper_scale(22.0, 440.0, 440.0).words, "5 : 1");
  EXPECT_EQ(scale_text(0.5, 0.4), "1 : 5");
}

}  // namespace
}  // namespace glint

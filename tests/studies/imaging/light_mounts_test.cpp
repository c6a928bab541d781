// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lights fixed to the scene, the part or the camera while the part is moved and turned, and lights
// that stand between camera and part.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/units.h"
#include "studies/imaging/path_lights.h"
#include "studies/imaging/path_picture.h"
#include "studies/imaging/path_warnings.h"
#include "studies/imaging/scene_store.h"
#include "tests/studies/imaging/path_support.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using Mount = LightPlacement::Mount;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::vector<double> numbers(const Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

/// A matt plate under a bar that lights one corner, seen from above.
SceneSettings plate_under_bar(Mount mount) {
  SceneSettings scene;
  scene.part.shape = PartSettings::Shape::kPlate;
  scene.part.length_mm = 16.0;
  scene.part.width_mm = 12.0;
  scene.material.type = MaterialSettings::Type::kDiffuse;
  scene.camera.width_px = 20;
  scene.camera.height_px = 16;
  scene.camera.object_pixel_mm = 1.0;
  scene.camera.working_distance_mm = 100.0;
  scene.viewpoint() = default_viewpoint(scene.camera);
  scene.has_tunnel = false;
  scene.paths.samples = 16;
  scene.paths.batches = 1;
  scene.paths.max_reflections = 1;
  BarSettings bar;
  bar.placement = {.mount = mount,
                   .position_mm = {6.0, 5.0, 20.0},
                   .direction = {-0.3, -0.2, -1.0},
                   .roll_rad = 0.3};
  bar.length_mm = 8.0;
  bar.width_mm = 3.0;
  scene.lights = {{.name = "bar", .settings = bar}};
  return scene;
}

struct Rendered {
  explicit Rendered(const SceneSettings& scene)
      : pool(2),
        store(pool),
        view(scene, store.build_defects(scene), scene.viewpoint()),
        picture(render_view(view, path_settings(scene), pool)) {}

  ImageF frame() const { return frame_radiance(picture, view.frames().front()); }

  ThreadPool pool;
  SceneStore store;
  PathView view;
  PathPicture picture;
};

struct Pose {
  Vector3d position_mm = Vector3d::Zero();
  Vector3d rotation_rad = Vector3d::Zero();

  RigidTransform scene_from_part() const { return pose_from_angles(position_mm, rotation_rad); }
};

const std::vector<Pose> kPoses = {
    {.position_mm = {0.0, 0.0, -20.0}},
    {.rotation_rad = {0.2, -0.1, 0.7}},
    {.position_mm = {3.0, -2.0, -20.0}, .rotation_rad = {0.2, -0.1, 0.7}}};

SceneSettings posed(SceneSettings scene, const Pose& pose) {
  scene.part.position_mm = numbers(pose.position_mm);
  scene.part.rotation_rad = numbers(pose.rotation_rad);
  return scene;
}

/// The camera goes with the part.
SceneSettings posed_with_camera(const SceneSettings& scene, const Pose& pose) {
  SceneSettings moved = posed(scene, pose);
  const RigidTransform to = pose.scene_from_part();
  Viewpoint& at = moved.viewpoint();
  const auto turned = [&](const std::vector<double>& v) {
    return numbers(to.rotation * Vector3d(v[0], v[1], v[2]));
  };
  at.position_mm = numbers(to * Vector3d(at.position_mm[0], at.position_mm[1], at.position_mm[2]));
  at.direction = turned(at.direction);
  at.up = turned(at.up);
  return moved;
}

// Part, camera and light moved together show what they showed before: lowered, turned, and both.
TEST(LightMount, ALightOnThePartMovesWithItsPose) {
  const ImageF at_rest = Rendered(plate_under_bar(Mount::kPart)).frame();
  EXPECT_EQ(at_rest, Rendered(plate_under_bar(Mount::kScene)).frame())
      << "a part at rest has the scene's frame";
  ASSERT_GT(at_rest(10, 8), 0.0F);
  for (const Pose& pose : kPoses) {
    const Rendered on_part(posed_with_camera(plate_under_bar(Mount::kPart), pose));
    EXPECT_LT(largest_difference(on_part.frame(), at_rest), 2e-3);
    const Rendered in_scene(posed_with_camera(plate_under_bar(Mount::kScene), pose));
    EXPECT_GT(largest_difference(in_scene.frame(), at_rest), 0.1)
        << "a light in the scene stays behind";
  }
}

// What the camera sees of the part does not depend on what the light is fixed to, and the drawing's
// emitters stand where the part's pose takes them.
TEST(LightMount, MasksAndDrawnLightsAgreeWithThePose) {
  const RectangleShape at_rest = std::get<RectangleShape>(
      Rendered(plate_under_bar(Mount::kPart)).view.area_lights()->lights.emitters[0].shape);
  for (const Pose& pose : kPoses) {
    const Rendered on_part(posed(plate_under_bar(Mount::kPart), pose));
    const Rendered in_scene(posed(plate_under_bar(Mount::kScene), pose));
    EXPECT_EQ(on_part.picture.sums.part, in_scene.picture.sums.part);
    const auto frame_of = [](const Rendered& rendered) {
      return std::get<RectangleShape>(rendered.view.area_lights()->lights.emitters[0].shape).frame;
    };
    const RigidTransform to = pose.scene_from_part();
    EXPECT_LT((frame_of(on_part).origin_mm - to * at_rest.frame.origin_mm).norm(), 1e-12);
    EXPECT_LT((frame_of(on_part).x - to.rotation * at_rest.frame.x).norm(), 1e-12);
    EXPECT_LT((frame_of(on_part).z - to.rotation * at_rest.frame.z).norm(), 1e-12);
    EXPECT_EQ(frame_of(in_scene).origin_mm, at_rest.frame.origin_mm);
  }
}

/// A ring 50 mm before the camera, its back to it. The camera sees 16 x 12 mm of plate at 100 mm,
/// so at 50 mm it looks through 8 x 6 mm.
SceneSettings plate_behind_ring(double inner_radius_mm) {
  SceneSettings scene = plate_under_bar(Mount::kScene);
  scene.camera.width_px = 200;
  scene.camera.height_px = 160;
  scene.camera.object_pixel_mm = 0.1;
  RingSettings ring;
  ring.placement.mount = Mount::kCamera;
  ring.height_mm = 50.0;
  ring.inner_radius_mm = inner_radius_mm;
  ring.outer_radius_mm = 40.0;
  scene.lights = {{.name = "ring", .settings = ring}};
  return scene;
}

// Through a hole of radius 2 mm at 50 mm the camera sees the disc of radius 4 mm of the plate's 16
// x 12 mm: 16 pi / 192 = 26.2 %; the ring hides 73.8 %. The plate's top lies 1.5 mm nearer: its
// disc has the radius 2 (98.5 / 50) = 3.94 mm, 25.4 %.
TEST(HidingLights, TellTheShareThatARingsBackHides) {
  const Rendered rendered(plate_behind_ring(2.0));
  const std::vector<HidingLight> hiding = hiding_lights(rendered.view.physical());
  ASSERT_EQ(hiding.size(), 1U);
  EXPECT_EQ(hiding[0].name, "ring");
  EXPECT_NEAR(hiding[0].back_share, 1.0 - 3.94 * 3.94 * kPi / 192.0, 0.01);
  EXPECT_EQ(hiding[0].front_share, 0.0);
  EXPECT_THAT(path_warnings(rendered.view.physical()),
              ElementsAre(HasSubstr("The back of lighting.ring hides 7")));
  const ImageF frame = rendered.frame();
  EXPECT_EQ(frame(20, 80), 0.0F) << "dark behind the ring";
  EXPECT_GT(frame(100, 80), 0.0F) << "seen through its hole";
}

TEST(HidingLights, AreNoneWhereTheViewPasses) {
  EXPECT_TRUE(hiding_lights(Rendered(plate_behind_ring(6.0)).view.physical()).empty());
}

TEST(HidingLights, AddUpTheSegmentsOfALight) {
  SceneSettings scene = plate_behind_ring(2.0);
  auto& ring = std::get<RingSettings>(scene.lights[0].settings);
  ring.segments.segments = 4;
  ring.segments.separate = true;
  const std::vector<HidingLight> hiding = hiding_lights(Rendered(scene).view.physical());
  ASSERT_EQ(hiding.size(), 1U);
  EXPECT_EQ(hiding[0].name, "ring");
  EXPECT_NEAR(hiding[0].back_share, 0.746, 0.01);
}

TEST(HidingLights, TellFrontsApart) {
  SceneSettings scene = plate_behind_ring(2.0);
  std::get<RingSettings>(scene.lights[0].settings).placement.direction = {0.0, 0.0, -1.0};
  std::get<RingSettings>(scene.lights[0].settings).height_mm = -50.0;
  const std::vector<HidingLight> hiding = hiding_lights(Rendered(scene).view.physical());
  ASSERT_EQ(hiding.size(), 1U);
  EXPECT_EQ(hiding[0].back_share, 0.0);
  EXPECT_NEAR(hiding[0].front_share, 0.746, 0.01);
}

TEST(LightSettings, TellOfAnyKindWhetherItShinesAndStandsSomewhere) {
  RingSettings ring;
  ring.segments.segments = 4;
  LightSettings segmented = ring;
  ASSERT_NE(segments_of(segmented), nullptr);
  EXPECT_EQ(segments_of(segmented)->segments, 4);
  ring.emission.radiance = {0.0};
  EXPECT_FALSE(shines(ring));
  EXPECT_TRUE(has_body(ring));  // that is dark and shades others
  ring.emission.power_w = {2.0};
  EXPECT_TRUE(shines(ring));
  const LightSettings luminaire = IesLightSettings{.scale = {0.0, 0.0, 0.5}};
  EXPECT_TRUE(shines(luminaire));
  EXPECT_FALSE(has_body(luminaire));
  EXPECT_TRUE(has_place(luminaire));
  LightSettings sky = EnvironmentSettings{};
  EXPECT_TRUE(shines(sky));
  EXPECT_FALSE(has_place(sky));
  EXPECT_EQ(segments_of(sky), nullptr);
}

}  // namespace
}  // namespace glint

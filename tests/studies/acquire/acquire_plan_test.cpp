// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/acquire_plan.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "core/units.h"
#include "hardware/planning/clearance.h"
#include "studies/acquire/taught_views.h"
#include "studies/definition/study.h"
#include "studies/plan/scene_plan.h"
#include "studies/reach/scene_cell.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr const char* kCell = R"([camera]
address = "127.0.0.1"
exposure_us = 2000
[robot]
model = "ur3"
host = "127.0.0.1"
flange_from_tcp = [0, 0, 80, 0, 0, 0]
tool_radius_mm = 35
payload_kg = 0.6
[limits]
tool_speed_mm_s = 250
tool_acceleration_mm_s2 = 500
joint_speed_deg_s = 60
joint_acceleration_deg_s2 = 120
box_min_mm = [-600, -600, 20]
box_max_mm = [600, 600, 900]
[lights.ring]
output = 0
[[safe_position]]
name = "home"
joints_deg = [0, -100, 100, -90, -90, 0]
[[view]]
name = "left"
joints_deg = [10, -95, 95, -85, -90, 0]
lights = ["ring"]
exposure_us = 500
[[view]]
joints_deg = [20, -95, 95, -85, -90, 0]
)";

std::string edited(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

class AcquirePlan : public testing::Test {
 protected:
  Cell cell_of(const std::string& text) const {
    write_file(folder_ / "cell.toml", text);
    return read_cell(folder_ / "cell.toml");
  }

  std::string error_of_plan(const std::string& json) const {
    write_file(folder_ / "plan.json", json);
    try {
      const AcquireSource source = read_source(folder_ / "plan.json");
      work_of(source, cell_of(kCell), 0.5);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }

  TemporaryFolder folder_;
};

TEST_F(AcquirePlan, IsTheCellsOwnViewsWithoutAnother) {
  const AcquireWork work = work_of({}, cell_of(kCell), 0.5);
  ASSERT_EQ(work.plan.tour.size(), 4U);
  EXPECT_TRUE(work.plan.tour[0].is_safe);
  EXPECT_FALSE(work.plan.tour[1].is_safe);
  EXPECT_TRUE(work.plan.tour[3].is_safe);
  ASSERT_EQ(work.plan.tasks.size(), 2U);
  EXPECT_EQ(work.plan.tasks[0].name, "left");
  EXPECT_THAT(work.plan.tasks[0].lights, ElementsAre("ring"));
  EXPECT_NEAR(work.plan.tasks[0].exposure_us, 500.0, 1e-9);
  EXPECT_EQ(work.plan.tasks[1].name, "view_2");
  EXPECT_NEAR(work.plan.tasks[1].exposure_us, 2000.0, 1e-9);
  EXPECT_EQ(work.digest, work_of({}, cell_of(kCell), 0.5).digest);
}

TEST_F(AcquirePlan, AViewWithoutANameHasItsOwnLightsAndExposure) {
  const std::string joints = "joints_deg = [20, -95, 95, -85, -90, 0]\n";
  const std::string text =
      edited(kCell, joints, joints + "lights = [\"ring\"]\nexposure_us = 700\n");
  const AcquireWork work = work_of({}, cell_of(text), 0.5);
  ASSERT_EQ(work.plan.tasks.size(), 2U);
  EXPECT_EQ(work.plan.tasks[1].name, "view_2");
  EXPECT_THAT(work.plan.tasks[1].lights, ElementsAre("ring"));
  EXPECT_NEAR(work.plan.tasks[1].exposure_us, 700.0, 1e-9);
}

TEST_F(AcquirePlan, SaysWhichViewOfTheCellCannotBeTaken) {
  std::string text = kCell;
  text += "[[view]]\nname = \"low\"\njoints_deg = [0, 0, 30, -90, -90, 0]\n";
  const AcquireWork work = work_of({}, cell_of(text), 0.5);
  ASSERT_EQ(work.views.views.size(), 3U);
  EXPECT_EQ(work.views.views[2].outcome, ViewOutcome::kBox);
  EXPECT_NE(work.views.views[2].reason, "");
  EXPECT_EQ(work.plan.tasks.size(), 2U);
}

/// An upright post on the way of the tool's tip about the base.
std::string post_at(double turn_deg) {
  JointVector joints_deg;
  joints_deg << turn_deg, -95, 95, -85, -90, 0;
  const Eigen::Vector3d at_mm = Arm(ArmModel::kUr3).forward(joints_deg * kRadPerDeg).translation();
  return fmt::format(
      "[[obstacle]]\nname = \"post\"\nposition_mm = [{}, {}, 135]\nsize_mm = [20, 20, 270]\n",
      at_mm.x(),
      at_mm.y());
}

/// A home above the views, and a post beside it.
std::string cell_with_post(double turn_deg) {
  return edited(kCell, "[0, -100, 100, -90, -90, 0]", "[0, -110, 70, -50, -90, 0]") +
         "[[view]]\nname = \"right\"\njoints_deg = [-40, -95, 95, -85, -90, 0]\n" +
         post_at(turn_deg);
}

TEST_F(AcquirePlan, RefusesViewsOfTheCellThatTouchAnObstacle) {
  const AcquireWork work = work_of({}, cell_of(cell_with_post(-40.0)), 0.5);
  ASSERT_EQ(work.views.views.size(), 3U);
  EXPECT_EQ(work.views.views[2].outcome, ViewOutcome::kCollision);
  EXPECT_THAT(work.views.views[2].reason, HasSubstr("post"));
  EXPECT_EQ(work.plan.tasks.size(), 2U);
}

TEST_F(AcquirePlan, GoesBetweenViewsOfTheCellAroundAnObstacle) {
  const AcquireWork work = work_of({}, cell_of(cell_with_post(-10.0)), 0.5);
  EXPECT_EQ(work.plan.tasks.size(), 3U);
  ASSERT_EQ(work.plan.tour.size(), 6U);
  EXPECT_TRUE(work.plan.tour[3].is_safe) << "between view_2 and right";
}

/// From the safe position the way to the second view leads over the first one, which is no safe
/// position: low on both sides of a post, and above it.
std::string cell_with_view_behind_post() {
  const std::string text =
      edited(kCell, "[0, -100, 100, -90, -90, 0]", "[-40, -95, 95, -85, -90, 0]");
  return edited(text, "[10, -95, 95, -85, -90, 0]", "[0, -110, 70, -50, -90, 0]") + post_at(-10.0);
}

TEST_F(AcquirePlan, TakesNoViewFromWhichThereIsNoWayBack) {
  const Cell cell = cell_of(cell_with_view_behind_post());
  const AcquireWork work = work_of({}, cell, 0.5);
  ASSERT_EQ(work.views.views.size(), 2U);
  const PlanningCell planned = planning_cell(cell);
  const auto joints_rad = [&work](std::size_t view) { return work.views.views[view].joints_rad; };
  ASSERT_TRUE(ClearanceCheck(planned).along(joints_rad(0), joints_rad(1)).is_free());
  EXPECT_EQ(work.views.views[0].outcome, ViewOutcome::kPlanned);
  EXPECT_EQ(work.views.views[1].outcome, ViewOutcome::kNoPath);
  EXPECT_THAT(work.views.views[1].reason, HasSubstr("post"));
  ASSERT_EQ(work.views.paths.size(), 2U);
  EXPECT_EQ(work.views.paths[1].from, "left");
}

TEST_F(AcquirePlan, SaysWhyNoneOfTheViewsCanBeTaken) {
  std::string text = edited(kCell, "[10, -95, 95, -85, -90, 0]", "[0, 0, 30, -90, -90, 0]");
  text = edited(text, "[20, -95, 95, -85, -90, 0]", "[5, 0, 30, -90, -90, 0]");
  try {
    work_of({}, cell_of(text), 0.5);
    ADD_FAILURE() << "there is nothing to drive";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.what(), HasSubstr("left: box: "));
  }
}

constexpr const char* kSceneWithCamera = R"(schema = 2
[part]
shape = "plate"
length_mm = 20
width_mm = 20
[calibration.flange_from_camera]
translation_mm = [0, 60, 60]
rotation_vector_deg = [0, 0, 0]
[scan]
positions = 1
)";

// The scene does not lie in the cell: its views are the cell's.
TEST_F(AcquirePlan, KeepsTheCameraClearWhereTheSceneHasIt) {
  const std::string camera = "[planning]\ncamera_size_mm = [30, 30, 40]\n";
  write_file(folder_ / "scene.toml", kSceneWithCamera);
  AcquireSource source;
  source.scene = load_study(folder_ / "scene.toml", {}).scene;
  source.scene->lights.clear();
  source.scene->has_tunnel = false;
  const AcquireWork work = work_of(source, cell_of(kCell + camera), 0.5);
  EXPECT_EQ(work.plan.tasks.size(), 2U);
}

// 500 and 2000 us are those of sensor.exposure 1.
TEST_F(AcquirePlan, TakesTheExposureOfTheDesignTimesThatOfTheCell) {
  write_file(folder_ / "scene.toml", kSceneWithCamera);
  AcquireSource source;
  source.scene = load_study(folder_ / "scene.toml", {}).scene;
  source.scene->lights.clear();
  source.scene->has_tunnel = false;
  const AcquireWork work = work_of(source, cell_of(kCell), 0.5);
  source.scene->sensor.exposure = 1.5;
  const AcquireWork longer = work_of(source, cell_of(kCell), 0.5);
  EXPECT_NEAR(work.plan.tasks[0].exposure_us, 500.0, 1e-9);
  EXPECT_NEAR(longer.plan.tasks[0].exposure_us, 750.0, 1e-9);
  EXPECT_NEAR(longer.plan.tasks[1].exposure_us, 3000.0, 1e-9);
  EXPECT_NE(longer.digest, work.digest);
}

// Then sensor.exposure means nothing: twice the light takes half the time.
TEST_F(AcquirePlan, TakesTheExposureThatMakesKindsOfLightEquallyBright) {
  const std::string scene = std::string(kSceneWithCamera) +
                            "[material]\ntype = \"diffuse\"\nreflectance = [0.5]\n"
                            "[camera]\nwidth_px = 40\nheight_px = 40\nobject_pixel_mm = 1\n"
                            "[sensor]\nexpose_to = 0.9\nbits = 0\nfull_well_e = 0\n"
                            "[render.paths]\nsamples = 4\nmax_reflections = 1\n"
                            "[lighting.ring]\nmount = \"camera\"\nradiance = [1]\n";
  const auto exposure_us = [&](const std::string& text) {
    write_file(folder_ / "scene.toml", text);
    AcquireSource source;
    source.scene = load_study(folder_ / "scene.toml", {}).scene;
    return work_of(source, cell_of(kCell), 0.5).plan.tasks[0].exposure_us;
  };
  const double one_us = exposure_us(scene);
  EXPECT_GT(std::abs(one_us - 500.0), 1.0);
  EXPECT_NEAR(
      exposure_us(edited(scene, "radiance = [1]", "radiance = [2]")), 0.5 * one_us, 1e-3 * one_us);
  EXPECT_EQ(exposure_us(edited(scene, "expose_to = 0.9", "expose_to = 0.9\nexposure = 2")), one_us);
}

// Nothing is connected for it, so the arm does not drive out.
TEST_F(AcquirePlan, RefusesAScanThatTheStageCannotMake) {
  const std::string cell = std::string(kCell) + "[lights.tunnel]\noutput = 1\n[stage]\n";
  const auto error_with = [&](const std::string& stage, const std::string& scene) {
    write_file(folder_ / "scene.toml", scene);
    AcquireSource source;
    source.scene = load_study(folder_ / "scene.toml", {}).scene;
    try {
      work_of(source, cell_of(cell + stage), 0.5);
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::string one = kSceneWithCamera;
  const std::string six = edited(one, "positions = 1", "positions = 6");
  make_folder(folder_ / "show");
  for (const char* name : {"a.png", "b.png"}) {
    write_file(folder_ / name, name);
  }
  const std::string folder =
      "kind = \"folder\"\nfolder = \"show\"\npictures = [\"a.png\", \"b.png\"]\n";
  EXPECT_EQ(error_with(folder, one), "");
  EXPECT_EQ(error_with(folder + "positions = 2\n", six), "");
  EXPECT_THAT(error_with(folder, six),
              HasSubstr("cell.toml: stage.pictures: are 2, must be at least 6"));
  const std::string rail = "host = \"127.0.0.1\"\n";
  const std::string unlit = one + "[lighting.ring]\n[material]\ntype = \"diffuse\"\n";
  EXPECT_EQ(error_with(rail, six), "") << "the scan has a step";
  EXPECT_EQ(error_with(rail, unlit), "");
  EXPECT_EQ(error_with(rail + "positions = 6\nstep_mm = 2\n", unlit), "");
  EXPECT_THAT(error_with(rail + "positions = 6\n", unlit),
              HasSubstr("cell.toml: stage.step_mm: is 0"));
}

/// A bar far beside the camera, and what else kSceneWithCamera needs for it.
std::string scene_with_bar(const std::string& mount) {
  return fmt::format(
      "{}[material]\ntype = \"diffuse\"\n[lighting.bar]\nmount = \"{}\"\n"
      "position_mm = [150, -120, 0]\nlength_mm = 20\nwidth_mm = 20\nradiance = [1]\n",
      kSceneWithCamera,
      mount);
}

// By the arm's kinematics the bar is in the cube where the third view is taken, and the tool 150 mm
// beside it. Where a bar stands about the part nobody knows its place, as the part lies nowhere.
TEST_F(AcquirePlan, KeepsLightsAtTheCameraClear) {
  const Cell cell =
      cell_of(edited(kCell, "[0, -100, 100, -90, -90, 0]", "[0, -110, 70, -50, -90, 0]") +
              "[[view]]\nname = \"right\"\njoints_deg = [-40, -95, 95, -85, -90, 0]\n"
              "[[obstacle]]\nname = \"cube\"\nposition_mm = [-224, 237, 241]\n"
              "size_mm = [20, 20, 20]\n");
  const auto right_with = [&](const std::string& mount) {
    write_file(folder_ / "scene.toml", scene_with_bar(mount));
    const SceneSettings scene = load_study(folder_ / "scene.toml", {}).scene;
    return plan_of_cell_views(cell, 0.5, &scene).views.at(2);
  };
  EXPECT_EQ(plan_of_cell_views(cell, 0.5).views.at(2).outcome, ViewOutcome::kPlanned);
  EXPECT_EQ(right_with("part").outcome, ViewOutcome::kPlanned);
  const PlannedView right = right_with("camera");
  EXPECT_EQ(right.outcome, ViewOutcome::kCollision);
  EXPECT_THAT(right.reason, testing::AllOf(HasSubstr("bar light"), HasSubstr("cube")));
}

constexpr const char* kPlan = R"({"schema": 1, "kind": "plan", "scene": "scene.toml",
 "cell": "cell.toml", "reach": {"share": 0.5, "margin_mm": 6}, "views": [
  {"name": "a", "outcome": "planned", "reason": "", "base_from_camera": [0, 0, 0, 0, 0, 0],
   "base_from_flange": [0, 0, 0, 0, 0, 0], "joints_deg": [10, -95, 95, -85, -90, 0],
   "margin_mm": 7, "singularity": 0.1, "nearest_base_from_camera": null},
  {"name": "far", "outcome": "unreachable", "reason": "no joints",
   "base_from_camera": [0, 0, 0, 0, 0, 0], "base_from_flange": [0, 0, 0, 0, 0, 0],
   "nearest_base_from_camera": null}],
 "paths": [
  {"from": "home", "to": "a", "joints_deg": [[0, -100, 100, -90, -90, 0], [5, -98, 98, -88, -90, 0],
   [10, -95, 95, -85, -90, 0]], "margin_mm": 6, "duration_s": 1},
  {"from": "a", "to": "home", "joints_deg": [[10, -95, 95, -85, -90, 0],
   [0, -100, 100, -90, -90, 0]], "margin_mm": 6, "duration_s": 1}]})";

TEST_F(AcquirePlan, IsReadFromAPlan) {
  write_file(folder_ / "plan.json", kPlan);
  const AcquireSource source = read_source(folder_ / "plan.json");
  const AcquireWork work = work_of(source, cell_of(kCell), 0.5);
  ASSERT_EQ(work.plan.tour.size(), 4U);
  EXPECT_EQ(work.plan.tour[1].name, "");
  ASSERT_EQ(work.plan.tasks.size(), 1U);
  EXPECT_EQ(work.plan.tasks[0].point, 2U);
  EXPECT_EQ(work.views.views[1].outcome, ViewOutcome::kUnreachable);
}

TEST_F(AcquirePlan, RefusesPlansThatCannotBeDriven) {
  const std::string plan = kPlan;
  EXPECT_EQ(error_of_plan(plan), "");
  EXPECT_THAT(error_of_plan("{}"), HasSubstr("kind: is missing"));
  EXPECT_THAT(error_of_plan(edited(plan, "\"planned\"", "\"nice\"")),
              HasSubstr("views[0].outcome"));
  EXPECT_THAT(error_of_plan(edited(plan, "[5, -98, 98, -88, -90, 0]", "[5, -98]")),
              HasSubstr("paths[0].joints_deg"));
  EXPECT_THAT(error_of_plan(
                  edited(plan, "[[10, -95, 95, -85, -90, 0],\n", "[[11, -95, 95, -85, -90, 0],\n")),
              HasSubstr("does not begin where"));
  EXPECT_THAT(error_of_plan(edited(plan, "[5, -98, 98, -88, -90, 0]", "[5, 0, 30, -90, -90, 0]")),
              HasSubstr("paths: between home and"));
  EXPECT_THAT(error_of_plan(edited(
                  plan, "[[0, -100, 100, -90, -90, 0], [5", "[[1, -100, 100, -90, -90, 0], [5")),
              HasSubstr("must begin at a [[safe_position]]"));
}

// Planned before the post was there.
TEST_F(AcquirePlan, RefusesAPlanWhosePathsTouchAnObstacleOfThisCell) {
  write_file(folder_ / "plan.json", kPlan);
  const AcquireSource source = read_source(folder_ / "plan.json");
  EXPECT_NO_THROW(work_of(source, cell_of(kCell + post_at(-40.0)), 0.5));
  EXPECT_THAT([&] { work_of(source, cell_of(kCell + post_at(10.0)), 0.5); },
              testing::ThrowsMessage<ConfigError>(testing::AllOf(
                  HasSubstr("paths: from home to a"), HasSubstr("post"), HasSubstr("plan again"))));
}

// With its table, camera and cable: what the study asks for, and where calibrating begins.
TEST(GalleryRobotCell, AllItsViewsCanBeTaken) {
  const std::filesystem::path gallery =
      std::filesystem::path(GLINT_SOURCE_DIR) / "studies/gallery/robot_cell";
  const Cell cell = read_cell(gallery / "cell.toml");
  EXPECT_TRUE(cell.planning.settings.table_height_mm);
  EXPECT_FALSE(cell.planning.settings.camera_size_mm.empty());
  EXPECT_FALSE(cell.planning.settings.cable_mm.empty());
  const ViewPlan study = plan_scene(load_study(gallery / "study.toml", {}).scene, cell).plan;
  EXPECT_EQ(study.views.size(), 5U);
  const ViewPlan board = plan_of_cell_views(cell, 0.5);
  EXPECT_EQ(board.views.size(), 9U);
  for (const ViewPlan& plan : {study, board}) {
    for (const PlannedView& view : plan.views) {
      EXPECT_EQ(view.outcome, ViewOutcome::kPlanned) << view.name << ": " << view.reason;
    }
  }
}

}  // namespace
}  // namespace glint

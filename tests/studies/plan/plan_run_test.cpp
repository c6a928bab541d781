// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/plan/plan_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "studies/plan/plan_file.h"
#include "studies/reach/scene_cell.h"
#include "tests/studies/cell/ur3_cells.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using testing::HasSubstr;

const std::string kCalibration =
    "[calibration]\nsetup = \"eye_in_hand\"\n[calibration.flange_from_camera]\n"
    "translation_mm = [0, 50, 30]\n";

const std::string kScene = R"(schema = 2
[part]
shape = "plate"
length_mm = 48
width_mm = 36
thickness_mm = 5
[camera]
width_px = 408
height_px = 342
pixel_um = 10.35
object_pixel_mm = 0.15
working_distance_mm = 180
[lighting.ring]
mount = "camera"
inner_radius_mm = 30
outer_radius_mm = 60
height_mm = 60
[cell.base_from_part]
translation_mm = [280, -120, 20]
[[viewpoint]]
position_mm = [0, 0, 180]
direction = [0, 0, -1]
up = [0, 1, 0]
[[viewpoint]]
position_mm = [60, 0, 170]
direction = [-60, 0, -170]
up = [0, 1, 0]
[[viewpoint]]
position_mm = [0, 0, 50]
direction = [0, 0, -1]
up = [0, 1, 0]
[[viewpoint]]
position_mm = [900, 0, 400]
direction = [-900, 0, -400]
up = [0, 1, 0]
)";

const std::string kCell = std::string(test::kUr3WithCamera) + R"([planning]
margin_mm = 4
table_height_mm = 0
camera_size_mm = [40, 40, 60]
cable_mm = [0, 50, -30, 0, 110, -60]
[[obstacle]]
name = "post"
position_mm = [280, 80, 100]
size_mm = [30, 30, 200]
[[safe_position]]
name = "above"
joints_deg = [8.873, -82.466, -92.57, -94.964, 90.0, -81.127]
)";

class PlanStudyTest : public testing::Test {
 protected:
  nlohmann::ordered_json plan(const std::string& scene, const std::string& cell) {
    write_file(folder_ / "scene.toml", scene);
    write_file(folder_ / "cell.toml", cell);
    return plan_study(load_study(folder_ / "scene.toml", {}),
                      {.cell = folder_ / "cell.toml", .out = folder_ / "out"});
  }

  std::string problem(const std::string& scene, const std::string& cell) {
    return text_thrown_by<ConfigError>([&] { plan(scene, cell); });
  }

  TemporaryFolder folder_;
};

TEST_F(PlanStudyTest, WritesAWholeFolderThatIsReadAgain) {
  const nlohmann::ordered_json result = plan(kScene + kCalibration, kCell);
  EXPECT_EQ(result["views"][0]["outcome"], "planned") << result["views"][0]["reason"];
  EXPECT_EQ(result["views"][1]["outcome"], "planned") << result["views"][1]["reason"];
  EXPECT_EQ(result["views"][2]["outcome"], "collision");
  EXPECT_FALSE(result["views"][2]["nearest_base_from_camera"].is_null());
  EXPECT_EQ(result["views"][3]["outcome"], "unreachable");
  EXPECT_EQ(result["reach"]["share"], 0.5);
  for (const char* file : {"plan.json", "plan.csv", "report.html", "run.json", "scene.toml"}) {
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / file)) << file;
  }
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/pictures/view_01.png"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/pictures/view_03.png"));
  const PlanFile file = read_plan(folder_ / "out");
  EXPECT_EQ(file.plan.paths.size(), 3U);
  // What was planned again from the copies is the same.
  const nlohmann::ordered_json again =
      plan_study(load_study(file.scene, {}), {.cell = file.cell, .out = folder_ / "again"});
  EXPECT_EQ(again["views"], result["views"]);
  EXPECT_EQ(again["paths"], result["paths"]);
}

TEST_F(PlanStudyTest, TellsThatACameraWithoutSizeIsNotLookedAt) {
  EXPECT_TRUE(plan(kScene + kCalibration, kCell)["notes"].empty());
  std::string cell = kCell;
  const std::string size = "camera_size_mm = [40, 40, 60]\n";
  cell.erase(cell.find(size), size.size());
  const nlohmann::ordered_json result = plan(kScene + kCalibration, cell);
  ASSERT_EQ(result["notes"].size(), 1U);
  EXPECT_THAT(result["notes"][0].get<std::string>(), HasSubstr("planning.camera_size_mm"));
  EXPECT_THAT(read_file(folder_ / "out/report.html"), HasSubstr("no planning.camera_size_mm"));
}

// The same view: the cable's room reaches down to the table, or does not.
TEST_F(PlanStudyTest, RefusesAViewThatALongCableCannotTake) {
  const std::string cable = "cable_mm = [0, 50, -30, 0, 110, -60]";
  const std::string cell = kCell;
  const std::size_t at = cell.find(cable);
  ASSERT_NE(at, std::string::npos);
  EXPECT_EQ(plan(kScene + kCalibration, cell)["views"][0]["outcome"], "planned");
  const nlohmann::ordered_json longer =
      plan(kScene + kCalibration,
           std::string(cell).replace(at, cable.size(), "cable_mm = [0, 50, -30, 0, 150, 240]"));
  EXPECT_EQ(longer["views"][0]["outcome"], "collision");
  EXPECT_THAT(longer["views"][0]["reason"].get<std::string>(), HasSubstr("cable"));
}

TEST_F(PlanStudyTest, TellsWhatItWasPlannedFrom) {
  EXPECT_EQ(plan(kScene + kCalibration, kCell)["run"], nullptr);
  write_file(folder_ / "study.resolved.toml", "schema = 1\n");
  plan(kScene + kCalibration, kCell);
  const PlanFile file = read_plan(folder_ / "out");
  EXPECT_EQ(file.origin.scene, folder_ / "scene.toml");
  EXPECT_EQ(file.origin.run, folder_.path());
}

TEST_F(PlanStudyTest, LeavesNoPictureOfAnEarlierPlan) {
  plan(kScene + kCalibration, kCell);
  ASSERT_TRUE(std::filesystem::exists(folder_ / "out/pictures/view_02.png"));
  const std::string fewer = kScene.substr(0, kScene.find("[[viewpoint]]\nposition_mm = [60,"));
  plan(fewer + kCalibration, kCell);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out/pictures/view_01.png"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out/pictures/view_02.png"));
}

TEST_F(PlanStudyTest, LeavesThePlanOfAnotherStudy) {
  make_folder(folder_ / "out");
  write_file(folder_ / "out/run.json", R"({"verb": "plan", "study": "gear"})");
  EXPECT_THAT(problem(kScene + kCalibration, kCell),
              HasSubstr("out: holds results of `glint plan` of gear; choose another"));
}

// The camera looks straight down on the part's origin from 180 mm: at (280, -120, 200) in the base.
TEST_F(PlanStudyTest, PutsTheCameraWhereTheSceneHasIt) {
  const nlohmann::ordered_json result = plan(kScene + kCalibration, kCell);
  const auto pose = result["views"][0]["base_from_camera"].get<std::vector<double>>();
  EXPECT_NEAR(pose[0], 280.0, 1e-9);
  EXPECT_NEAR(pose[1], -120.0, 1e-9);
  EXPECT_NEAR(pose[2], 200.0, 1e-9);
}

TEST_F(PlanStudyTest, TakesTheHandEyeOfTheCellsCalibration) {
  write_file(folder_ / "calibration.toml", kCalibration);
  const nlohmann::ordered_json result =
      plan(kScene, kCell + "[calibration]\nfile = \"calibration.toml\"\n");
  EXPECT_EQ(result["views"][0]["outcome"], "planned");
}

/// The same scene held up to a camera that looks up from the table: the part's +z is the flange's.
std::string held_scene() {
  std::string scene = kScene;
  const std::string lies = "[cell.base_from_part]\ntranslation_mm = [280, -120, 20]\n";
  scene.replace(scene.find(lies),
                lies.size(),
                "[cell.flange_from_part]\ntranslation_mm = [0, 0, 80]\n"
                "[calibration.base_from_camera]\ntranslation_mm = [280, -120, 70]\n");
  const std::string near = "position_mm = [0, 0, 50]\n";
  return scene.replace(scene.find(near), near.size(), "position_mm = [0, 0, 2]\n");
}

TEST_F(PlanStudyTest, HoldsThePartUpToACameraBesideTheRobot) {
  const nlohmann::ordered_json result = plan(held_scene(), kCell);
  const Cell cell = read_cell(folder_ / "cell.toml");
  const SceneSettings scene = load_study(folder_ / "scene.toml", {}).scene;
  const CellChain chain = cell_chain(scene, cell);
  EXPECT_FALSE(chain.is_in_hand);
  const PlanFile file = read_plan(folder_ / "out");
  for (const std::size_t i : {0U, 1U}) {
    const PlannedView& view = file.plan.views[i];
    ASSERT_EQ(view.outcome, ViewOutcome::kPlanned) << view.reason;
    const RigidTransform flange = {.rotation = view.base_from_flange.linear(),
                                   .translation_mm = view.base_from_flange.translation()};
    const RigidTransform seen = chain.scene_from_camera(flange);
    const std::vector<double>& at = scene.viewpoints[i].position_mm;
    EXPECT_LT((seen.translation_mm - Eigen::Vector3d(at[0], at[1], at[2])).norm(), 1e-6);
    EXPECT_LT((seen.rotation.col(2) + seen.translation_mm.normalized()).norm(), 1e-6);
  }
  // The first view: the flange 180 mm and the part's 80 mm above the camera.
  EXPECT_NEAR(file.plan.views[0].base_from_flange.translation().z(), 70.0 + 180.0 + 80.0, 1e-6);
  EXPECT_EQ(result["views"][2]["outcome"], "collision");
  EXPECT_TRUE(result["views"][2]["nearest_base_from_camera"].is_null());
  ASSERT_TRUE(file.plan.views[2].nearest_base_from_flange.has_value());
  EXPECT_EQ(result["views"][3]["outcome"], "unreachable");
  EXPECT_EQ(result["paths"].size(), 3U);
}

TEST_F(PlanStudyTest, RefusesWhatAHeldSceneCannotHave) {
  const std::string scene = held_scene();
  const auto changed = [&scene](const std::string& from, const std::string& to) {
    std::string text = scene;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_THAT(problem(changed("mount = \"camera\"", "mount = \"scene\""), kCell),
              HasSubstr("lighting.ring.mount: is \"scene\""));
  EXPECT_THAT(problem(changed("[cell.flange_from_part]\ntranslation_mm = [0, 0, 80]\n", ""), kCell),
              HasSubstr("cell.flange_from_part: is missing"));
  EXPECT_THAT(problem(changed("[cell.flange_from_part]", "[cell.base_from_part]"), kCell),
              HasSubstr("cell.flange_from_part: is missing"));
}

TEST_F(PlanStudyTest, NamesWhatIsMissing) {
  EXPECT_THAT(problem(kScene, kCell), HasSubstr("flange_from_camera: is missing"));
  std::string homeless = kScene + kCalibration;
  const std::string table = "[cell.base_from_part]\ntranslation_mm = [280, -120, 20]\n";
  homeless.erase(homeless.find(table), table.size());
  EXPECT_THAT(problem(homeless, kCell), HasSubstr("base_from_part"));
  EXPECT_THAT(problem(kScene + kCalibration, "[camera]\n"), HasSubstr("has no robot"));
}

TEST_F(PlanStudyTest, NamesWhatIsWrongInTheCell) {
  const std::string scene = kScene + kCalibration;
  EXPECT_THAT(problem(scene, kCell + "[[obstacle]]\nname = \"a\"\n"),
              HasSubstr("an obstacle is either a box or a mesh"));
  EXPECT_THAT(problem(scene, kCell + "[[obstacle]]\nfile = \"none.stl\"\n"),
              HasSubstr("none.stl does not exist"));
  EXPECT_THAT(problem(scene, kCell + "[[body]]\nfrom_mm = [0, 0, 0]\nto_mm = [0, 0, 1]\n"),
              HasSubstr("body.1.radius_mm: is missing"));
  std::string cell = kCell;
  cell.replace(cell.find("margin_mm = 4"), 13, "margin_mm = -1");
  EXPECT_THAT(problem(scene, cell), HasSubstr("planning.margin_mm"));
  cell = kCell;
  cell.replace(cell.find("margin_mm = 4"), 13, "margins_mm = 4");
  EXPECT_THAT(problem(scene, cell), HasSubstr("planning.margins_mm"));
  cell = kCell;
  cell.replace(cell.find("margin_mm = 4"), 13, "joint_min_deg = [0, 0, 400, 0, 0, 0]");
  EXPECT_THAT(problem(scene, cell), HasSubstr("planning.joint_min_deg"));
}

}  // namespace
}  // namespace glint

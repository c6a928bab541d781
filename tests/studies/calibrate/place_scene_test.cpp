// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint calibrate --place SCENE PICTURES...`: a part whose place the pictures hide is found by its
// edges in files, with neither cell nor robot.
#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/csv.h"
#include "core/image/image_io.h"
#include "core/units.h"
#include "hardware/calibration/rotation.h"
#include "tests/studies/calibrate/calibrate_fixture.h"

namespace glint::test {
namespace {
namespace fs = std::filesystem;

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Json = nlohmann::json;

constexpr const char* kScene = R"(schema = 2
[part]
shape = "plate"
length_mm = 48
width_mm = 36
thickness_mm = 5
[material]
type = "diffuse"
reflectance = [0.6]
[camera]
width_px = 204
height_px = 171
focal_x_px = 600
[calibration]
setup = "eye_in_hand"
[calibration.flange_from_camera]
translation_mm = [0, 50, 30]
[sensor]
blur_px = 0.7
bits = 8
full_well_e = 10000
[lighting.ring]
mount = "camera"
inner_radius_mm = 30
outer_radius_mm = 60
height_mm = 80
radiance = [2]
[render.paths]
samples = 8
max_reflections = 1
batches = 2
)";

/// The camera of the scene as a calibration has it: known to a hundredth, its robot to 0.05 mm.
void write_known_camera(const fs::path& folder) {
  fs::create_directories(folder);
  Json covariance = Json::array();
  for (std::size_t i = 0; i < 21; ++i) {
    std::vector<double> row(21, 0.0);
    row[i] = i < 4 ? 0.01 : i < 9 ? 1e-8 : i % 6 >= 3 ? 1e-9 : 1e-4;  // px, mm, rad
    covariance.push_back(row);
  }
  const Json zero = {0.0, 0.0, 0.0};
  const Json still = {{"translation_mm", zero}, {"rotation_vector_rad", zero}};
  const Json board = {
      {"kind", "checkerboard"}, {"cols", 8}, {"rows", 6}, {"square_mm", 4.4}, {"pose", still}};
  const Json lens = {{"width_px", 204},
                     {"height_px", 171},
                     {"focal_px", {600.0, 600.0}},
                     {"center_px", {102.0, 85.5}},
                     {"radial", zero},
                     {"tangential", {0.0, 0.0}}};
  const Json hand_eye = {
      {"to", "flange"}, {"translation_mm", {0.0, 50.0, 30.0}}, {"rotation_vector_rad", zero}};
  const Json noise = {
      {"corner_px", 0.1}, {"robot_deg", 0.01}, {"robot_mm", 0.05}, {"pattern_px", 0.02}};
  write_file(folder / "calibration.json",
             Json{{"intrinsics", lens},
                  {"board", board},
                  {"rms_px", 0.1},
                  {"prediction_rms_px", 0.3},
                  {"covariance", covariance},
                  {"hand_eye", hand_eye},
                  {"noise", noise}}
                 .dump());
  write_file(folder / "calibration.toml",
             "[camera]\nwidth_px = 204\nheight_px = 171\nfocal_x_px = 600\nfocal_y_px = 600\n"
             "center_x_px = 102\ncenter_y_px = 85.5\n[calibration.flange_from_camera]\n"
             "translation_mm = [0, 50, 30]\nsigma_mm = [0.01, 0.01, 0.01]\n"
             "sigma_deg = [0.002, 0.002, 0.002]\n");
}

std::string pose_text(const Isometry3d& pose) {
  const Vector3d turn_deg = kDegPerRad * rotation_vector_rad(pose.linear());
  const Vector3d& at = pose.translation();
  return fmt::format("translation_mm = [{}, {}, {}]\nrotation_vector_deg = [{}, {}, {}]\n",
                     at.x(),
                     at.y(),
                     at.z(),
                     turn_deg.x(),
                     turn_deg.y(),
                     turn_deg.z());
}

/// A camera 180 mm before the part, tilted.
Isometry3d flange_at(const Isometry3d& base_from_part, double tilt_x_deg, double tilt_y_deg) {
  Isometry3d pose = base_from_part;
  pose.rotate(Eigen::AngleAxisd(tilt_x_deg * kRadPerDeg, Vector3d::UnitX()));
  pose.rotate(Eigen::AngleAxisd(tilt_y_deg * kRadPerDeg, Vector3d::UnitY()));
  pose.translate(Vector3d(0.0, 0.0, 180.0));
  pose.rotate(Eigen::AngleAxisd(kPi, Vector3d::UnitX()));
  return pose * Eigen::Translation3d(0.0, -50.0, -30.0);
}

Isometry3d true_place() {
  Vector6d six;
  six << 0.01, -0.02, 1.2, 280.0, -120.0, 20.0;
  return motion_of(six);
}

/// Of the poses that are told.
constexpr std::array<std::array<double, 3>, 4> kErrors_mm = {
    {{0.04, 0.0, -0.03}, {-0.03, 0.05, 0.02}, {0.0, -0.04, 0.04}, {0.03, 0.02, -0.04}}};

/// Pictures of a part that lies 1.2 mm and half a degree from where its scene says, and poses that
/// are some hundredths of a millimetre off.
class PlaceScene : public CalibrateVerb {
 protected:
  PlaceScene() {
    Isometry3d about = true_place();
    about.rotate(Eigen::AngleAxisd(0.5 * kRadPerDeg, Vector3d(0.3, -0.2, 0.9).normalized()));
    about.translate(Vector3d(0.9, -0.7, 0.4));
    write_file(folder_ / "part.toml", kScene + ("[cell.base_from_part]\n" + pose_text(about)));
    std::string truth = kScene + ("[cell.base_from_part]\n" + pose_text(true_place()));
    poses_ = "name,x_mm,y_mm,z_mm,rx,ry,rz\n";
    const std::vector<std::pair<double, double>> tilts = {{0, 0}, {20, 5}, {-15, 15}, {5, -20}};
    for (std::size_t i = 0; i < tilts.size(); ++i) {
      const Isometry3d pose = flange_at(about, tilts[i].first, tilts[i].second);
      truth += "[[viewpoint]]\n[viewpoint.base_from_flange]\n" + pose_text(pose);
      const Vector3d at = pose.translation() + Vector3d(kErrors_mm[i].data());
      const Vector3d turn = rotation_vector_rad(pose.linear());
      poses_ += csv_row_of(fmt::format("view_{:02}.png", i + 1),
                           at.x(),
                           at.y(),
                           at.z(),
                           turn.x(),
                           turn.y(),
                           turn.z());
    }
    write_file(folder_ / "truth.toml", truth);
    write_file(folder_ / "poses.csv", poses_);
    write_known_camera(folder_ / "camera");
  }

  /// The pictures, as a person would have them in a folder.
  void photograph() {
    const ProgramResult rendered =
        glint_in(folder_, {"render", "truth.toml", "--out", "truth", "--quiet"});
    ASSERT_EQ(rendered.code, 0) << rendered.err;
    for (int i = 1; i <= 4; ++i) {
      pictures_.push_back(fmt::format("view_{:02}.png", i));
      fs::copy_file(folder_ / fmt::format("truth/view_{:02}/aspect.png", i),
                    folder_ / pictures_.back());
    }
    fs::remove_all(folder_ / "truth");
  }

  Arguments pictures_;
  std::string poses_;
  const Arguments placed_ = {"--place", "part.toml", "--camera", "camera", "--poses", "poses.csv"};
};

TEST_F(PlaceScene, ByEdgesInPicturesOfAFolder) {
  photograph();
  const Json result = calibrate_json(pictures_, placed_);
  const Json& found = result["base_from_part"];
  Vector6d six;
  for (std::size_t i = 0; i < 3; ++i) {
    six[static_cast<Eigen::Index>(i)] = found["rotation_vector_rad"][i].get<double>();
    six[static_cast<Eigen::Index>(i) + 3] = found["translation_mm"][i].get<double>();
  }
  const Vector6d off = six_of(motion_of(six).inverse() * true_place());
  const double sigma_mm = found["sigma_mm"].get<double>();
  EXPECT_LT(sigma_mm, 0.2);
  EXPECT_LT(off.tail<3>().norm(), 3.0 * sigma_mm) << "it began 1.2 mm off";
  EXPECT_LT(off.head<3>().norm() * kDegPerRad, 3.0 * found["sigma_deg"].get<double>());
  EXPECT_LT(off.head<3>().norm() * kDegPerRad, 0.1) << "it began half a degree off";
  EXPECT_EQ(result["placements"][0]["by"], "edges");
  EXPECT_EQ(result["placements"][0]["pictures"], 4);
  EXPECT_GE(result["passes"], 2);
  EXPECT_EQ(Json::parse(read_file(folder_ / "out/placement.json"))["base_from_part"], found);

  // A scene takes it as it takes every placement.
  std::string scene = read_file(folder_ / "part.toml");
  scene = "include = [\"out/placement.toml\"]\n" + scene.substr(0, scene.find("[cell.")) +
          "[[viewpoint]]\n[viewpoint.base_from_flange]\n" +
          pose_text(flange_at(true_place(), 0.0, 0.0));
  write_file(folder_ / "scene.toml", scene);
  const ProgramResult masks =
      glint_in(folder_, {"render", "scene.toml", "--masks", "--out", "masks", "--quiet"});
  EXPECT_EQ(masks.code, 0) << masks.err;

  fs::remove_all(folder_ / "out");
  write_file(folder_ / "poses.csv", poses_.substr(0, poses_.find("view_02")));
  expect_refused({pictures_[0]}, placed_, "found in 1 of 1 pictures, must be in two or more");
}

TEST_F(PlaceScene, RefusesWhatDoesNotGoTogether) {
  const Arguments pictures = {"a.png", "b.png"};
  const std::string two = poses_.substr(0, poses_.find("view_03"));
  write_file(folder_ / "two.csv", edited(two, {{"view_01", "a"}, {"view_02", "b"}}));
  for (const std::string& name : pictures) {
    write_png(folder_ / name, ImageF(204, 171, 0.3F), PixelDepth::k8Bit);
  }
  write_png(folder_ / "small.png", ImageF(100, 80, 0.3F), PixelDepth::k8Bit);
  const auto with = [](const std::string& scene, Arguments more) {
    more.insert(more.begin(), {"--place", scene});
    return more;
  };
  const Arguments known = {"--camera", "camera", "--poses", "two.csv"};
  expect_refused({}, with("part.toml", known), "PICTURES: there are none");
  expect_refused(pictures, with("part.toml", {"--poses", "two.csv"}), "--camera: is missing");
  expect_refused(pictures, with("part.toml", {"--camera", "camera"}), "--poses: is missing");
  expect_refused({"small.png", "a.png"},
                 with("part.toml", known),
                 "small.png: has 100 x 80 pixels, the camera of --camera 204 x 171");
  write_file(folder_ / "nowhere.toml", kScene);
  expect_refused(
      pictures, with("nowhere.toml", known), "nowhere.toml: cell.base_from_part: is missing");
  expect_refused(pictures,
                 with("part.toml", {"--place", "part.toml"}),
                 "--place part.toml: a scene stands alone");
  expect_refused(pictures, with("part.toml", known), "has one grey value all over");
}

}  // namespace
}  // namespace glint::test

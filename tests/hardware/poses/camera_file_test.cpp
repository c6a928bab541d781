// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/poses/camera_file.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "core/error.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string camera_error(const std::string& text, const std::string& ending) {
  try {
    parse_camera_file(text, "cam" + ending, ending);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "no error";
}

const std::string kOpenCv =
    "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\ncamera_matrix: !!opencv-matrix\n"
    "   rows: 3\n   cols: 3\n   dt: d\n   data: [ 500., 0., 320., 0., 501., 240., 0., 0., 1. ]\n"
    "distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n"
    "   data: [ -0.1, 0.02, 0.001, -0.002, 0.003 ]\n";

TEST(CameraFile, ReadsOpenCvsYamlAndCountsPixelsGlintsWay) {
  const CameraFile camera = parse_camera_file(kOpenCv, "cam.yaml", ".yaml");
  EXPECT_EQ(camera.intrinsics.width_px, 640);
  EXPECT_EQ(camera.intrinsics.focal_px, Eigen::Vector2d(500, 501));
  EXPECT_EQ(camera.intrinsics.center_px, Eigen::Vector2d(320.5, 240.5));
  EXPECT_EQ(camera.intrinsics.radial[2], 0.003);
  EXPECT_EQ(camera.intrinsics.tangential[1], -0.002);
}

TEST(CameraFile, ReadsOpenCvsXml) {
  const CameraFile camera = parse_camera_file(
      "<?xml version=\"1.0\"?>\n<opencv_storage><camera_matrix "
      "type_id=\"opencv-matrix\"><rows>3</rows>"
      "<cols>3</cols><dt>d</dt><data>\n 500. 0. 320. 0. 501. 240.\n 0. 0. 1.</data></camera_matrix>"
      "</opencv_storage>\n",
      "cam.xml",
      ".xml");
  EXPECT_EQ(camera.intrinsics.focal_px, Eigen::Vector2d(500, 501));
  EXPECT_EQ(camera.intrinsics.center_px, Eigen::Vector2d(320.5, 240.5));
}

TEST(CameraFile, ReadsTheTableOfAScene) {
  const CameraFile camera = parse_camera_file(
      "[camera]\nwidth_px = 640\nheight_px = 480\nfocal_x_px = 500\ncenter_x_px = 321\n"
      "center_y_px = 241\nk1 = -0.1\n",
      "cam.toml",
      ".toml");
  EXPECT_EQ(camera.intrinsics.center_px, Eigen::Vector2d(321, 241));
  EXPECT_EQ(camera.intrinsics.radial[0], -0.1);
}

/// 25 mm at f/8, focused at 400 mm: image distance 25 * 400 / 375 = 26.667 mm, pupil 3.125 mm.
/// A blur of 0.005 mm is 3.125 * 26.667 * |1/400 - 1/z| mm: 1/z = 1/400 +- 6e-5.
TEST(CameraFile, ReadsWhereTheLensOfASceneIsSharp) {
  const CameraFile camera = parse_camera_file(
      "[camera]\nwidth_px = 640\nheight_px = 480\npixel_um = 5\nfocal_mm = 25\n"
      "object_pixel_mm = 0\n[lens]\nfocus_mm = 400\nf_number = 8\n",
      "cam.toml",
      ".toml");
  EXPECT_NEAR(camera.sharp_near_mm, 1.0 / (1.0 / 400.0 + 6e-5), 1e-6);
  EXPECT_NEAR(camera.sharp_far_mm, 1.0 / (1.0 / 400.0 - 6e-5), 1e-6);
  EXPECT_NEAR(camera.intrinsics.focal_px.x(), 25.0 * 400.0 / 375.0 / 0.005, 1e-6);
  EXPECT_THAT(camera_error("[camera]\nfocal_x_px = 900\n[lens]\nf_number = 8\n", ".toml"),
              HasSubstr("lens.f_number: needs focus_mm"));
}

TEST(CameraFile, ReadsAViSPCamera) {
  const fs::path file = fs::path(GLINT_SHARED_DIR) / "data/field/handeye_franka/franka_camera.xml";
  if (!fs::exists(file)) {
    GTEST_SKIP() << "no " << file;
  }
  const CameraFile camera = read_camera_file(file);
  EXPECT_EQ(camera.kind, "ViSP");
  EXPECT_EQ(camera.intrinsics.height_px, 480);
  EXPECT_EQ(camera.intrinsics.focal_px.x(), 607.5931396484375);
  EXPECT_EQ(camera.intrinsics.center_px.y(), 243.25529479980469 + 0.5);
}

TEST(CameraFile, TellsWhereSomethingIsWrong) {
  EXPECT_THAT(camera_error("a: 1\n", ".yaml"),
              HasSubstr("cam.yaml:1:1: camera_matrix: is missing"));
  EXPECT_THAT(camera_error("K: [500, 1, 320, 0, 500, 240, 0, 0, 1]\n", ".yaml"),
              HasSubstr("cam.yaml:1:4: camera_matrix: must be fx 0 cx"));
  EXPECT_THAT(camera_error("K: [500, 0, 320, 0, -500, 240, 0, 0, 1]\n", ".yaml"),
              HasSubstr("must be > 0"));
  EXPECT_THAT(camera_error("K: [500, 0, .nan, 0, 500, 240, 0, 0, 1]\n", ".yaml"),
              HasSubstr("cam.yaml:1:13: camera_matrix: must be a finite number"));
  EXPECT_THAT(camera_error("K: [1, 0, 3, 0, 5, 2, 0, 0, 1]\nD: [0, 0, 0, 0, 0, 1]\n", ".yaml"),
              HasSubstr("cam.yaml:2:4: distortion_coefficients: number 6 is 1"));
  EXPECT_THAT(camera_error("<root><camera><model><type>x</type></model></camera></root>", ".xml"),
              HasSubstr("type: must be perspectiveProjWithDistortion"));
  EXPECT_THAT(camera_error("[camera]\nwidht_px = 5\n", ".toml"),
              HasSubstr("cam.toml:2:1: camera.widht_px: unknown key, the nearest known one"));
  EXPECT_THAT(camera_error("x = 1\n[a]\n", ".toml"), HasSubstr("camera: is missing"));
}

}  // namespace
}  // namespace glint

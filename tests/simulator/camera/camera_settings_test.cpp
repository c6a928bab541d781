// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/camera/camera_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"

namespace glint {
namespace {

CameraSettings read_camera(const std::string& text, std::vector<Problem>& errors) {
  const ConfigNode root = parse_toml(text, "s.toml");
  CameraSettings settings;
  KeyReader reader(&root, "camera", errors);
  visit_keys(reader, settings);
  reader.report_unknown();
  return settings;
}

// 16 mm lens on 3.45 um pixels: 16 / 0.00345 = 4637.68 px.
TEST(CameraSettings, FocalLengthFollowsFromTheDataSheet) {
  std::vector<Problem> errors;
  const CameraSettings s =
      read_camera("width_px = 2448\nheight_px = 2048\npixel_um = 3.45\nfocal_mm = 16\n", errors);
  EXPECT_TRUE(errors.empty());
  EXPECT_NEAR(intrinsics_of(s).focal_px.x(), 4637.681, 1e-3);
  EXPECT_DOUBLE_EQ(intrinsics_of(s).center_px.x(), 1224.0);
}

// 0.15 mm on the part at 600 mm: 600 / 0.15 = 4000 px whatever the sensor's pixel.
TEST(CameraSettings, FocalLengthFollowsFromThePixelOnThePart) {
  std::vector<Problem> errors;
  const CameraSettings s =
      read_camera("object_pixel_mm = 0.15\nworking_distance_mm = 600\n", errors);
  EXPECT_TRUE(errors.empty());
  EXPECT_DOUBLE_EQ(intrinsics_of(s).focal_px.y(), 4000.0);
}

TEST(CameraSettings, GivingTheFocalLengthTwiceIsAnError) {
  std::vector<Problem> errors;
  read_camera("object_pixel_mm = 0.15\nfocal_mm = 16\n", errors);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_THAT(errors[0].message(), ::testing::StartsWith("s.toml:1:"));
}

TEST(CameraSettings, DefaultViewLooksDownWithXToTheRightAndYUp) {
  const RigidTransform pose = camera_from_world(default_viewpoint({.working_distance_mm = 600.0}));
  const Eigen::Vector3d right = pose * Eigen::Vector3d(1, 0, 0);
  const Eigen::Vector3d up = pose * Eigen::Vector3d(0, 1, 0);
  EXPECT_LT((right - Eigen::Vector3d(1, 0, 600)).norm(), 1e-12);
  EXPECT_LT((up - Eigen::Vector3d(0, -1, 600)).norm(), 1e-12);  // +y of the image is down
  EXPECT_NEAR(pose.rotation.determinant(), 1.0, 1e-12);
}

TEST(Viewpoint, UpAlongTheViewIsAnErrorWithItsPlace) {
  const ConfigNode root = parse_toml("direction = [0, 0, -1]\nup = [0, 0, 2]\n", "v.toml");
  std::vector<Problem> errors;
  Viewpoint viewpoint;
  KeyReader reader(&root, "viewpoint.0", errors);
  visit_keys(reader, viewpoint);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(errors[0].message(),
            "v.toml:2:1: viewpoint.0.up: must not be zero or parallel to direction");
}

}  // namespace
}  // namespace glint

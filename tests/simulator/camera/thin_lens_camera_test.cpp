// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/camera/thin_lens_camera.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "core/error.h"
#include "core/rng.h"
#include "core/units.h"
#include "simulator/camera/lens_settings.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// The seed's camera: 12 mm lens focused at 146 mm, 2448 x 2050 pixels of 3.45 um, f/4.
CameraSettings gear_camera() {
  return {.width_px = 2448,
          .height_px = 2050,
          .pixel_mm = 0.00345,
          .focal_mm = 12.0,
          .object_pixel_mm = 0.0,
          .working_distance_mm = 146.0,
          .k1 = -0.1,
          .p1 = 1e-3};
}

PinholeCamera make_pinhole(const CameraSettings& camera, const LensSettings& lens) {
  return PinholeCamera(intrinsics_of(camera, lens));
}

ThinLensCamera make_camera(const CameraSettings& camera, const LensSettings& lens) {
  const LensGeometry g = lens_geometry(camera, lens);
  return ThinLensCamera(make_pinhole(camera, lens),
                        {.aperture_mm = g.aperture_mm, .focus_mm = g.focus_mm});
}

Vector3d at_depth(const CameraRay& ray, double depth_mm) {
  return ray.origin_mm + (depth_mm - ray.origin_mm.z()) / ray.direction.z() * ray.direction;
}

TEST(ThinLensCamera, AllRaysOfAPixelMeetInThePlaneInFocus) {
  const LensSettings lens = {.focus_mm = 146.0, .f_number = 4.0};
  const ThinLensCamera camera = make_camera(gear_camera(), lens);
  const PinholeCamera pinhole = make_pinhole(gear_camera(), lens);
  Rng rng(1, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const Vector2d pixel_px(rng.uniform(0, 2448), rng.uniform(0, 2050));
    const Vector3d through = *pinhole.ray_through(pixel_px);
    const Vector3d middle = through * 146.0 / through.z();
    for (int k = 0; k < 8; ++k) {
      const CameraRay ray = *camera.sample(pixel_px, {rng.uniform(), rng.uniform()});
      EXPECT_NEAR(ray.direction.norm(), 1.0, 1e-14);
      EXPECT_EQ(ray.origin_mm.z(), 0.0);
      EXPECT_LT((at_depth(ray, 146.0) - middle).norm(), 1e-9);
    }
  }
}

// Rays from the pupil's rim cross another plane in a circle of diameter A |z - d| / d, which is
// seen under v / z: A v |z - d| / (z d), the circle of confusion.
TEST(ThinLensCamera, BlurOffThePlaneIsTheCircleOfConfusion) {
  CameraSettings settings = gear_camera();
  settings.k1 = settings.p1 = 0.0;
  const LensSettings lens = {.focus_mm = 146.0, .f_number = 4.0};
  const LensGeometry g = lens_geometry(settings, lens);
  const ThinLensCamera camera = make_camera(settings, lens);
  for (const double depth_mm : {60.0, 140.0, 145.0, 150.0, 300.0, 5000.0}) {
    double widest_mm = 0.0;
    for (int k = 0; k <= 64; ++k) {
      // The square's edge is the disc's rim; opposite points differ by half a turn.
      const CameraRay one = *camera.sample({400.0, 1900.0}, {1.0, k / 64.0});
      const CameraRay other = *camera.sample({400.0, 1900.0}, {0.0, 1.0 - k / 64.0});
      widest_mm = std::max(widest_mm, (at_depth(one, depth_mm) - at_depth(other, depth_mm)).norm());
    }
    const double on_sensor_mm = widest_mm * g.image_distance_mm / depth_mm;
    EXPECT_NEAR(on_sensor_mm,
                circle_of_confusion_mm(g.aperture_mm, g.focus_mm, g.image_distance_mm, depth_mm),
                1e-12);
  }
}

// f = 12, f/4: A = 3. d = 146, v = 12 * 146 / 134 = 13.0746. At z = 150:
// 3 * 12 / 134 * 4 / 150 = 0.00716418 mm, 2.08 px of 3.45 um.
TEST(CircleOfConfusion, MatchesAHandWorkedExample) {
  EXPECT_NEAR(circle_of_confusion_mm(3.0, 146.0, 12.0 * 146.0 / 134.0, 150.0), 0.00716418, 1e-8);
  EXPECT_EQ(circle_of_confusion_mm(3.0, 146.0, 13.0, 146.0), 0.0);
  // Focused at infinity the blur of a point at z is A f / z.
  EXPECT_NEAR(circle_of_confusion_mm(3.0, std::numeric_limits<double>::infinity(), 12.0, 600.0),
              0.06,
              1e-15);
}

TEST(DepthOfField, EndsWhereTheBlurHasTheGivenWidth) {
  const DepthOfField depth = depth_of_field(3.0, 146.0, 13.0746, 0.00345);
  EXPECT_LT(depth.near_mm, 146.0);
  EXPECT_GT(depth.far_mm, 146.0);
  EXPECT_NEAR(circle_of_confusion_mm(3.0, 146.0, 13.0746, depth.near_mm), 0.00345, 1e-12);
  EXPECT_NEAR(circle_of_confusion_mm(3.0, 146.0, 13.0746, depth.far_mm), 0.00345, 1e-12);
}

// Beyond the hyperfocal distance A v / c nothing limits the far end.
TEST(DepthOfField, IsOpenBeyondTheHyperfocalDistanceAndForAPinhole) {
  EXPECT_TRUE(std::isinf(depth_of_field(1.0, 5000.0, 10.0, 0.00345).far_mm));
  EXPECT_FALSE(std::isinf(depth_of_field(1.0, 2000.0, 10.0, 0.00345).far_mm));
  EXPECT_EQ(depth_of_field(0.0, 146.0, 13.0, 0.00345).near_mm, 0.0);
}

TEST(ThinLensCamera, WithoutApertureIsThePinholeBitForBit) {
  const ThinLensCamera camera = make_camera(gear_camera(), {.focus_mm = 146.0});
  const PinholeCamera pinhole = make_pinhole(gear_camera(), {.focus_mm = 146.0});
  Rng rng(2, Stream::kTest, 0);
  for (int i = 0; i < 1000; ++i) {
    const Vector2d pixel_px(rng.uniform(0, 2448), rng.uniform(0, 2050));
    const CameraRay ray = *camera.sample(pixel_px, {rng.uniform(), rng.uniform()});
    EXPECT_EQ(ray.direction, *pinhole.ray_through(pixel_px));
    EXPECT_EQ(ray.origin_mm, Vector3d::Zero());
  }
}

TEST(ThinLensCamera, TendsToThePinholeAsTheApertureCloses) {
  const PinholeCamera pinhole(intrinsics_of(gear_camera()));
  const ThinLensCamera camera(pinhole, {.aperture_mm = 1e-9, .focus_mm = 146.0});
  const CameraRay ray = *camera.sample({10.0, 20.0}, {0.9, 0.1});
  EXPECT_LT((ray.direction - *pinhole.ray_through({10.0, 20.0})).norm(), 1e-11);
}

TEST(ThinLensCamera, RefusesAnApertureOrFocusThatIsNone) {
  const PinholeCamera pinhole(intrinsics_of(gear_camera()));
  EXPECT_THROW(ThinLensCamera(pinhole, {.aperture_mm = -1.0}), ConfigError);
  EXPECT_THROW(ThinLensCamera(pinhole, {.aperture_mm = 1.0, .focus_mm = 0.0}), ConfigError);
  EXPECT_THROW(ThinLensCamera(pinhole, {.aperture_mm = std::nan("")}), ConfigError);
}

// Even in area: a quarter of the samples within half the radius; E[x] = 0, E[x^2] = 1/4.
TEST(DiscFromSquare, SpreadsEvenlyOverTheUnitDisc) {
  int inner = 0;
  Vector2d sum = Vector2d::Zero();
  Vector2d squares = Vector2d::Zero();
  constexpr int kSide = 200;
  for (int j = 0; j < kSide; ++j) {
    for (int i = 0; i < kSide; ++i) {
      const Vector2d p = disc_from_square({(i + 0.5) / kSide, (j + 0.5) / kSide});
      ASSERT_LE(p.norm(), 1.0);
      inner += p.norm() < 0.5 ? 1 : 0;
      sum += p;
      squares += p.cwiseAbs2();
    }
  }
  EXPECT_NEAR(inner / (1.0 * kSide * kSide), 0.25, 1e-3);
  EXPECT_LT(sum.norm(), 1e-6 * kSide * kSide);
  EXPECT_NEAR(squares.x() / (kSide * kSide), 0.25, 1e-3);
  EXPECT_NEAR(squares.y() / (kSide * kSide), 0.25, 1e-3);
  EXPECT_EQ(disc_from_square({0.5, 0.5}), Vector2d::Zero());
}

// v = 12 * 146 / 134 = 13.074627 mm = 3789.747 px. Object pixel 146 / 3789.747 = 0.0385250 mm
// (= 3.45 um * 134 / 12); field 2448 * 0.038525 = 94.309 mm by 2050 * 0.038525 = 78.976 mm.
// Full angle across: 2 atan(1224 / 3789.747) = 0.62474 rad.
TEST(LensGeometry, OfTheGearCameraFollowsFromItsDataSheet) {
  const LensGeometry g = lens_geometry(gear_camera(), {.focus_mm = 146.0, .f_number = 4.0});
  EXPECT_NEAR(g.focal_mm, 12.0, 1e-12);
  EXPECT_NEAR(g.image_distance_mm, 13.074627, 1e-6);
  EXPECT_NEAR(g.aperture_mm, 3.0, 1e-12);
  EXPECT_NEAR(g.object_pixel_mm, 0.038525, 1e-9);
  EXPECT_NEAR(g.sensor_mm.x(), 8.4456, 1e-9);
  EXPECT_NEAR(g.field_of_view_mm.x(), 94.3092, 1e-4);
  EXPECT_NEAR(g.field_of_view_mm.y(), 78.97625, 1e-4);
  EXPECT_NEAR(g.view_angle_rad.x(), 2.0 * std::atan(1224.0 / 3789.747), 1e-6);
  EXPECT_LT(g.near_mm, 146.0);
  EXPECT_GT(g.far_mm, 146.0);
}

// The same camera told by its object pixel: the focal length comes back.
TEST(LensGeometry, AgreesWhetherFocalLengthOrObjectPixelIsGiven) {
  CameraSettings by_pixel = gear_camera();
  by_pixel.focal_mm = 0.0;
  by_pixel.object_pixel_mm = 0.00345 * 134.0 / 12.0;
  const LensSettings lens = {.focus_mm = 146.0, .f_number = 4.0};
  const LensGeometry one = lens_geometry(gear_camera(), lens);
  const LensGeometry other = lens_geometry(by_pixel, lens);
  EXPECT_NEAR(other.focal_mm, 12.0, 1e-12);
  EXPECT_NEAR(other.image_distance_mm, one.image_distance_mm, 1e-12);
  EXPECT_NEAR(other.field_of_view_mm.x(), one.field_of_view_mm.x(), 1e-10);
}

TEST(LensGeometry, WithoutAFocusIsThePlainCamera) {
  const PinholeIntrinsics plain = intrinsics_of(gear_camera());
  EXPECT_EQ(intrinsics_of(gear_camera(), LensSettings{}).focal_px, plain.focal_px);
  EXPECT_TRUE(std::isinf(lens_geometry(gear_camera(), {}).focus_mm));
  EXPECT_EQ(lens_geometry(gear_camera(), {}).aperture_mm, 0.0);
}

TEST(LensGeometry, RefusesAFocusWithinTheFocalLength) {
  EXPECT_THROW(lens_geometry(gear_camera(), {.focus_mm = 12.0}), ConfigError);
}

TEST(LensSettings, AnApertureNeedsAFocus) {
  const ConfigNode root = parse_toml("f_number = 4\n", "s.toml");
  std::vector<Problem> errors;
  LensSettings settings;
  KeyReader reader(&root, "lens", errors);
  visit_keys(reader, settings);
  ASSERT_EQ(errors.size(), 1U);
  EXPECT_EQ(
      errors[0].message(),
      "s.toml:1:1: lens.f_number: needs focus_mm, the distance at which the picture is sharp");
}

}  // namespace
}  // namespace glint

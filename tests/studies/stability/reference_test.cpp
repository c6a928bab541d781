// SPDX-License-Identifier: GPL-3.0-or-later
//
// The reference tracer of glint stability against closed forms.
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/toml.h"
#include "core/rng.h"
#include "core/units.h"
#include "studies/stability/reference/reference_light.h"
#include "studies/stability/reference/reference_picture.h"
#include "studies/stability/reference/reference_surface.h"
#include "studies/stability/stability_sweeps.h"

namespace glint::stability {
namespace {

using Eigen::Vector3d;

SceneSettings scene_with_sets(const std::vector<KeyValue>& sets) {
  const Sweep sweep{.sets = sets};
  std::vector<Problem> problems;
  SceneSettings scene =
      read_scene(scene_tables_of(parse_toml(base_scene_text(), "base"), sweep, {}), problems);
  EXPECT_TRUE(problems.empty()) << (problems.empty() ? "" : problems.front().message());
  return scene;
}

/// A small plate without dents, slot and blur, far from the wall's ends.
std::vector<KeyValue> plain_plate() {
  return {{"part.shape", "plate"},
          {"camera.width_px", "24"},
          {"camera.height_px", "12"},
          {"lighting.tunnel.slot_mm", "0"},
          {"sensor.blur_px", "0"},
          {"lighting.tunnel.blocks_view", "false"},
          {"defects", "{}"},
          {"sensor.gain", "1"}};
}

// t^2 - 5 t + 6 = 0 has the roots 2 and 3; t^2 - 2e8 t + 1 = 0 has 5e-9, which the textbook's
// formula loses.
TEST(QuadraticRoots, OfAHandWorkedEquation) {
  const auto roots = quadratic_roots(1.0, -2.5, 6.0).value();
  EXPECT_DOUBLE_EQ(roots[0], 2.0);
  EXPECT_DOUBLE_EQ(roots[1], 3.0);
  EXPECT_NEAR(quadratic_roots(1.0, -1e8, 1.0).value()[0], 5e-9, 1e-20);
  EXPECT_FALSE(quadratic_roots(1.0, 0.0, 1.0));
}

// From (0, 0, 200) down on a sphere of radius 25 around (0, 0, -20): the top is at 5.
TEST(ReferenceSurface, SphereIsMetAtItsTopAndEverywhereOnIt) {
  const ReferencePart sphere{.shape = ReferencePart::Shape::kSphere,
                             .radius_mm = 25.0,
                             .centre_z_mm = -20.0,
                             .base_z_mm = -30.0};
  const auto top = intersect(sphere, {0, 0, 200}, -Vector3d::UnitZ()).value();
  EXPECT_NEAR((top.point_mm - Vector3d(0, 0, 5)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((top.normal - Vector3d::UnitZ()).norm(), 0.0, 1e-12);
  Rng rng(5, Stream::kTest, 0);
  const auto place = [&] { return 40.0 * rng.uniform() - 20.0; };
  for (int i = 0; i < 1000; ++i) {
    const Vector3d origin(place(), place(), 300.0);
    const Vector3d direction = (Vector3d(place(), place(), -20.0) - origin).normalized();
    if (const auto hit = intersect(sphere, origin, direction)) {
      EXPECT_NEAR((hit->point_mm - Vector3d(0, 0, -20)).norm(), 25.0, 1e-10);
    }
  }
}

// A dent 0.5 mm deep: straight above its middle the ray ends 0.5 mm below the plate, and one sigma
// beside it the slope is 0.5 / (2 sqrt(e)) = 0.15163.
TEST(ReferenceSurface, DentIsAsDeepAndAsSteepAsItsProfile) {
  ReferencePart plate{.half_mm = {50.0, 50.0}};
  plate.dents = {{.label = "dent_1", .height_mm = -0.5, .sigma_mm = 2.0}};
  const auto middle = intersect(plate, {0, 0, 100}, -Vector3d::UnitZ()).value();
  EXPECT_NEAR(middle.point_mm.z(), -0.5, 1e-12);
  const auto flank = intersect(plate, {2, 0, 100}, -Vector3d::UnitZ()).value();
  EXPECT_NEAR(-flank.normal.x() / flank.normal.z(), 0.5 / (2.0 * std::sqrt(std::exp(1.0))), 1e-9);
  EXPECT_NEAR(radii_from(plate, plate.dents[0], {4.0, 0.0, -0.2}), 1.0, 1e-12);
  EXPECT_FALSE(intersect_again(plate, middle, Vector3d::UnitZ()));
  const auto other_side = intersect_again(plate, middle, Vector3d(1.0, 0.0, 0.02).normalized());
  ASSERT_TRUE(other_side);
  EXPECT_LT(other_side->normal.x(), 0.0) << "it faces the ray";
}

// From the axis at 45 degrees a circle of radius 200 is met at y = 141.42; from there x grows by as
// much as the ray goes along.
TEST(WallX, OfARayFromTheAxis) {
  const ReferenceWall wall{.half_width_mm = 200.0, .height_mm = 200.0, .slot_mm = 30.0};
  const Vector3d direction = Vector3d(1.0, 1.0, 1.0).normalized();
  EXPECT_NEAR(wall_x_mm(wall, Vector3d::Zero(), direction), 200.0 / std::sqrt(2.0), 1e-9);
  EXPECT_TRUE(std::isnan(wall_x_mm(wall, Vector3d::Zero(), Vector3d::UnitZ()))) << "the slot";
  EXPECT_TRUE(std::isnan(wall_x_mm(wall, Vector3d::Zero(), -Vector3d::UnitZ()))) << "no wall";
}

// A camera at 600 mm above a plate 1.5 mm thick above the origin sees x of the plate mirrored: the
// ray goes on and meets a flat enough wall at x (1 + d / 598.5). On y = 0 the wall is 198.5 mm
// above the plate, so the wall's x is 1.3317 times that of the plate.
TEST(ReferenceRays, MirrorAtAPlateIsAStretch) {
  const ReferenceScene scene = reference_scene(scene_with_sets(plain_plate()));
  EXPECT_NEAR(scene.part.centre_z_mm, 1.5, 1e-12);
  const Vector3d eye(0.0, 0.0, 600.0);
  const Vector3d place(40.0, 0.0, 1.5);
  Vector3d direction = (place - eye).normalized();
  const auto hit = intersect(scene.part, eye, direction).value();
  EXPECT_NEAR((hit.point_mm - place).norm(), 0.0, 1e-10);
  direction.z() *= -1.0;
  EXPECT_NEAR(wall_x_mm(scene.wall, hit.point_mm, direction), 40.0 * (1.0 + 198.5 / 598.5), 1e-9);
}

// Over a whole period every place is bright for the duty's share of the positions: the mean image
// is the duty, and h is 1.
TEST(ReferenceScores, MeanOfAWholePeriodIsTheDuty) {
  const ReferenceScores scores =
      reference_scores(reference_scene(scene_with_sets(plain_plate())), {.samples = 2});
  EXPECT_NEAR(scores.mean, 0.5, 1e-12);
  EXPECT_NEAR(scores.h_rms, 1.0, 1e-6);
}

// One position and a period of 1e4 mm: the plate shows the wall's x > 0 bright and x < 0 dark.
// Half of the region's pixels are 1: mean 1/2, sigma 1/2, h = 0.
TEST(ReferenceScores, HalfBrightHalfDarkHasNoHomogeneity) {
  auto sets = plain_plate();
  sets.push_back({"scan.positions", "1"});
  sets.push_back({"lighting.tunnel.period_mm", "10000"});
  const ReferenceScores scores =
      reference_scores(reference_scene(scene_with_sets(sets)), {.samples = 2});
  EXPECT_NEAR(scores.mean, 0.5, 1e-12);
  EXPECT_NEAR(scores.h_rms, 0.0, 1e-12);
}

// Blur moves light and makes none. The second pixel beside an edge, blurred by 2 px, holds the mean
// of Phi over [0.5, 1]: with the antiderivative x Phi + phi it is
// (1.08331 - 0.69780) / 0.5 = 0.77102.
TEST(ReferenceScores, BlurOfAnEdgeIsTheErrorFunction) {
  auto sets = plain_plate();
  sets.push_back({"lighting.tunnel.period_mm", "10000"});
  sets.push_back({"sensor.blur_px", "2"});
  const ReferenceScene scene = reference_scene(scene_with_sets(sets));
  const ReferenceRays rays = trace_reference(scene, {.samples = 2});
  const std::vector<double> picture = reference_radiance(scene, rays, 0);
  const std::size_t right_of_edge = 6 * 24 + 13;
  EXPECT_NEAR(picture[right_of_edge], 0.77102, 5e-4);
  EXPECT_NEAR(picture[right_of_edge] + picture[right_of_edge - 3], 1.0, 1e-9);
}

// One electron full well at gain 1: the pixel is full with one electron or more, which happens with
// 1 - exp(-L); the variance is p (1 - p).
TEST(ExpectedGrey, OfOneElectronIsItsChance) {
  const SensorSettings sensor{.gain = 1.0, .blur_px = 0.0, .bits = 8, .full_well_e = 1.0};
  for (const double radiance : {0.0, 0.2, 0.5, 1.0}) {
    const double p = 1.0 - std::exp(-radiance);
    const auto [mean, variance] = expected_grey(sensor, radiance);
    EXPECT_NEAR(mean, p, 1e-12);
    EXPECT_NEAR(variance, p * (1.0 - p), 1e-12);
  }
}

// Below an infinite plane of radiance L a surface has the irradiance pi L; above a square of half
// side a at distance a the disc-free closed form is
// 4 * L * (a / sqrt(a^2 + a^2)) * atan(a / sqrt(2 a^2)) = 4 L / sqrt(2) * atan(1 / sqrt(2)).
TEST(PolygonIrradiance, OfAPlaneAndOfASquare) {
  const auto square = [](double a, double z) {
    return std::array{
        Vector3d(-a, -a, z), Vector3d(a, -a, z), Vector3d(a, a, z), Vector3d(-a, a, z)};
  };
  const Vector3d up = Vector3d::UnitZ();
  EXPECT_NEAR(polygon_irradiance(square(1e5, 1.0), Vector3d::Zero(), up, 2.0), 2.0 * kPi, 1e-3);
  const double expected = 4.0 / std::sqrt(2.0) * std::atan(1.0 / std::sqrt(2.0));
  EXPECT_NEAR(polygon_irradiance(square(3.0, 3.0), Vector3d::Zero(), up, 1.0), expected, 1e-12);
}

TEST(ReferenceScene, RefusesWhatItDoesNotModelByItsKey) {
  for (const auto& [key, value] :
       std::vector<std::pair<std::string, std::string>>{{"lighting.tunnel.dark_reflectance", "0.2"},
                                                        {"lighting.tunnel.shape", "flat"},
                                                        {"camera.k1", "0.01"},
                                                        {"part.radius_along_mm", "-400"}}) {
    try {
      reference_scene(scene_with_sets({{key, value}}));
      ADD_FAILURE() << key << " was taken";
    } catch (const ConfigError& error) {
      EXPECT_THAT(key, ::testing::StartsWith(error.problems().front().key));
    }
  }
}

}  // namespace
}  // namespace glint::stability

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/surface/surface_detail.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/units.h"
#include "tests/simulator/geometry/geometry_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;

HeightFeature dent() {
  return {.label = "dent", .id = 4, .height_mm = -1.6e-3, .sigma_mm = 0.2};
}

HeightFeature scratch() {
  return {.kind = HeightFeature::Kind::kScratch,
          .label = "scratch",
          .id = 9,
          .centre_mm = {5, 0, 0},
          .height_mm = -2e-3,
          .length_mm = 3.0,
          .width_mm = 0.4};
}

// 1.6 um over sigma 0.2 mm: 1.6e-3 / (0.2 x 1.6487) = 4.852 mrad, at r = sigma.
TEST(HeightFeature, HasTheHandWorkedLargestSlope) {
  EXPECT_NEAR(dent().max_slope_rad(), 4.852e-3, 5e-7);
  const SurfaceDetail detail({dent()});
  const auto at_sigma = detail.sample({0.2, 0, 0}, Vector3d::UnitZ());
  EXPECT_NEAR(at_sigma.gradient.x(), 4.852e-3, 5e-7);  // a dent rises outwards
  double largest = 0.0;
  double x = 0.0;
  while (x < 1.0) {
    largest = std::max(largest, detail.sample({x, 0, 0}, Vector3d::UnitZ()).gradient.norm());
    x += 0.001;
  }
  EXPECT_NEAR(largest, dent().max_slope_rad(), 1e-12);
}

// At r = 2 sigma = one radius: h = -1.6 um x exp(-2) = -0.21654 um.
TEST(SurfaceDetail, SamplesHeightAndDistanceOfADent) {
  const SurfaceDetail detail({dent()});
  const auto centre = detail.sample({0, 0, 0}, Vector3d::UnitZ());
  EXPECT_DOUBLE_EQ(centre.height_mm, -1.6e-3);
  EXPECT_EQ(centre.gradient, Vector3d::Zero());
  EXPECT_EQ(centre.feature, 4);
  EXPECT_EQ(centre.normalised_distance, 0.0);
  const auto edge = detail.sample({0, 0.4, 0}, Vector3d::UnitZ());
  EXPECT_NEAR(edge.height_mm, -0.21654e-3, 1e-8);
  EXPECT_DOUBLE_EQ(edge.normalised_distance, 1.0);
  EXPECT_EQ(edge.moved_height_mm, 0.0);
  EXPECT_EQ(detail.sample({0, 1.01, 0}, Vector3d::UnitZ()).feature, -1);
}

TEST(SurfaceDetail, MovesThePositionOnlyWhereAsked) {
  HeightFeature moving = dent();
  moving.moves_position = true;
  EXPECT_DOUBLE_EQ(
      SurfaceDetail({moving, dent()}).sample({0, 0, 0}, Vector3d::UnitZ()).moved_height_mm,
      -1.6e-3);
}

TEST(SurfaceDetail, StaysOnItsSideOfASheet) {
  const SurfaceDetail detail({dent()});
  EXPECT_EQ(detail.sample({0, 0, -0.1}, -Vector3d::UnitZ()).feature, -1);
}

// Width 0.4: sigma 0.1; length 3: a line of 3 - 0.4 = 2.6, so from x = 3.7 to 6.3.
TEST(SurfaceDetail, ScratchIsAsDeepAlongItsLineAndRoundAtItsEnds) {
  const SurfaceDetail detail({scratch()});
  const Vector3d up = Vector3d::UnitZ();
  for (const double x : {3.7, 4.5, 5.0, 6.3}) {
    EXPECT_NEAR(detail.sample({x, 0, 0}, up).height_mm, -2e-3, 1e-12);
    EXPECT_NEAR(detail.sample({x, 0.1, 0}, up).height_mm, -2e-3 * std::exp(-0.5), 1e-12);
  }
  EXPECT_NEAR(detail.sample({6.4, 0, 0}, up).height_mm, -2e-3 * std::exp(-0.5), 1e-12);
  EXPECT_NEAR(detail.sample({6.5, 0, 0}, up).normalised_distance, 1.0, 1e-12);
  EXPECT_NEAR(detail.sample({5.0, -0.2, 0}, up).normalised_distance, 1.0, 1e-12);
}

TEST(SurfaceDetail, GradientMatchesCentralDifferences) {
  Rng rng(31, Stream::kTest, 0);
  constexpr double kStep_mm = 1e-5;
  int inside = 0;
  for (int i = 0; i < 1000; ++i) {
    const RigidTransform pose = random_pose(rng);
    HeightFeature feature = i % 2 == 0 ? dent() : scratch();
    feature.centre_mm = pose.translation_mm;
    feature.u_axis = pose.rotation.col(0);
    feature.v_axis = pose.rotation.col(1);
    feature.normal = pose.rotation.col(2);
    const SurfaceDetail detail({feature});
    const Vector3d p =
        pose * Vector3d(rng.uniform(-1.0, 1.0), rng.uniform(-0.3, 0.3), rng.uniform(-0.1, 0.1));
    const auto sample = detail.sample(p, feature.normal);
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d step = kStep_mm * Vector3d::Unit(axis);
      const double difference = (detail.sample(p + step, feature.normal).height_mm -
                                 detail.sample(p - step, feature.normal).height_mm) /
                                (2.0 * kStep_mm);
      ASSERT_NEAR(sample.gradient[axis], difference, 1e-7);
    }
    inside += sample.feature >= 0 ? 1 : 0;
  }
  EXPECT_GT(inside, 500);
}

TEST(SurfaceDetail, ManyFeaturesSumUpAsIfTriedOneByOne) {
  Rng rng(32, Stream::kTest, 0);
  std::vector<HeightFeature> features;
  for (int i = 0; i < 200; ++i) {
    HeightFeature feature = i % 3 == 0 ? scratch() : dent();
    feature.id = i;
    feature.centre_mm = Vector3d(rng.uniform(-50, 50), rng.uniform(-20, 20), 0.0);
    feature.sigma_mm = rng.uniform(0.1, 2.0);
    features.push_back(feature);
  }
  const SurfaceDetail detail(features);
  std::vector<SurfaceDetail> singles;
  for (const HeightFeature& feature : features) {
    singles.push_back(SurfaceDetail({feature}));
  }
  int touched = 0;
  for (int i = 0; i < 3000; ++i) {
    const Vector3d p(rng.uniform(-60, 60), rng.uniform(-25, 25), rng.uniform(-0.2, 0.2));
    double height_mm = 0.0;
    Vector3d gradient = Vector3d::Zero();
    double nearest = 1e9;
    int nearest_id = -1;
    for (const SurfaceDetail& single : singles) {
      const auto one = single.sample(p, Vector3d::UnitZ());
      height_mm += one.height_mm;
      gradient += one.gradient;
      if (one.feature >= 0 && one.normalised_distance < nearest) {
        nearest = one.normalised_distance;
        nearest_id = one.feature;
      }
    }
    const auto all = detail.sample(p, Vector3d::UnitZ());
    ASSERT_NEAR(all.height_mm, height_mm, 1e-15);
    ASSERT_LT((all.gradient - gradient).norm(), 1e-14);
    ASSERT_EQ(all.feature, nearest_id);
    touched += nearest_id >= 0 ? 1 : 0;
  }
  EXPECT_GT(touched, 300);
}

TEST(SurfaceDetail, WithoutFeaturesIsFlat) {
  const SurfaceDetail detail;
  EXPECT_TRUE(detail.empty());
  EXPECT_EQ(detail.sample({0, 0, 0}, Vector3d::UnitZ()).feature, -1);
}

// One radius is 2 sigma = 0.4 mm; the edge goes from 0.36 to 0.44 mm. In its middle half is left,
// at a quarter, 0.38 mm, t = 3/4: 9/16 (3 - 3/2) = 0.84375 of the stain.
TEST(SurfaceDetail, AStainReflectsLessUpToItsEdge) {
  HeightFeature stain = dent();
  stain.height_mm = 0.0;
  stain.reflectance = 0.6;
  const SurfaceDetail detail({stain});
  const auto reflectance = [&](double x_mm) {
    return detail.sample({x_mm, 0, 0}, Vector3d::UnitZ()).reflectance;
  };
  EXPECT_DOUBLE_EQ(reflectance(0.0), 0.6);
  EXPECT_DOUBLE_EQ(reflectance(0.36), 0.6);
  EXPECT_NEAR(reflectance(0.38), 1.0 - 0.84375 * 0.4, 1e-12);
  EXPECT_NEAR(reflectance(0.40), 0.8, 1e-12);
  EXPECT_DOUBLE_EQ(reflectance(0.44), 1.0);
  EXPECT_EQ(detail.sample({0.1, 0, 0}, Vector3d::UnitZ()).gradient, Vector3d::Zero());
  EXPECT_EQ(SurfaceDetail({stain, stain}).sample({0, 0, 0}, Vector3d::UnitZ()).reflectance, 0.36);
}

// A thousand places further apart than the relief is correlated: the rms scatters by 2 %.
TEST(SurfaceDetail, ARoughStainHasTheStatedSlopeAlongAnyLine) {
  HeightFeature stain = dent();
  stain.height_mm = 0.0;
  stain.roughness_rad = 0.02;
  const SurfaceDetail detail({stain});
  Rng rng(35, Stream::kTest, 0);
  double squares = 0.0;
  for (int i = 0; i < 1000; ++i) {
    const Vector3d p(rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2), 0.0);
    const auto sample = detail.sample(p, Vector3d::UnitZ());
    squares += std::pow(sample.gradient.dot(Vector3d(0.6, 0.8, 0.0)), 2) / 1000.0;
    ASSERT_EQ(sample.height_mm, 0.0);
    ASSERT_EQ(detail.sample(p, Vector3d::UnitZ(), SurfaceDetail::Relief::kWithout).gradient,
              Vector3d::Zero());
  }
  EXPECT_NEAR(std::sqrt(squares), 0.02, 0.002);
  EXPECT_EQ(detail.sample({0.45, 0, 0}, Vector3d::UnitZ()).gradient, Vector3d::Zero());
}

TEST(SurfaceDetail, RefusesStainsThatGiveLight) {
  HeightFeature bright = dent();
  bright.reflectance = 1.1;
  EXPECT_THROW(SurfaceDetail({bright}), ConfigError);
  HeightFeature rough = dent();
  rough.roughness_rad = -0.1;
  EXPECT_THROW(SurfaceDetail({rough}), ConfigError);
}

TEST(SurfaceDetail, RefusesFeaturesWithoutSizeByLabel) {
  HeightFeature flat = dent();
  flat.sigma_mm = 0.0;
  EXPECT_THAT([&] { SurfaceDetail({flat}); },
              ::testing::ThrowsMessage<ConfigError>(::testing::HasSubstr("\"dent\"")));
  HeightFeature thin = scratch();
  thin.width_mm = -1.0;
  EXPECT_THROW(SurfaceDetail({thin}), ConfigError);
}

// Slope 0.01 along x tilts the normal by atan 0.01 towards -x.
TEST(DetailedNormal, TiltsAgainstTheGradient) {
  const Vector3d n = detailed_normal(Vector3d::UnitZ(), {0.01, 0, 7.0}, -Vector3d::UnitZ());
  EXPECT_NEAR(n.x(), -std::sin(std::atan(0.01)), 1e-15);
  EXPECT_NEAR(n.norm(), 1.0, 1e-15);
  EXPECT_EQ(detailed_normal(Vector3d::UnitZ(), Vector3d::Zero(), -Vector3d::UnitZ()),
            Vector3d::UnitZ());
}

TEST(DetailedNormal, NeverSendsTheMirrorRayBelowTheSurface) {
  Rng rng(33, Stream::kTest, 0);
  int clamped = 0;
  for (int i = 0; i < 5000; ++i) {
    const Vector3d n = random_direction(rng);
    Vector3d d = random_direction(rng);
    d = d.dot(n) > 0.0 ? Vector3d(-d) : d;
    const Vector3d gradient = std::exp(rng.uniform(-7.0, 3.0)) * random_direction(rng);
    const Vector3d tilted = detailed_normal(n, gradient, d);
    const Vector3d mirrored = d - 2.0 * d.dot(tilted) * tilted;
    ASSERT_NEAR(tilted.norm(), 1.0, 1e-12);
    ASSERT_GE(mirrored.dot(n), 0.0);
    ASSERT_LE(d.dot(tilted), 1e-9);
    const Vector3d free = (n - (gradient - gradient.dot(n) * n)).normalized();
    const Vector3d free_mirrored = d - 2.0 * d.dot(free) * free;
    if (free_mirrored.dot(n) > 1e-6 && d.dot(free) < -1e-6) {
      ASSERT_LT((tilted - free).norm(), 1e-6) << "no need to clamp";
    } else {
      ++clamped;
    }
  }
  EXPECT_GT(clamped, 500);
}

TEST(PlaceOnSurface, FindsPlaceNormalAndAxesOfTheStrip) {
  PartSettings settings;
  settings.origin = PartSettings::Origin::kFile;
  settings.position_mm = {3, 4, 5};
  settings.rotation_rad = {0.2, 0.1, -0.4};
  const Part part = build_part(settings);
  const Bvh bvh(part.mesh);
  const auto place = place_on_surface(part, bvh, 30.0, -10.0);
  ASSERT_TRUE(place.has_value());
  // z = -30^2 / 1600 - 10^2 / 160 = -1.1875; normal along (30 / 800, -10 / 80, 1).
  const RigidTransform& pose = part.scene_from_part;
  EXPECT_LT((place->centre_mm - pose * Vector3d(30, -10, -1.1875)).norm(), 1e-4);
  const Vector3d normal = pose.rotation * Vector3d(0.0375, -0.125, 1.0).normalized();
  EXPECT_LT((place->normal - normal).norm(), 1e-6);
  EXPECT_NEAR(place->u_axis.dot(place->normal), 0.0, 1e-12);
  EXPECT_LT((place->v_axis - place->normal.cross(place->u_axis)).norm(), 1e-12);
  EXPECT_GT(place->u_axis.dot(pose.rotation.col(0)), 0.99);
  const auto turned = place_on_surface(part, bvh, 30.0, -10.0, 0.5 * kPi);
  EXPECT_LT((turned->u_axis - place->v_axis).norm(), 1e-12);
  EXPECT_FALSE(place_on_surface(part, bvh, 101.0, 0.0).has_value());
}

TEST(PlaceOnSurface, WorksOnAPlainMesh) {
  Part part;
  part.mesh = cube_mesh(5.0);
  smooth_normals(part.mesh, 0.5);
  part.box_in_part_mm = bounding_box(part.mesh);
  const auto place = place_on_surface(part, Bvh(part.mesh), 1.0, 2.0);
  ASSERT_TRUE(place.has_value());
  EXPECT_LT((place->centre_mm - Vector3d(1, 2, 5)).norm(), 1e-5);
  EXPECT_LT((place->normal - Vector3d::UnitZ()).norm(), 1e-12);
}

}  // namespace
}  // namespace glint

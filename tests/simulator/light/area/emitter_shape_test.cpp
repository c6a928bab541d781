// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/area/emitter_shape.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "simulator/light/area/spherical_sampling.h"

namespace glint {
namespace {

using Eigen::Vector3d;

Vector3d any_direction(Rng& rng) {
  const double z = rng.uniform(-1.0, 1.0);
  const double phi = rng.uniform(0.0, 2.0 * kPi);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

std::vector<EmitterShape> any_shapes(Rng& rng) {
  const auto frame = [&rng] {
    const Vector3d at(rng.uniform(-50, 50), rng.uniform(-50, 50), rng.uniform(-50, 50));
    return frame_around(at, any_direction(rng));
  };
  const double radius = rng.uniform(5.0, 50.0);
  return {
      RectangleShape{.frame = frame(), .half_x_mm = radius, .half_y_mm = rng.uniform(1.0, 80.0)},
      RingShape{.frame = frame(), .middle_radius_mm = radius, .width_mm = 0.7 * radius},
      RingShape{.frame = frame(),
                .middle_radius_mm = radius,
                .width_mm = rng.uniform(1.0, 2.0 * radius),
                .tilt_rad = rng.uniform(-1.5, 1.5),
                .first_rad = rng.uniform(-4.0, 4.0),
                .span_rad = rng.uniform(0.1, 6.2)},
      RingShape{
          .frame = frame(), .middle_radius_mm = radius, .width_mm = 30.0, .tilt_rad = kPi / 2.0},
      CapShape{.frame = frame(),
               .radius_mm = radius,
               .top_rad = rng.uniform(0.0, 0.5),
               .rim_rad = rng.uniform(0.6, 3.1)},
      TriangleShape{.a_mm = 50.0 * any_direction(rng),
                    .b_mm = 50.0 * any_direction(rng),
                    .c_mm = 50.0 * any_direction(rng)}};
}

// A disc of radius 3: 9 pi. A cylinder of radius 10 and height 4: 80 pi. Half a sphere of radius 2:
// 8 pi.
TEST(AreaOfShapes, IsWhatTheTextbooksSay) {
  EXPECT_NEAR(area_mm2(RingShape{.middle_radius_mm = 1.5, .width_mm = 3.0}), 9.0 * kPi, 1e-9);
  EXPECT_NEAR(area_mm2(RingShape{.middle_radius_mm = 10.0, .width_mm = 4.0, .tilt_rad = kPi / 2.0}),
              80.0 * kPi,
              1e-9);
  EXPECT_NEAR(area_mm2(CapShape{.radius_mm = 2.0}), 8.0 * kPi, 1e-9);
}

TEST(PointsOnShapes, LieInTheirBoundsAndConesAndAreMetByRays) {
  Rng rng(2, Stream::kTest, 1);
  for (int i = 0; i < 2000; ++i) {
    for (const EmitterShape& shape : any_shapes(rng)) {
      const double u = rng.uniform();
      const ShapePoint on = point_on(shape, u, rng.uniform());
      EXPECT_LT(bounds_mm(shape).exteriorDistance(on.point_mm), 1e-9) << shape.index();
      const NormalCone cone = normal_cone(shape);
      EXPECT_GE(on.normal.dot(cone.axis), std::cos(std::min(kPi, cone.half_angle_rad)) - 1e-9);
      // Along a ray from its front the point is met there, or something of the shape before it.
      Vector3d out = any_direction(rng);
      out = out.dot(on.normal) < 0.0 ? Vector3d(-out) : out;
      if (out.dot(on.normal) < 0.01) {
        continue;
      }
      const double distance = rng.uniform(0.1, 200.0);
      const Ray ray = {.origin_mm = on.point_mm + distance * out, .direction = -out};
      const auto met = cross(shape, ray, 1e9, true);
      // Edges may be missed by a rounding error.
      if (u > 1e-6 && u < 1.0 - 1e-6) {
        ASSERT_TRUE(met.has_value()) << shape.index();
        EXPECT_LT(met->distance_mm, distance + 1e-7);
        EXPECT_GT(met->cosine, 0.0);
      }
    }
  }
}

// An octant of the sphere has pi / 2.
TEST(SphericalTriangle, OfAnOctantHasAQuarterOfAHemisphere) {
  EXPECT_NEAR(triangle_solid_angle_sr(Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()),
              kPi / 2,
              1e-12);
}

// Rectangles in four quadrants around the foot make up the whole: solid angles add.
// The square of half side 1 at height 1 is a face of a cube: 4 pi / 6.
TEST(SphericalRectangle, OfACubesFaceHasASixthOfAllDirections) {
  EXPECT_NEAR(SphericalRectangle(-1, 1, -1, 1, 1).solid_angle_sr(), 4.0 * kPi / 6.0, 1e-12);
  const double quarters = SphericalRectangle(-1, 0, -1, 0, 1).solid_angle_sr() +
                          SphericalRectangle(0, 1, -1, 0, 1).solid_angle_sr() +
                          SphericalRectangle(-1, 0, 0, 1, 1).solid_angle_sr() +
                          SphericalRectangle(0, 1, 0, 1, 1).solid_angle_sr();
  EXPECT_NEAR(quarters, 4.0 * kPi / 6.0, 1e-12);
}

// Two triangles have the rectangle's solid angle, from anywhere.
TEST(SphericalRectangle, AgreesWithTwoTriangles) {
  Rng rng(2, Stream::kTest, 2);
  for (int i = 0; i < 1000; ++i) {
    const double x0 = rng.uniform(-3, 2);
    const double x1 = x0 + rng.uniform(0.1, 3);
    const double y0 = rng.uniform(-3, 2);
    const double y1 = y0 + rng.uniform(0.1, 3);
    const double z = rng.uniform(0.05, 3);
    const Vector3d a = Vector3d(x0, y0, z).normalized();
    const Vector3d b = Vector3d(x1, y0, z).normalized();
    const Vector3d c = Vector3d(x1, y1, z).normalized();
    const Vector3d d = Vector3d(x0, y1, z).normalized();
    const double sum = triangle_solid_angle_sr(a, b, c) + triangle_solid_angle_sr(a, c, d);
    const SphericalRectangle rectangle(x0, x1, y0, y1, z);
    EXPECT_NEAR(rectangle.solid_angle_sr(), sum, 1e-10);
    const Eigen::Vector2d at = rectangle.point_mm(rng.uniform(), rng.uniform());
    EXPECT_TRUE(at.x() >= x0 && at.x() <= x1 && at.y() >= y0 && at.y() <= y1);
  }
}

}  // namespace
}  // namespace glint

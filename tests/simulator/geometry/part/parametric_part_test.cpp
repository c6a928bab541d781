// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/part/parametric_part.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/units.h"
#include "simulator/geometry/mesh/mesh_edges.h"
#include "simulator/geometry/part/parametric_gear.h"
#include "tests/simulator/geometry/geometry_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using Shape = PartSettings::Shape;

PartSettings strip_of(double along_mm, double across_mm) {
  PartSettings settings;
  settings.radius_along_mm = along_mm;
  settings.radius_across_mm = across_mm;
  return settings;
}

PartSettings of_shape(Shape shape) {
  PartSettings settings;
  settings.shape = shape;
  return settings;
}

PartSettings cap_of(double radius_mm, double height_mm) {
  PartSettings settings = of_shape(Shape::kSphereCap);
  settings.radius_mm = radius_mm;
  settings.height_mm = height_mm;
  return settings;
}

PartSettings gear_of(const GearSettings& gear) {
  PartSettings settings = of_shape(Shape::kSpurGear);
  settings.gear = gear;
  return settings;
}

std::vector<PartSettings> many_parts() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {strip_of(800, 80),
          strip_of(0, 80),
          strip_of(-400, kInfinity),
          strip_of(-500, -60),
          strip_of(700, -60),
          strip_of(0, 0),
          of_shape(Shape::kPlate),
          cap_of(100, 10),
          cap_of(20, 20),
          cap_of(20, 33),
          cap_of(20, 40),
          cap_of(2000, 1),
          of_shape(Shape::kCylinder),
          gear_of({}),
          gear_of({.bore_mm = 0.0}),
          gear_of({.teeth = 6, .module_mm = 3.0, .face_width_mm = 4.0, .bore_mm = 5.0}),
          gear_of({.teeth = 60, .module_mm = 1.0, .face_width_mm = 40.0, .bore_mm = 50.0}),
          gear_of({.teeth = 24, .pressure_angle_rad = 30.0 * kRadPerDeg, .bore_mm = 10.0})};
}

TEST(ParametricParts, AreClosedAndTurnedOutwards) {
  for (const PartSettings& settings : many_parts()) {
    const Part part = build_part(settings);
    SCOPED_TRACE(part.name);
    for (const MeshEdge& edge : mesh_edges(part.mesh)) {
      ASSERT_EQ(edge.num_faces, 2);
      ASSERT_TRUE(edge.is_consistent);
    }
    EXPECT_GT(enclosed_volume_mm3(part.mesh), 0.0);
    EXPECT_EQ(find_fault(part.mesh), "");
    EXPECT_LT(part.mesh.num_triangles(), 200000U);
  }
}

TEST(ParametricParts, StayWithinTheChordToleranceOfTheirExactSurface) {
  for (const PartSettings& settings : many_parts()) {
    const Part part = build_part(settings);
    SCOPED_TRACE(part.name);
    double largest_mm = 0.0;
    for (std::size_t i = 0; i < part.mesh.num_triangles(); ++i) {
      const ExactPatch& patch = part.patches[static_cast<std::size_t>(part.mesh.patch[i])];
      for (const Vector3d& w : {Vector3d(1, 0, 0),
                                Vector3d(0.5, 0.5, 0),
                                Vector3d(0, 0.5, 0.5),
                                Vector3d(0.5, 0, 0.5),
                                Vector3d(1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0)}) {
        const Vector3d p = w.x() * part.mesh.vertex(i, 0) + w.y() * part.mesh.vertex(i, 1) +
                           w.z() * part.mesh.vertex(i, 2);
        Vector3d gradient;
        const double value_mm = implicit_value(patch, p, &gradient);
        largest_mm = std::max(largest_mm, std::abs(value_mm) / gradient.norm());
        if (w.x() == 1.0) {
          ASSERT_LT(std::abs(value_mm), 1e-10) << "vertices lie on the surface";
        }
      }
    }
    EXPECT_LT(largest_mm, kChordTolerance_mm);
  }
}

TEST(ParametricParts, AsFacetsHaveTheirVerticesOnTheSurfaceAndFewerTriangles) {
  for (PartSettings settings : many_parts()) {
    const Part exact = build_part(settings);
    SCOPED_TRACE(exact.name);
    settings.facets_mm = kChordTolerance_mm;
    const Part same = build_part(settings);
    EXPECT_TRUE(same.patches.empty());
    EXPECT_EQ(same.mesh.patch_of(0), -1);
    EXPECT_EQ(same.mesh.vertices_mm, exact.mesh.vertices_mm);
    EXPECT_EQ(same.mesh.num_triangles(), exact.mesh.num_triangles());
    settings.facets_mm = 0.1;
    const Part coarse = build_part(settings);
    EXPECT_LE(coarse.mesh.num_triangles(), exact.mesh.num_triangles());
    EXPECT_EQ(find_fault(coarse.mesh), "");
    for (const MeshEdge& edge : mesh_edges(coarse.mesh)) {
      ASSERT_EQ(edge.num_faces, 2);
    }
  }
}

TEST(ParametricParts, HaveExactOutwardCornerNormals) {
  for (const PartSettings& settings : many_parts()) {
    const Part part = build_part(settings);
    SCOPED_TRACE(part.name);
    for (std::size_t i = 0; i < part.mesh.num_triangles(); ++i) {
      const ExactPatch& patch = part.patches[static_cast<std::size_t>(part.mesh.patch[i])];
      for (std::size_t k = 0; k < 3; ++k) {
        Vector3d gradient;
        implicit_value(patch, part.mesh.vertex(i, k), &gradient);
        ASSERT_LT((gradient.normalized() - part.mesh.normal(i, k)).norm(), 1e-12);
        ASSERT_GT(part.mesh.normal(i, k).dot(face_normal(part.mesh, i)), 0.9);
      }
    }
  }
}

// Sags 100^2 / 1600 = 6.25 and 25^2 / 160 = 3.90625, so the box is 6.25 + 3.90625 + 3 = 13.15625
// high. Mean sags are a third of these: V = 200 x 50 x (13.15625 - 6.25 / 3 - 3.90625 / 3)
// = 97708.3 mm3; chords of 2 um under 10000 mm2 cut off at most 20 mm3.
TEST(Strip, HasTheHandWorkedSizeAndVolume) {
  const Part part = build_part(strip_of(800, 80));
  EXPECT_LT((part.box_in_part_mm.size_mm() - Vector3d(200, 50, 13.15625)).norm(), 1e-12);
  EXPECT_LT(part.box_in_part_mm.centre_mm().norm(), 1e-12);
  EXPECT_NEAR(enclosed_volume_mm3(part.mesh), 97708.333, 20.0);
  EXPECT_LT(enclosed_volume_mm3(part.mesh), 97708.333);
}

// Concave both ways the apex is the lowest place of the top: 3 + 6.25 + 3.90625 again, and the mean
// height is 3 + (6.25 + 3.90625) / 3 = 6.38542.
TEST(Strip, ConcaveIsThinnestAtItsMiddle) {
  const Part part = build_part(strip_of(-800, -80));
  EXPECT_NEAR(part.box_in_part_mm.size_mm().z(), 13.15625, 1e-12);
  EXPECT_NEAR(enclosed_volume_mm3(part.mesh), 63854.17, 20.0);
}

TEST(Strip, WithTheFilesOriginHasItsApexAtZero) {
  PartSettings settings = strip_of(800, 80);
  settings.origin = PartSettings::Origin::kFile;
  const Part part = build_part(settings);
  EXPECT_EQ(part.box_in_part_mm.max_mm.z(), 0.0);
}

// 2 (200 x 50 + 200 x 3 + 50 x 3) = 21500 mm2, 200 x 50 x 3 = 30000 mm3.
TEST(Plate, HasTheHandWorkedAreaAndVolume) {
  const Part part = build_part(of_shape(Shape::kPlate));
  EXPECT_NEAR(surface_area_mm2(part.mesh), 21500.0, 1e-9);
  EXPECT_NEAR(enclosed_volume_mm3(part.mesh), 30000.0, 1e-9);
}

// R 100, h 10: base radius^2 = 10 x 190 = 1900; area 2 pi R h + pi a^2 = pi (2000 + 1900);
// volume pi h^2 (3 R - h) / 3 = pi 29000 / 3.
TEST(SphereCap, HasTheHandWorkedAreaAndVolume) {
  const Part part = build_part(cap_of(100, 10));
  EXPECT_NEAR(surface_area_mm2(part.mesh), 3900.0 * kPi, 1.0);
  EXPECT_NEAR(enclosed_volume_mm3(part.mesh), 29000.0 * kPi / 3.0, 13.0);
  EXPECT_NEAR(part.box_in_part_mm.size_mm().z(), 10.0, 1e-9);
}

// 4 pi R^2 and 4 pi R^3 / 3 with R = 20; 2 um below 5027 mm2 are 10 mm3.
TEST(SphereCap, OfTwoRadiiIsAWholeSphere) {
  const Part part = build_part(cap_of(20, 40));
  EXPECT_NEAR(surface_area_mm2(part.mesh), 1600.0 * kPi, 1.0);
  EXPECT_NEAR(enclosed_volume_mm3(part.mesh), 32000.0 * kPi / 3.0, 10.0);
  EXPECT_EQ(part.patches.size(), 1U);
}

// R 25, length 200: volume pi 625 x 200 = 392699 mm3; 2 um below 31416 mm2 are 63 mm3.
TEST(Cylinder, LiesAlongXWithTheHandWorkedVolume) {
  const Part part = build_part(of_shape(Shape::kCylinder));
  EXPECT_NEAR(part.box_in_part_mm.size_mm().x(), 200.0, 1e-12);
  EXPECT_NEAR(part.box_in_part_mm.size_mm().z(), 50.0, 4e-3);
  EXPECT_NEAR(enclosed_volume_mm3(part.mesh), kPi * 625.0 * 200.0, 63.0);
}

// Module 2, 30 teeth, 20 deg: reference radius 30, base 30 cos 20 = 28.19078, tip 32, root 27.5.
// Tooth half angle on the reference circle pi / 60; involute of 20 deg = 0.0149044.
TEST(Gear, HasTheHandWorkedRadii) {
  const parametric::GearGeometry gear = parametric::gear_geometry({});
  EXPECT_NEAR(gear.base_radius_mm, 28.19078, 5e-6);
  EXPECT_DOUBLE_EQ(gear.tip_radius_mm, 32.0);
  EXPECT_DOUBLE_EQ(gear.root_radius_mm, 27.5);
  EXPECT_NEAR(gear.half_tooth_rad, kPi / 60.0 + 0.0149044, 1e-7);
}

TEST(Gear, IsHalfToothHalfGapOnTheReferenceCircle) {
  const Part part = build_part(gear_of({}));
  // The flanks of the tooth at +z cross the reference circle (radius 30) at 90 deg -+ 3 deg.
  for (const double side : {-1.0, 1.0}) {
    const double angle = 0.5 * kPi + side * kPi / 60.0;
    const Vector3d p(0.0, 30.0 * std::cos(angle), 30.0 * std::sin(angle));
    double smallest_mm = 1e9;
    for (const ExactPatch& patch : part.patches) {
      if (std::holds_alternative<InvolutePatch>(patch.shape)) {
        smallest_mm = std::min(smallest_mm, std::abs(implicit_value(patch, p, nullptr)));
      }
    }
    EXPECT_LT(smallest_mm, 1e-12);
  }
}

/// Cross-section by sectors: under an involute r_b^2 T^3 / 6, under an arc r^2 angle / 2; the
/// radial part of a flank sweeps nothing.
double gear_section_mm2(const GearSettings& settings) {
  const parametric::GearGeometry g = parametric::gear_geometry(settings);
  const auto cube = [](double x) { return x * x * x; };
  const double flank =
      g.base_radius_mm * g.base_radius_mm * (cube(g.tip_roll_rad) - cube(g.root_roll_rad)) / 6.0;
  const double tip = g.tip_radius_mm * g.tip_radius_mm * g.half_tip_rad;
  const double root = g.root_radius_mm * g.root_radius_mm * g.half_gap_rad;
  return settings.teeth * (2.0 * flank + tip + root) -
         kPi * 0.25 * settings.bore_mm * settings.bore_mm;
}

// Chords of 2 um along an outline of about 400 mm cut off up to 0.6 mm2 of 2000 mm2.
TEST(Gear, HasTheVolumeOfItsSectors) {
  for (const GearSettings& gear :
       {GearSettings{},
        GearSettings{.bore_mm = 0.0},
        GearSettings{.teeth = 60, .module_mm = 1.0, .face_width_mm = 40.0, .bore_mm = 50.0}}) {
    const Part part = build_part(gear_of(gear));
    const double expected_mm3 = gear_section_mm2(gear) * gear.face_width_mm;
    EXPECT_NEAR(enclosed_volume_mm3(part.mesh), expected_mm3, 3e-4 * expected_mm3);
  }
}

TEST(Gear, FrontFaceHasTheAreaOfTheSection) {
  const GearSettings gear = {.teeth = 20, .face_width_mm = 5.0};
  const Part part = build_part(gear_of(gear));
  double front_mm2 = 0.0;
  for (std::size_t i = 0; i < part.mesh.num_triangles(); ++i) {
    const Vector3d area = area_vector(part.mesh, i);
    front_mm2 += area.x() > 0.99 * area.norm() ? area.norm() : 0.0;  // each counted unsigned
  }
  EXPECT_NEAR(front_mm2, gear_section_mm2(gear), 3e-4 * front_mm2);
}

TEST(Gear, ThatCannotBeMadeIsRefusedWithTheKey) {
  using ::testing::HasSubstr;
  using ::testing::ThrowsMessage;
  const auto build = [](const GearSettings& gear) { return [=] { build_part(gear_of(gear)); }; };
  EXPECT_THAT(build({.bore_mm = 54.0}), ThrowsMessage<ConfigError>(HasSubstr("part.gear.bore_mm")));
  EXPECT_THAT(build({.teeth = 6, .pressure_angle_rad = 35.0 * kRadPerDeg, .bore_mm = 0.0}),
              ThrowsMessage<ConfigError>(HasSubstr("part.gear.pressure_angle_deg")));
}

}  // namespace
}  // namespace glint

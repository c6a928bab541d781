// SPDX-License-Identifier: GPL-3.0-or-later
//
// Imprints that are no deeper than the facets of a parametric part are off its exact surface. What
// a dent takes away is measured from the exact surface, in closed form, to the faces of the dent,
// by quadrature over them; so the facets around it count only by where they let it begin.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/rng.h"
#include "defects/part/defective_part.h"
#include "tests/defects/boolean/mesh_faults.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

struct CurvedCase {
  PartSettings::Shape shape = PartSettings::Shape::kCylinder;
  double radius_mm = 20.0;
  DefectGroup group = {};
  double around_rad = 0.0;  ///< where on the part
};

bool is_sphere(const CurvedCase& one) {
  return one.shape == PartSettings::Shape::kSphereCap;
}

DefectGroup smooth_dent(double diameter_mm, double depth_mm) {
  DefectGroup group;
  group.realisation = Realisation::kImprinted;
  group.diameter_mm = diameter_mm;
  group.height_mm = depth_mm;
  group.roughness = 0.0;
  return group;
}

/// A cylinder that is long enough for the dent, or the top of a sphere.
PartSettings part_of(const CurvedCase& one) {
  const double room_mm = 2.0 * one.group.diameter_mm.max + 4.0;
  const double radius_mm = one.radius_mm;
  PartSettings part = {
      .shape = one.shape,
      .length_mm = room_mm,
      .radius_mm = radius_mm,
      .height_mm = std::min(radius_mm, std::max(1.0, 0.75 * room_mm * room_mm / radius_mm))};
  part.origin = PartSettings::Origin::kFile;
  return part;
}

/// Around the cylinder, or a third of the way from the sphere's top to the edge.
Vector3d place_of(const CurvedCase& one, const PartSettings& part) {
  const double c = std::cos(one.around_rad);
  const double s = std::sin(one.around_rad);
  if (!is_sphere(one)) {
    return one.radius_mm * Vector3d(0.0, c, s);
  }
  const double polar_rad = std::acos(1.0 - part.height_mm / one.radius_mm) / 3.0;
  return one.radius_mm *
         Vector3d(std::sin(polar_rad) * c, std::sin(polar_rad) * s, std::cos(polar_rad));
}

/// How far the exact surface lies below its tangent plane.
double sag_mm(const CurvedCase& one, double u, double v) {
  const double squared = v * v + (is_sphere(one) ? u * u : 0.0);
  return squared / (one.radius_mm + std::sqrt(one.radius_mm * one.radius_mm - squared));
}

struct Cut {
  double volume_mm3 = 0.0;   ///< between the exact surface and the dent
  double opening_mm2 = 0.0;  ///< in the tangent plane
};

/// Sums over the dent's faces, by the middles of the edges: exact for what is quadratic in u and v.
Cut measured(const CurvedCase& one, const DefectivePart& made) {
  const SurfacePlace& place = made.defects[0].defect.place;
  Cut cut;
  for (std::size_t i = 0; i < made.mesh.num_triangles(); ++i) {
    if (made.labels[i] == 0) {
      continue;
    }
    std::array<Vector3d, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d d = made.mesh.vertex(i, k) - place.centre_mm;
      p[k] = {d.dot(place.u_axis), d.dot(place.v_axis), d.dot(place.normal)};
    }
    const double area = 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).z();
    double depth = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d middle = 0.5 * (p[k] + p[(k + 1) % 3]);
      depth -= (middle.z() + sag_mm(one, middle.x(), middle.y())) / 3.0;
    }
    cut.opening_mm2 += area;
    cut.volume_mm3 += area * depth;
  }
  return cut;
}

/// The same for the ball itself: over a circle of opening a, depth h - (R - sqrt(R^2 - r^2)).
Cut of_ball(double diameter_mm, double depth_mm) {
  const double a = 0.5 * diameter_mm;
  const double ball = (a * a + depth_mm * depth_mm) / (2.0 * depth_mm);
  constexpr int kSteps = 4000;
  Cut cut = {.opening_mm2 = kPi * a * a};
  for (int i = 0; i < kSteps; ++i) {  // rings of equal area
    const double squared = a * a * (i + 0.5) / kSteps;
    const double above = squared / (ball + std::sqrt(ball * ball - squared));
    cut.volume_mm3 += (depth_mm - above) * kPi * a * a / kSteps;
  }
  return cut;
}

DefectivePart made_on(const CurvedCase& one, const ImprintSettings& imprint = {}) {
  const PartSettings settings = part_of(one);
  const auto part = std::make_shared<const Part>(build_part(settings));
  CurvedCase placed = one;
  const Vector3d at_mm = place_of(one, settings);
  placed.group.at_mm = {at_mm.x(), at_mm.y(), at_mm.z()};
  const DefectMaker maker(part,
                          std::make_shared<const Bvh>(part->mesh),
                          {{"dent", placed.group}},
                          imprint,
                          settings.crease_rad);
  return maker.make(1, [](const Defect&, const DefectGroup&) { return Realisation::kNormal; });
}

/// Opening (its radius), volume, and the volume that is reported, all as shares of what they should
/// be.
struct Shares {
  double opening = 0.0;
  double volume = 0.0;
  double reported = 0.0;
};

Shares shares_of(const CurvedCase& one) {
  const DefectivePart made = made_on(one);
  EXPECT_TRUE(made.defects[0].is_made) << made.defects[0].reason;
  EXPECT_TRUE(find_faults(made.mesh).none());
  const Cut is = measured(one, made);
  const Cut should = of_ball(one.group.diameter_mm.max, one.group.height_mm.max);
  return {.opening = std::sqrt(is.opening_mm2 / should.opening_mm2),
          .volume = is.volume_mm3 / should.volume_mm3,
          .reported = made.defects[0].removed_volume_mm3 / should.volume_mm3};
}

void expect_within(const Shares& shares, double tolerance, const CurvedCase& one) {
  const std::string text = ::testing::PrintToString(one.radius_mm) + " mm, " +
                           (is_sphere(one) ? "sphere" : "cylinder") + ", depth " +
                           ::testing::PrintToString(1e3 * one.group.height_mm.max) +
                           " um, diameter " + ::testing::PrintToString(one.group.diameter_mm.max);
  EXPECT_NEAR(shares.opening, 1.0, tolerance) << text;
  EXPECT_NEAR(shares.volume, 1.0, tolerance) << text;
  EXPECT_NEAR(shares.reported, 1.0, tolerance) << text;
}

constexpr std::array<PartSettings::Shape, 2> kShapes = {PartSettings::Shape::kCylinder,
                                                        PartSettings::Shape::kSphereCap};

// pi h (3 a^2 + h^2) / 6 = 3.14159 x 0.005 x (3 + 0.000025) / 6 = 0.0078540 mm3
TEST(ShallowImprint, TheBallOfAMillimetreAndFiveMicrometresHasTheVolumeOfItsCap) {
  EXPECT_NEAR(of_ball(2.0, 0.005).volume_mm3, 0.0078540, 1e-7);
}

TEST(ShallowImprint, KeepsOpeningAndVolumeOnCurvedSurfaces) {
  for (const auto shape : kShapes) {
    for (const double radius_mm : {10.0, 20.0, 50.0, 200.0}) {
      for (const double depth_mm : {3e-3, 5e-3, 2e-2, 1e-1}) {
        const CurvedCase one = {.shape = shape,
                                .radius_mm = radius_mm,
                                .group = smooth_dent(2.0, depth_mm),
                                .around_rad = 0.3};
        expect_within(shares_of(one), 0.02, one);
      }
    }
  }
}

TEST(ShallowImprint, KeepsOpeningAndVolumeAtRandom) {
  for (std::uint64_t i = 0; i < 60; ++i) {
    Rng rng(7, Stream::kTest, i);
    CurvedCase one = {.shape = kShapes[i % 2]};
    one.radius_mm = 10.0 * std::pow(20.0, rng.uniform());
    one.group = smooth_dent(rng.uniform(0.5, 4.0), 3e-3 * std::pow(100.0 / 3.0, rng.uniform()));
    one.around_rad = rng.uniform(-kPi, kPi);
    expect_within(shares_of(one), 0.02, one);
  }
}

// A bump is the same upside down.
TEST(ShallowImprint, BumpsKeepOpeningAndVolume) {
  CurvedCase one = {.group = smooth_dent(2.0, 5e-3)};
  one.group.type = DefectType::kBump;
  const Shares shares = shares_of(one);
  EXPECT_NEAR(shares.opening, 1.0, 0.02);
  EXPECT_NEAR(shares.volume, -1.0, 0.02);
  EXPECT_NEAR(shares.reported, -1.0, 0.02);
}

// The largest distance of facets from the cylinder, within 0.9 of the opening's radius before the
// tool takes them away, would be 2 um; beside the rim it is at most a hundredth of 5 um.
TEST(ShallowImprint, FacetsAtTheRimAreWithinAHundredthOfTheDepth) {
  const CurvedCase one = {.group = smooth_dent(2.0, 5e-3)};
  const DefectivePart made = made_on(one);
  const SurfacePlace& place = made.defects[0].defect.place;
  int counted = 0;
  for (std::size_t i = 0; i < made.mesh.num_triangles(); ++i) {
    Vector3d centre = Vector3d::Zero();
    double furthest_mm = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d d = made.mesh.vertex(i, k) - place.centre_mm;
      furthest_mm = std::max(furthest_mm, std::hypot(d.dot(place.u_axis), d.dot(place.v_axis)));
      centre += made.mesh.vertex(i, k) / 3.0;
    }
    if (made.labels[i] == 0 && furthest_mm < 1.02 && centre.dot(place.normal) > 0.0) {
      ++counted;
      EXPECT_NEAR(std::hypot(centre.y(), centre.z()), 20.0, 5e-5);
    }
  }
  EXPECT_GT(counted, 20);
}

// Roughness moves the tool's points in the same way wherever it is used.
TEST(ShallowImprint, ARoughToolTakesAsMuchFromACurvedSurfaceAsFromAPlate) {
  for (const DefectType type : {DefectType::kDent, DefectType::kPit}) {
    for (const double depth_mm : {5e-3, 5e-2}) {
      CurvedCase one = {.radius_mm = 15.0, .group = smooth_dent(1.5, depth_mm)};
      one.group.type = type;
      one.group.roughness = 0.15;
      CurvedCase flat = one;
      flat.shape = PartSettings::Shape::kPlate;
      const double on_plate = made_on(flat).defects[0].removed_volume_mm3;
      EXPECT_NEAR(made_on(one).defects[0].removed_volume_mm3 / on_plate, 1.0, 0.02);
    }
  }
}

// (1 - 2/7 + 1/13) w h L / 2 on a plate (docs/theory/imprint.md), along and across the cylinder.
TEST(ShallowImprint, ScratchesKeepTheirVolume) {
  for (const double radius_mm : {10.0, 50.0}) {
    for (const double angle_rad : {0.0, 0.5, 0.5 * kPi}) {
      CurvedCase one = {.radius_mm = radius_mm, .group = smooth_dent(2.0, 5e-3)};
      one.group.type = DefectType::kScratch;
      one.group.length_mm = 3.0;
      one.group.width_mm = 0.4;
      one.group.angle_rad = angle_rad;
      const double flat = (1.0 - 2.0 / 7.0 + 1.0 / 13.0) * 0.4 * 5e-3 * 3.0 / 2.0;
      EXPECT_NEAR(made_on(one).defects[0].removed_volume_mm3 / flat, 1.0, 0.02)
          << radius_mm << " " << angle_rad;
    }
  }
}

// All over the surface, across edges and seams of exact surfaces: finer facets leave no gap.
TEST(ShallowImprint, LeavesEveryExactPartClosed) {
  DefectGroup dents = smooth_dent(1.0, 0.01);
  dents.count = 12.0;
  dents.diameter_mm = {0.3, 3.0};
  dents.height_mm = {3e-3, 0.05};
  dents.roughness = 0.15;
  DefectGroup scratches = dents;
  scratches.type = DefectType::kScratch;
  scratches.count = 6.0;
  scratches.length_mm = {1.0, 8.0};
  scratches.width_mm = {0.1, 0.4};
  scratches.angle_rad = {-kPi, kPi};
  for (const auto shape : {PartSettings::Shape::kStrip,
                           PartSettings::Shape::kPlate,
                           PartSettings::Shape::kSphereCap,
                           PartSettings::Shape::kCylinder,
                           PartSettings::Shape::kSpurGear}) {
    PartSettings settings = {.shape = shape, .length_mm = 30.0, .width_mm = 20.0};
    settings.gear = {.teeth = 12, .module_mm = 2.0, .face_width_mm = 8.0, .bore_mm = 8.0};
    const auto part = std::make_shared<const Part>(build_part(settings));
    const DefectMaker maker(part,
                            std::make_shared<const Bvh>(part->mesh),
                            {{"dents", dents}, {"scratches", scratches}},
                            {},
                            settings.crease_rad);
    const DefectivePart made =
        maker.make(5, [](const Defect&, const DefectGroup&) { return Realisation::kNormal; });
    EXPECT_TRUE(find_faults(made.mesh).none()) << part->name;
    EXPECT_GE(std::ranges::count_if(made.defects, &RealisedDefect::is_made), 17) << part->name;
  }
}

TEST(ShallowImprint, GivesUpWhatWouldNeedEndlessTriangles) {
  const CurvedCase one = {.group = smooth_dent(8.0, 1e-6)};
  const DefectivePart made = made_on(one, {.max_attempts = 1});
  EXPECT_FALSE(made.defects[0].is_made);
  EXPECT_THAT(made.defects[0].reason, HasSubstr("it is too flat for so curved a surface"));
  EXPECT_EQ(made.mesh.num_triangles(), build_part(part_of(one)).mesh.num_triangles());
}

}  // namespace
}  // namespace glint

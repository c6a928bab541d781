// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/definition/ladder/unmodelled.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/file.h"
#include "core/units.h"
#include "studies/definition/ladder/wall_share.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using ::testing::HasSubstr;

// Metal with R = 0.5: k^2 = 4 * 0.5 / 0.5, index 1 - 2i. At normal incidence nothing is polarised.
// At 60 degrees, with u = sqrt(1 - 0.75 / (1 - 2i)^2):
//   (1 - 2i)^2 = -3 - 4i; 0.75 / (-3 - 4i) = -0.09 + 0.12i; u = sqrt(1.09 - 0.12i)
//   = 1.04560 - 0.05738i; n u = 0.93084 - 2.14858i
//   Rs = |0.5 - n u|^2 / |0.5 + n u|^2 = 4.80202 / 6.66369 = 0.72062
//   Rp = |0.5 n - u|^2 / |0.5 n + u|^2 = (0.29768 + 0.88854) / (2.38888 + 1.11806) = 0.33825
TEST(MetalPolarisation, FollowsFresnel) {
  EXPECT_NEAR(metal_polarisation(0.5, 0.0), 0.0, 1e-12);
  EXPECT_NEAR(metal_polarisation(0.5, kPi / 3.0), (0.72062 - 0.33825) / (0.72062 + 0.33825), 1e-3);
  EXPECT_EQ(metal_polarisation(1.0, 1.0), 0.0);
}

TEST(MetalPolarisation, GrowsWithTheAngleAndFallsWithTheReflectance) {
  for (int k = 1; k < 100; ++k) {
    const double reflectance = 0.3 + 0.006 * k;
    EXPECT_GT(metal_polarisation(reflectance, 1.0), metal_polarisation(reflectance, 0.9));
    EXPECT_LT(metal_polarisation(reflectance + 0.005, 1.0), metal_polarisation(reflectance, 1.0));
  }
}

TEST(UnmodelledNotes, TellSizes) {
  SceneSettings scene;
  scene.defects = {{"scratch", {.type = DefectType::kScratch, .width_mm = 0.5}},
                   {"dent", {.type = DefectType::kDent, .diameter_mm = 2.0}}};
  const auto notes = unmodelled_notes(scene, {100.0, 50.0, 10.0});
  ASSERT_EQ(notes.size(), 4U);
  EXPECT_THAT(notes[0], HasSubstr("part 50 cm2"));
  EXPECT_THAT(notes[1], HasSubstr("Polarisation"));
  // 550 nm over 0.5 mm: 1.1 mrad.
  EXPECT_THAT(notes[2], HasSubstr("narrowest defect (0.5 mm) reflects by about 1.1 mrad"));
  // 650 nm, the longest of a colour camera's, over 0.5 mm: 1.3 mrad.
  scene.sensor.wavelengths_nm = {450.0, 650.0, 550.0};
  EXPECT_THAT(unmodelled_notes(scene, {100.0, 50.0, 10.0})[2], HasSubstr("by about 1.3 mrad"));
}

/// A part in the axis of a semicylinder without a slot, seen from above.
SceneSettings strip_in_tunnel(double radius_mm, double length_mm) {
  SceneSettings scene;
  scene.tunnel.radius_mm = radius_mm;
  scene.tunnel.length_mm = length_mm;
  scene.tunnel.slot_mm = 0.0;
  return scene;
}

// A face of area A in the axis of a long semicylinder of radius r, by angles phi around the axis
// and x along it, with d^2 = r^2 + x^2: the integral of A (r^2 sin(phi) / (pi d^4))^2 r dphi dx is
// A r^5 / pi^2 * pi / 2 * 5 pi / (16 r^7) = 5/32 A / r^2.
TEST(WallShare, OfASmallFaceInTheAxisOfALongSemicylinderIsAClosedForm) {
  const WallShare share = wall_share(strip_in_tunnel(100.0, 20000.0), {4.0, 4.0, 1.0});
  EXPECT_NEAR(share.returned, 5.0 / 32.0 * 16.0 / 1e4, 0.01 * 2.5e-4);
  EXPECT_NEAR(share.wall_mm2, kPi * 100.0 * 20000.0, 1e-3 * kPi * 2e6);
  const WallShare far = wall_share(strip_in_tunnel(200.0, 20000.0), {4.0, 4.0, 1.0});
  EXPECT_NEAR(far.returned, 0.25 * share.returned, 1e-3 * share.returned);
}

// Of a small face the far ends of a tunnel return nothing, and no face gets back more than it sent.
TEST(WallShare, IsThatOfTheWallOppositeToThePart) {
  const Eigen::Vector3d size_mm(20.0, 10.0, 1.0);
  const double whole = wall_share(strip_in_tunnel(100.0, 2000.0), size_mm).returned;
  EXPECT_NEAR(wall_share(strip_in_tunnel(100.0, 1000.0), size_mm).returned, whole, 1e-3 * whole);
  EXPECT_LT(wall_share(strip_in_tunnel(100.0, 100.0), size_mm).returned, 0.9 * whole);
  const double close = wall_share(strip_in_tunnel(100.0, 600.0), {500.0, 190.0, 1.0}).returned;
  EXPECT_GT(close, 0.2);
  EXPECT_LT(close, 1.0);
}

// 0.5 times R = 0.8 times 5/32 * 100 / 10^4: 0.0625 %.
TEST(UnmodelledNotes, EstimateWhatTheWallThrowsBack) {
  SceneSettings scene = strip_in_tunnel(100.0, 2000.0);
  scene.material.reflectance = {0.8};
  EXPECT_THAT(unmodelled_notes(scene, {10.0, 10.0, 1.0})[0], HasSubstr("about 0.06 % of the wall"));
}

TEST(UnmodelledNotes, DirectLightHasNoErrorOfPolarisation) {
  SceneSettings scene;
  scene.render.method = RenderSettings::Method::kPaths;
  scene.paths.max_reflections = 1;
  scene.has_tunnel = false;
  const auto notes = unmodelled_notes(scene, {1.0, 1.0, 1.0});
  EXPECT_THAT(notes[0], HasSubstr("no estimate"));
  EXPECT_THAT(notes[1], HasSubstr("no error"));
  EXPECT_THAT(notes[2], HasSubstr("no defect"));
}

/// A plate of 48 x 36 mm with R = 0.6 and a flat ring of 30 to 60 mm over it.
SceneSettings plate_under_ring(double height_mm) {
  SceneSettings scene;
  scene.has_tunnel = false;
  scene.material.reflectance = {0.6};
  scene.lights = {{"ring",
                   RingSettings{.placement = {.position_mm = {0.0, 0.0, height_mm}},
                                .inner_radius_mm = 30.0,
                                .outer_radius_mm = 60.0}}};
  return scene;
}

// At 97 mm the ring fills 60^2 / (60^2 + 97^2) - 30^2 / (30^2 + 97^2) = 0.189 of what the plate
// sees. By reciprocity 0.189 * 1728 / 8482 = 0.0386 of what a place of the ring reflects falls on
// the plate: 0.5 * 0.6 * 0.189 * 0.0386 = 0.22 %. At 60 mm it is 0.5 - 0.2 = 0.3: 0.55 %.
TEST(UnmodelledNotes, EstimateWhatLampsThrowBack) {
  const auto note = [](const SceneSettings& scene) {
    return unmodelled_notes(scene, {48.0, 36.0, 5.0})[0];
  };
  EXPECT_THAT(note(plate_under_ring(97.0)), HasSubstr("about 0.2 % of the part's light"));
  EXPECT_THAT(note(plate_under_ring(97.0)), HasSubstr("fill 19 % of what it sees"));
  EXPECT_THAT(note(plate_under_ring(60.0)), HasSubstr("fill 30 % of what it sees"));
  SceneSettings bright = plate_under_ring(97.0);
  bright.material.reflectance = {0.9};
  bright.lights.push_back(bright.lights.front());  // as if there were two
  EXPECT_THAT(note(bright), HasSubstr("about 0.7 % of the part's light"));
  EXPECT_THAT(note(plate_under_ring(-97.0)), HasSubstr("no estimate")) << "it is behind";
  SceneSettings sky = plate_under_ring(97.0);
  sky.lights = {{"sky", EnvironmentSettings()}};
  EXPECT_THAT(note(sky), HasSubstr("no estimate"));
}

// A convex part throws no light on itself. Of a gear with R = 0.6 as much as (0.5 * 0.6)^2 = 9 % of
// the light takes more than two reflections.
TEST(UnmodelledNotes, TellOfReflectionsBeyondTheLast) {
  SceneSettings scene;
  scene.render.method = RenderSettings::Method::kPaths;
  scene.paths.max_reflections = 2;
  scene.material.reflectance = {0.6};
  EXPECT_THAT(unmodelled_notes(scene, {1.0, 1.0, 1.0})[3], HasSubstr("does not see itself"));
  scene.part.shape = PartSettings::Shape::kSpurGear;
  EXPECT_THAT(unmodelled_notes(scene, {1.0, 1.0, 1.0})[3],
              HasSubstr("2 times is not modelled: about 9 %"));
}

// A trough 20 mm wide with a radius of 10 mm: its sides end with a slope of 1, the parabola's arc
// is (sqrt(2) + asinh(1)) / 2 = 1.1478 of its opening, and 1 - 1 / 1.1478 = 0.129 of its light
// stays inside. (0.129 * 0.6)^2 = 0.6 %. One of 800 mm returns 1 - 1 / (1 + 0.0125^2 / 6): 0.0026
// %.
TEST(UnmodelledNotes, AHollowStripSeesItself) {
  SceneSettings scene;
  scene.render.method = RenderSettings::Method::kPaths;
  scene.paths.max_reflections = 2;
  scene.material.reflectance = {0.6};
  scene.part.width_mm = 20.0;
  scene.part.radius_across_mm = -10.0;
  const auto note = [&] { return unmodelled_notes(scene, {1.0, 1.0, 1.0})[3]; };
  EXPECT_THAT(note(), HasSubstr("2 times is not modelled: about 0.6 %"));
  EXPECT_THAT(note(), HasSubstr("if 13 % of what it reflects"));
  scene.part.radius_across_mm = -800.0;
  EXPECT_THAT(note(), HasSubstr("if 0.0026 % of what it reflects"));
  scene.part.radius_across_mm = 10.0;
  scene.part.radius_along_mm = -0.5 * scene.part.length_mm;
  EXPECT_THAT(note(), HasSubstr("if 13 % of what it reflects")) << "a saddle";
  scene.part.shape = PartSettings::Shape::kPlate;
  EXPECT_THAT(note(), HasSubstr("does not see itself")) << "radii are those of strips";
}

// Of index 1.5 at 60 degrees: Rs = 0.1770, Rp = 0.0018: 0.98 polarised, 0.96 twice.
TEST(UnmodelledNotes, ACoatPolarisesWhatLiesBelowItDoesNot) {
  SceneSettings scene;
  scene.has_tunnel = false;
  scene.material.type = MaterialSettings::Type::kDiffuse;
  EXPECT_THAT(unmodelled_notes(scene, {1.0, 1.0, 1.0})[1], HasSubstr("no error"));
  scene.material.coat.index = 1.5;
  EXPECT_THAT(unmodelled_notes(scene, {1.0, 1.0, 1.0})[1], HasSubstr("this coat"));
}

// n = 1, k = 2 by a table: R = 4 / 8, so that both ways tell the same.
TEST(UnmodelledNotes, PolarisationIsByTheTableOfNAndK) {
  const TemporaryFolder folder;
  write_file(folder / "metal.csv", "wl,n\n0.3,1\n0.9,1\nwl,k\n0.3,2\n0.9,2\n");
  SceneSettings by_table;
  by_table.material.nk_file = folder / "metal.csv";
  SceneSettings by_reflectance;
  by_reflectance.material.reflectance = {0.5};
  const auto polarisation = [](const SceneSettings& scene) {
    return unmodelled_notes(scene, {1.0, 1.0, 1.0})[1];
  };
  EXPECT_EQ(polarisation(by_table), polarisation(by_reflectance));
  EXPECT_THAT(polarisation(by_table), HasSubstr("this metal"));
}

}  // namespace
}  // namespace glint

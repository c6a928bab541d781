// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/surface/displacement.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/rng.h"
#include "core/units.h"
#include "defects/surface/surface_normals.h"
#include "simulator/geometry/mesh/mesh_edges.h"
#include "tests/simulator/geometry/geometry_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// 60 x 40 x 2 mm, top at z = 1, two triangles a side.
Part displaced_plate() {
  return build_part({.shape = PartSettings::Shape::kPlate,
                     .length_mm = 60.0,
                     .width_mm = 40.0,
                     .thickness_mm = 2.0});
}

HeightFeature dent_at(const Vector3d& centre, double height_mm, double sigma_mm) {
  return {.label = "dent_1",
          .id = 1,
          .centre_mm = centre,
          .height_mm = height_mm,
          .sigma_mm = sigma_mm};
}

Displaced displace_part(const Part& part, const std::vector<HeightFeature>& features) {
  return displace(
      part.mesh, std::vector<std::int32_t>(part.mesh.num_triangles(), 0), part.patches, features);
}

void expect_closed(const TriangleMesh& mesh) {
  for (const MeshEdge& edge : mesh_edges(mesh)) {
    ASSERT_TRUE(edge.num_faces == 2 && edge.is_consistent) << edge.from << " " << edge.to;
  }
}

// 2 pi sigma^2 h = 2 pi 0.04 0.05 = 0.012566 mm3.
TEST(Displace, ADentOnAPlaneTakesAwayTheVolumeOfAGaussian) {
  const Part part = displaced_plate();
  const Displaced out = displace_part(part, {dent_at({3.0, -5.0, 1.0}, -0.05, 0.2)});
  const double expected_mm3 = 2.0 * kPi * 0.2 * 0.2 * 0.05;
  EXPECT_NEAR(out.removed_volume_mm3 / expected_mm3, 1.0, 1e-3);
  EXPECT_DOUBLE_EQ(out.features[0].removed_volume_mm3, out.removed_volume_mm3);
  EXPECT_NEAR(
      enclosed_volume_mm3(part.mesh) - enclosed_volume_mm3(out.mesh), out.removed_volume_mm3, 1e-9);
  expect_closed(out.mesh);
}

TEST(Displace, VerticesLieOnTheHeightAndNormalsAreItsOwn) {
  const Part part = displaced_plate();
  const Displaced out = displace_part(part, {dent_at({3.0, -5.0, 1.0}, 0.05, 0.2)});
  int moved = 0;
  for (std::size_t i = 0; i < out.mesh.num_triangles(); ++i) {
    if (out.mesh.patch[i] >= 0) {
      continue;
    }
    for (std::size_t k = 0; k < 3; ++k) {
      const Vector3d& p = out.mesh.vertex(i, k);
      const double x = p.x() - 3.0;
      const double y = p.y() + 5.0;
      const double r2 = (x * x + y * y) / 0.04;
      const double h = r2 <= 25.0 ? 0.05 * std::exp(-0.5 * r2) : 0.0;
      EXPECT_NEAR(p.z(), 1.0 + h, 1e-12);
      // (-dh/dx, -dh/dy, 1) with dh/dx = -h x / sigma^2.
      const Vector3d normal = Vector3d(h * x / 0.04, h * y / 0.04, 1.0).normalized();
      EXPECT_LT((out.mesh.normal(i, k) - normal).norm(), 1e-12);
      ++moved;
    }
  }
  EXPECT_GT(moved, 3000);
}

// Within 2 sigma no edge is longer than sigma / 8; bisection ends above a quarter of that.
TEST(Displace, FacesAreAsFineAsTheRuleSays) {
  const Part part = displaced_plate();
  const double sigma = 0.2;
  const Displaced out = displace_part(part, {dent_at({3.0, -5.0, 1.0}, -0.002, sigma)});
  int faces = 0;
  for (std::size_t i = 0; i < out.mesh.num_triangles(); ++i) {
    double longest = 0.0;
    double nearest = 1e9;
    for (std::size_t k = 0; k < 3; ++k) {
      longest = std::max(longest, (out.mesh.vertex(i, k) - out.mesh.vertex(i, (k + 1) % 3)).norm());
      nearest = std::min(nearest, (out.mesh.vertex(i, k) - Vector3d(3.0, -5.0, 1.0)).norm());
    }
    if (nearest < 5.0 * sigma) {
      EXPECT_LT(longest, 0.5 * sigma + 1e-4);
    }
    if (nearest < 2.0 * sigma) {
      EXPECT_LT(longest, sigma / 8.0 + 1e-4);
      EXPECT_GT(longest, sigma / 32.0);
      ++faces;
    }
  }
  EXPECT_GT(faces, 1000);
  EXPECT_LT(out.mesh.num_triangles(), 12000U);
}

TEST(Displace, LabelsAreTheFacesWithinTheRadius) {
  const Part part = displaced_plate();
  const Displaced out = displace_part(part, {dent_at({3.0, -5.0, 1.0}, -0.002, 0.2)});
  double area_mm2 = 0.0;
  int faces = 0;
  for (std::size_t i = 0; i < out.mesh.num_triangles(); ++i) {
    if (out.labels[i] == 1) {
      area_mm2 += area_vector(out.mesh, i).norm();
      ++faces;
    }
  }
  EXPECT_NEAR(area_mm2 / (kPi * 0.16), 1.0, 0.01);
  EXPECT_EQ(out.features[0].faces, faces);
  ASSERT_EQ(out.labels.size(), out.mesh.num_triangles());
  ASSERT_EQ(out.origin.size(), out.mesh.num_triangles());
}

TEST(Displace, FarFacesKeepTheirBytes) {
  const Part part = sphere_part(20.0);
  const Displaced out = displace_part(part, {dent_at({0.0, 0.0, 20.0}, -0.01, 0.3)});
  int kept = 0;
  for (std::size_t i = 0; i < part.mesh.num_triangles(); ++i) {
    if (part.mesh.vertex(i, 0).z() < 15.0) {
      EXPECT_EQ(out.mesh.triangles[i], part.mesh.triangles[i]);
      EXPECT_EQ(out.mesh.corner_normals[i], part.mesh.corner_normals[i]);
      EXPECT_EQ(out.mesh.patch[i], part.mesh.patch[i]);
      EXPECT_EQ(out.origin[i], static_cast<std::int32_t>(i));
      ++kept;
    }
  }
  EXPECT_GT(kept, 1000);
  for (std::size_t i = 0; i < part.mesh.vertices_mm.size(); ++i) {
    if (part.mesh.vertices_mm[i].z() < 15.0) {
      EXPECT_EQ(out.mesh.vertices_mm[i], part.mesh.vertices_mm[i]);
    }
  }
}

// Every vertex of the top is at R + h(r) along its radius, r in the plane of the place.
TEST(Displace, OnASphereTheHeightCountsFromTheExactSurface) {
  const Part part = sphere_part(20.0);
  const Displaced out = displace_part(part, {dent_at({0.0, 0.0, 20.0}, -0.01, 0.3)});
  expect_closed(out.mesh);
  double deepest = 0.0;
  for (const Vector3d& p : out.mesh.vertices_mm) {
    const double down = 20.0 - p.norm();
    EXPECT_LT(down, 0.0101);
    EXPECT_GT(down, -1e-9);
    const Vector3d base = p * (20.0 / p.norm());
    const double r2 = (base.x() * base.x() + base.y() * base.y()) / 0.09;
    if (p.z() > 0.0 && r2 < 24.0) {
      EXPECT_NEAR(down, 0.01 * std::exp(-0.5 * r2), 1e-11);
    }
    deepest = std::max(deepest, down);
  }
  EXPECT_GT(deepest, 0.0099);
  // The outside is larger than its plan: 1 / cos to first order, (1 + 3 / 2 (sigma / R)^2 ...).
  EXPECT_NEAR(out.removed_volume_mm3 / (2.0 * kPi * 0.09 * 0.01), 1.0, 2e-3);
}

// Cross-section sqrt(2 pi) sigma h times the line of 4 - 0.4 mm, and the two ends: a whole
// Gaussian.
TEST(Displace, AScratchTakesAwayItsCrossSectionTimesItsLength) {
  const Part part = displaced_plate();
  HeightFeature scratch = dent_at({0.0, 0.0, 1.0}, -0.01, 0.0);
  scratch.kind = HeightFeature::Kind::kScratch;
  scratch.length_mm = 4.0;
  scratch.width_mm = 0.4;
  const Displaced out = displace_part(part, {scratch});
  const double expected_mm3 = 0.01 * (std::sqrt(2.0 * kPi) * 0.1 * 3.6 + 2.0 * kPi * 0.1 * 0.1);
  EXPECT_NEAR(out.removed_volume_mm3 / expected_mm3, 1.0, 2e-3);
  expect_closed(out.mesh);
}

TEST(Displace, FeaturesAddUpAndTheirVolumesToo) {
  const Part part = displaced_plate();
  HeightFeature bump = dent_at({3.3, -5.0, 1.0}, 0.01, 0.1);
  bump.id = 2;
  const Displaced out = displace_part(part, {dent_at({3.0, -5.0, 1.0}, -0.01, 0.2), bump});
  const double expected_mm3 = 2.0 * kPi * 0.01 * (0.04 - 0.01);
  EXPECT_NEAR(out.removed_volume_mm3 / expected_mm3, 1.0, 2e-3);
  EXPECT_NEAR(out.features[0].removed_volume_mm3 + out.features[1].removed_volume_mm3,
              out.removed_volume_mm3,
              1e-15);
}

TEST(Displace, ADentAtTheRimBendsTheSideAndLeavesNoHole) {
  const Part part = displaced_plate();
  const Displaced out = displace_part(part, {dent_at({30.0, 0.0, 1.0}, -0.02, 0.3)});
  expect_closed(out.mesh);
  // Half of the Gaussian is over the plate; rim vertices move along the mean of top and side.
  EXPECT_GT(out.removed_volume_mm3, 0.4 * 2.0 * kPi * 0.09 * 0.02);
  EXPECT_LT(out.removed_volume_mm3, 0.7 * 2.0 * kPi * 0.09 * 0.02);
}

TEST(Displace, AMeshFromAFileMovesAlongItsSmoothNormals) {
  TriangleMesh mesh = sphere_part(20.0).mesh;
  mesh.patch.clear();
  set_normals(mesh, {}, 30.0 * kRadPerDeg);
  const std::vector<HeightFeature> features = {dent_at({0.0, 0.0, 20.0}, -0.05, 0.3)};
  const Displaced out =
      displace(mesh, std::vector<std::int32_t>(mesh.num_triangles(), 0), {}, features);
  expect_closed(out.mesh);
  EXPECT_TRUE(out.mesh.patch.empty());
  EXPECT_NEAR(out.removed_volume_mm3 / (2.0 * kPi * 0.09 * 0.05), 1.0, 5e-3);
  EXPECT_NEAR(
      enclosed_volume_mm3(mesh) - enclosed_volume_mm3(out.mesh), out.removed_volume_mm3, 1e-8);
}

TEST(Displace, ASecondPassKeepsTheLabelsOfTheFirst) {
  const Part part = displaced_plate();
  Displaced first = displace_part(part, {dent_at({3.0, -5.0, 1.0}, -0.01, 0.2)});
  const auto count = std::ranges::count(first.labels, 1);
  HeightFeature far = dent_at({-20.0, 10.0, 1.0}, -0.01, 0.2);
  far.id = 2;
  const std::vector<HeightFeature> features = {far};
  const Displaced second = displace(first.mesh, first.labels, part.patches, features);
  EXPECT_EQ(std::ranges::count(second.labels, 1), count);
  EXPECT_GT(std::ranges::count(second.labels, 2), 1000);
  expect_closed(second.mesh);
}

// Random dents, bumps and scratches up to a slope of 1 on a gear: closed, and no face turns over.
TEST(Displace, RandomFeaturesOnAGearLeaveItClosedAndUnfolded) {
  const Part part = build_part(
      {.shape = PartSettings::Shape::kSpurGear, .gear = {.teeth = 12, .module_mm = 3.0}});
  const Bvh bvh(part.mesh);
  Rng rng(7, Stream::kTest, 0);
  int done = 0;
  for (int round = 0; round < 10; ++round) {
    std::vector<HeightFeature> features;
    while (features.size() < 100) {
      const auto place = place_on_surface(
          part, bvh, rng.uniform(-9.0, 9.0), rng.uniform(-18.0, 18.0), rng.uniform(0.0, kPi));
      if (!place) {
        continue;
      }
      HeightFeature feature = dent_at(place->centre_mm, 0.0, rng.uniform(0.05, 0.1));
      feature.id = static_cast<int>(features.size()) + 1;
      feature.kind =
          rng.uniform() < 0.3 ? HeightFeature::Kind::kScratch : HeightFeature::Kind::kGaussian;
      feature.length_mm = rng.uniform(0.3, 1.0);
      feature.width_mm = 4.0 * feature.sigma_mm;
      feature.height_mm = rng.uniform(-0.2, 0.2) * feature.sigma_mm;
      feature.u_axis = place->u_axis;
      feature.v_axis = place->v_axis;
      feature.normal = place->normal;
      features.push_back(feature);
    }
    const Displaced out = displace(part.mesh,
                                   std::vector<std::int32_t>(part.mesh.num_triangles(), 0),
                                   part.patches,
                                   features,
                                   round == 0 ? 2.0 : 1.0);
    expect_closed(out.mesh);
    int labelled = 0;
    for (std::size_t i = 0; i < out.mesh.num_triangles(); ++i) {
      ASSERT_GT(area_vector(out.mesh, i).norm(), 0.0);
      const auto origin = static_cast<std::size_t>(out.origin[i]);
      ASSERT_GT(face_normal(out.mesh, i).dot(face_normal(part.mesh, origin)), 0.09);
      labelled += out.labels[i] > 0 ? 1 : 0;
    }
    EXPECT_GT(labelled, 400);
    done += static_cast<int>(features.size());
  }
  EXPECT_EQ(done, 1000);
}

TEST(Displace, TheOtherSideOfASheetStays) {
  const Part part = build_part({.shape = PartSettings::Shape::kPlate,
                                .length_mm = 60.0,
                                .width_mm = 40.0,
                                .thickness_mm = 0.5});
  const Displaced out = displace_part(part, {dent_at({0.0, 0.0, 0.25}, -0.01, 0.4)});
  for (const Vector3d& p : out.mesh.vertices_mm) {
    EXPECT_TRUE(p.z() > 0.2 || p.z() == -0.25 || std::abs(p.x()) == 30.0 ||
                std::abs(p.y()) == 20.0);
  }
}

TEST(Displace, WithoutHeightNothingChanges) {
  const Part part = displaced_plate();
  const Displaced out = displace_part(part, {dent_at({0.0, 0.0, 1.0}, 0.0, 0.2)});
  EXPECT_EQ(out.mesh.triangles, part.mesh.triangles);
  EXPECT_EQ(out.features.size(), 1U);
  EXPECT_EQ(out.features[0].faces, 0);
}

TEST(Displace, RefusesAScratchThatTakesTooManyTriangles) {
  const Part part = displaced_plate();
  HeightFeature scratch = dent_at({0.0, 0.0, 1.0}, -0.01, 0.0);
  scratch.kind = HeightFeature::Kind::kScratch;
  scratch.label = "scratch_3";
  scratch.length_mm = 50.0;
  scratch.width_mm = 0.001;
  EXPECT_THAT([&] { displace_part(part, {scratch}); },
              ::testing::ThrowsMessage<ConfigError>(::testing::HasSubstr("\"scratch_3\"")));
}

}  // namespace
}  // namespace glint

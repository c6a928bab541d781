// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/surface/processing.h"

#include <cmath>
#include <cstring>

#include <gtest/gtest.h>

#include "core/units.h"
#include "defects/surface/safe_moves.h"
#include "defects/surface/subdivision.h"
#include "defects/surface/surface_normals.h"
#include "tests/defects/boolean/mesh_faults.h"
#include "tests/simulator/geometry/geometry_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr double kProcessingCrease_rad = 30.0 * kRadPerDeg;

Processed process_part(const Part& part, const ProcessingSettings& settings, std::uint64_t seed) {
  return apply_processing(settings,
                          seed,
                          part.mesh,
                          std::vector<std::int32_t>(part.mesh.num_triangles(), 0),
                          part.patches,
                          kProcessingCrease_rad);
}

/// A unit cube with 12 * 4^level triangles, no patches.
TriangleMesh fine_cube(int level) {
  TriangleMesh mesh = cube_mesh(1.0);
  for (int i = 0; i < level; ++i) {
    mesh = subdivide_midpoint(mesh, std::vector<std::int32_t>(mesh.num_triangles(), 0), {}).mesh;
  }
  return mesh;
}

Processed process_cube(int level, const ProcessingSettings& settings, std::uint64_t seed) {
  const TriangleMesh mesh = fine_cube(level);
  return apply_processing(settings,
                          seed,
                          mesh,
                          std::vector<std::int32_t>(mesh.num_triangles(), 0),
                          {},
                          kProcessingCrease_rad);
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value * value;
  }
  return std::sqrt(sum / static_cast<double>(values.size()));
}

TEST(ApplyProcessing, WithoutSettingsChangesNothing) {
  const Part part = sphere_part(5.0);
  const Processed out = process_part(part, {}, 1);
  EXPECT_FALSE(is_any({}));
  EXPECT_EQ(out.mesh.vertices_mm, part.mesh.vertices_mm);
  EXPECT_EQ(out.mesh.triangles, part.mesh.triangles);
  EXPECT_EQ(out.mesh.patch, part.mesh.patch);
  EXPECT_EQ(out.mesh.normals, part.mesh.normals);
}

// 3072 faces: the rms of a sample scatters by 1 / sqrt(4 * 3072) = 0.9 %.
TEST(ApplyProcessing, FaceNormalNoiseHasTheRmsThatIsAsked) {
  const ProcessingSettings settings = {.face_normal_noise_rad = 0.02};
  const Processed out = process_cube(4, settings, 3);
  std::vector<double> tilts;
  for (std::size_t i = 0; i < out.mesh.num_triangles(); ++i) {
    const double cosine = out.mesh.normal(i, 0).dot(face_normal(out.mesh, i));
    tilts.push_back(std::acos(std::min(1.0, cosine)));
    EXPECT_LT((out.mesh.normal(i, 1) - out.mesh.normal(i, 0)).norm(), 1e-12);
    EXPECT_NEAR(out.mesh.normal(i, 2).norm(), 1.0, 1e-12);
  }
  EXPECT_NEAR(rms(tilts) / 0.02, 1.0, 0.04);
  EXPECT_EQ(out.mesh.vertices_mm, fine_cube(4).vertices_mm);
  EXPECT_EQ(out.mesh.normals.size(), 3 * out.mesh.num_triangles());
}

TEST(ApplyProcessing, FacesWithNoiseAreNoLongerExact) {
  const Part part = sphere_part(5.0);
  const Processed out = process_part(part, {.face_normal_noise_rad = 1e-3}, 3);
  EXPECT_EQ(std::ranges::count(out.mesh.patch, -1),
            static_cast<std::ptrdiff_t>(out.mesh.num_triangles()));
}

// On the faces of the cube a vertex moves along its axis. 6 * 16^2 + 2 = 1538 vertices: the rms
// scatters by 1 / sqrt(2 * 1538) = 1.8 %.
TEST(ApplyProcessing, VertexNoiseMovesAlongTheNormalWithItsRms) {
  const Processed out = process_cube(4, {.vertex_noise_mm = 1e-3}, 3);
  const TriangleMesh before = fine_cube(4);
  std::vector<double> moves;
  for (std::size_t i = 0; i < before.vertices_mm.size(); ++i) {
    const Vector3d move = out.mesh.vertices_mm[i] - before.vertices_mm[i];
    moves.push_back(move.norm());
    if ((before.vertices_mm[i].cwiseAbs().array() == 1.0).count() == 1) {
      EXPECT_LT(
          move.cross(before.vertices_mm[i].cwiseProduct(
                         (before.vertices_mm[i].cwiseAbs().array() == 1.0).cast<double>().matrix()))
              .norm(),
          1e-14);
    }
  }
  EXPECT_NEAR(rms(moves) / 1e-3, 1.0, 0.08);
  EXPECT_EQ(out.limited_vertices, 0);
  EXPECT_TRUE(find_faults(out.mesh).none());
}

TEST(ApplyProcessing, EdgeRoughnessMovesSharpEdgesOnly) {
  const Processed out = process_cube(3, {.edge_roughness_mm = 1e-3}, 3);
  const TriangleMesh before = fine_cube(3);
  int moved = 0;
  for (std::size_t i = 0; i < before.vertices_mm.size(); ++i) {
    const bool is_edge = (before.vertices_mm[i].cwiseAbs().array() == 1.0).count() >= 2;
    EXPECT_EQ(out.mesh.vertices_mm[i] != before.vertices_mm[i], is_edge);
    moved += is_edge ? 1 : 0;
  }
  EXPECT_EQ(moved, 8 + 12 * 7);
  EXPECT_TRUE(find_faults(out.mesh).none());
}

// Noise as large as the triangles: shortened, but the surface neither folds nor crosses itself.
TEST(ApplyProcessing, NoiseThatIsTooLargeForTheMeshIsShortened) {
  int runs = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Processed out = process_cube(3, {.vertex_noise_mm = 0.3, .edge_roughness_mm = 0.3}, seed);
    EXPECT_GT(out.limited_vertices, 50);
    const MeshFaults faults = find_faults(out.mesh);
    EXPECT_TRUE(faults.none()) << faults.crossing_pairs << " " << faults.degenerate;
    ++runs;
  }
  EXPECT_EQ(runs, 20);
}

// A sheet 0.01 thick, with noise of 0.05: both sides would run through each other.
TEST(ApplyProcessing, TheTwoSidesOfAThinSheetStayApart) {
  TriangleMesh sheet = fine_cube(4);
  for (Vector3d& v : sheet.vertices_mm) {
    v.z() *= 0.005;
  }
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    const Processed out = apply_processing({.vertex_noise_mm = 0.05},
                                           seed,
                                           sheet,
                                           std::vector<std::int32_t>(sheet.num_triangles(), 0),
                                           {},
                                           kProcessingCrease_rad);
    EXPECT_TRUE(find_faults(out.mesh).none());
    EXPECT_GT(out.limited_vertices, 0);
    EXPECT_NE(out.mesh.vertices_mm, sheet.vertices_mm);
  }
}

TEST(ApplyProcessing, SubdividesBeforeItAddsNoiseAndCarriesLabels) {
  const Part part = sphere_part(2.0);
  std::vector<std::int32_t> labels(part.mesh.num_triangles(), 0);
  labels[5] = 9;
  for (const auto kind :
       {ProcessingSettings::Subdivision::kMidpoint, ProcessingSettings::Subdivision::kLoop}) {
    const Processed out =
        apply_processing({.subdivision = kind, .levels = 2, .vertex_noise_mm = 1e-4},
                         1,
                         part.mesh,
                         labels,
                         part.patches,
                         kProcessingCrease_rad);
    EXPECT_EQ(out.mesh.num_triangles(), 16 * part.mesh.num_triangles());
    EXPECT_EQ(std::ranges::count(out.labels, 9), 16);
    for (std::size_t i = 0; i < out.labels.size(); ++i) {
      ASSERT_EQ(out.origin[i], static_cast<std::int32_t>(i / 16));
      ASSERT_EQ(out.labels[i] == 9, out.origin[i] == 5);
    }
    EXPECT_TRUE(find_faults(out.mesh).none());
  }
}

TEST(ApplyProcessing, LoopOfAFreeMeshPutsVerticesWhereLoopPlacesSays) {
  TriangleMesh mesh = sphere_part(2.0).mesh;
  mesh.patch.clear();
  set_normals(mesh, {}, kProcessingCrease_rad);
  const std::vector<std::int32_t> labels(mesh.num_triangles(), 0);
  const Processed out =
      apply_processing({.subdivision = ProcessingSettings::Subdivision::kLoop, .levels = 1},
                       1,
                       mesh,
                       labels,
                       {},
                       kProcessingCrease_rad);
  const std::vector<Vector3d> known =
      loop_places(mesh, labels, subdivide_midpoint(mesh, labels, {}), kProcessingCrease_rad);
  for (std::size_t i = 0; i < known.size(); ++i) {
    ASSERT_LT((out.mesh.vertices_mm[i] - known[i]).norm(), 1e-14);
  }
  EXPECT_EQ(out.limited_vertices, 0);
}

TEST(ApplyProcessing, GivesTheSameBytesForTheSameSeedAndOthersForAnother) {
  const ProcessingSettings settings = {.levels = 1,
                                       .face_normal_noise_rad = 1e-3,
                                       .vertex_noise_mm = 1e-3,
                                       .edge_roughness_mm = 1e-3};
  const Processed a = process_cube(2, settings, 5);
  const Processed b = process_cube(2, settings, 5);
  const Processed c = process_cube(2, settings, 6);
  EXPECT_EQ(a.mesh.vertices_mm, b.mesh.vertices_mm);
  EXPECT_EQ(a.mesh.normals, b.mesh.normals);
  EXPECT_NE(a.mesh.vertices_mm, c.mesh.vertices_mm);
  EXPECT_NE(a.mesh.normals, c.mesh.normals);
}

// Slim triangles on its end faces and flanks, and edges of every angle.
TEST(ApplyProcessing, AGearWithNoiseStaysWhole) {
  const Part part = build_part(
      {.shape = PartSettings::Shape::kSpurGear, .gear = {.teeth = 12, .module_mm = 3.0}});
  ASSERT_TRUE(find_faults(part.mesh).none());
  const Processed out =
      process_part(part, {.levels = 1, .vertex_noise_mm = 0.02, .edge_roughness_mm = 0.05}, 2);
  EXPECT_TRUE(find_faults(out.mesh).none());
}

// Vertices of one face move through the other side of a box; 1000 random pushes.
TEST(MoveSafely, NeverLetsAMeshCrossItself) {
  const TriangleMesh box = fine_cube(1);
  Rng rng(3, Stream::kTest, 0);
  int shortened = 0;
  for (int round = 0; round < 1000; ++round) {
    TriangleMesh mesh = box;
    std::vector<Vector3d> moves(mesh.vertices_mm.size(), Vector3d::Zero());
    for (int i = 0; i < 3; ++i) {
      moves[rng.next_u32() % moves.size()] = random_point(rng, 3.0);
    }
    shortened += move_safely(mesh, moves) > 0 ? 1 : 0;
    ASSERT_TRUE(find_faults(mesh).none()) << round;
    ASSERT_GT(enclosed_volume_mm3(mesh), 0.0);
  }
  EXPECT_GT(shortened, 500);
}

TEST(MoveSafely, LetsThroughWhatDoesNoHarm) {
  TriangleMesh mesh = fine_cube(1);
  std::vector<Vector3d> moves(mesh.vertices_mm.size(), Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(move_safely(mesh, moves), 0);
  EXPECT_LT((mesh.vertices_mm[0] - Vector3d(0.0, 1.0, 2.0)).norm(), 1e-15);
}

// A triangle of legs 3 and 4 has the height 3 * 4 / 5 = 2.4.
TEST(LimitToHeights, ShortensToAShareOfTheSmallestHeight) {
  TriangleMesh mesh;
  mesh.vertices_mm = {{0, 0, 0}, {3, 0, 0}, {0, 4, 0}};
  mesh.triangles = {{0, 1, 2}};
  std::vector<Vector3d> moves = {{0, 0, 1}, {0, 0, -0.1}, {0, 0, 0}};
  EXPECT_EQ(limit_to_heights(mesh, 0.25, moves), 1);
  EXPECT_LT((moves[0] - Vector3d(0, 0, 0.6)).norm(), 1e-15);
  EXPECT_EQ(moves[1], Vector3d(0, 0, -0.1));
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/boolean/imprint.h"

#include <cstring>
#include <thread>

#include <gmock/gmock.h>

#include "core/error.h"
#include "defects/boolean/imprint_checks.h"
#include "defects/boolean/patch_tool.h"
#include "tests/defects/boolean/imprint_support.h"
#include "tests/defects/boolean/mesh_faults.h"

namespace glint {
namespace {

namespace support = imprint_support;
using Eigen::Vector3d;
using support::ball_at;
using support::box;
using support::cube;
using support::random_point;
using support::turned_ball_at;

constexpr ImprintOperation kSubtract = ImprintOperation::kSubtract;
constexpr ImprintOperation kUnite = ImprintOperation::kUnite;

bool is_same(const TriangleMesh& a, const TriangleMesh& b) {
  return a.triangles == b.triangles && a.patch == b.patch &&
         a.vertices_mm.size() == b.vertices_mm.size() &&
         std::memcmp(a.vertices_mm.data(),
                     b.vertices_mm.data(),
                     a.vertices_mm.size() * sizeof(Vector3d)) == 0;
}

TEST(ImprintedMesh, BallsAtGridVerticesRemoveExactParts) {
  const TriangleMesh part = cube(60.0, 6);
  const TriangleMesh ball = ball_at(Vector3d::Zero(), 3.0);
  const double volume_mm3 = enclosed_volume_mm3(ball);
  const ImprintedMesh fresh(part);
  for (const Vector3d& centre : part.vertices_mm) {
    ImprintedMesh mesh = fresh;
    const ImprintResult result =
        mesh.imprint(support::moved(ball, {.translation_mm = centre}), 1, kSubtract);
    ASSERT_TRUE(result.is_done()) << centre.transpose() << outcome_text(result.outcome);
    // Inside lies a half of the ball on a face, a quarter on an edge, an eighth in a corner.
    const auto sides = (centre.cwiseAbs().array() == 30.0).count();
    EXPECT_NEAR(result.removed_volume_mm3 / volume_mm3, 1.0 / (1 << sides), 1e-10);
    EXPECT_EQ(result.seam_loops, 1);
  }
}

TEST(ImprintedMesh, CapsHaveTheVolumeOfCaps) {
  const ImprintedMesh fresh(cube(100.0, 3));
  constexpr double kRadius_mm = 4.0;
  for (const double depth_mm : {1.0, 2.0, 3.0}) {
    ImprintedMesh mesh = fresh;
    const ImprintResult result = mesh.imprint(
        turned_ball_at({3.3, 7.7, 50.0 + kRadius_mm - depth_mm}, kRadius_mm, 5), 1, kSubtract);
    // Cap of height d: pi d^2 (3 R - d) / 3.
    const double cap_mm3 = kPi * depth_mm * depth_mm * (3.0 * kRadius_mm - depth_mm) / 3.0;
    EXPECT_NEAR(result.removed_volume_mm3 / cap_mm3, 1.0, 2e-3);
  }
}

TEST(ImprintedMesh, UnitingAddsWhatLiesOutside) {
  ImprintedMesh cut(cube(40.0, 4));
  ImprintedMesh joined(cube(40.0, 4));
  const TriangleMesh ball = turned_ball_at({1.0, 2.0, 20.5}, 3.0);
  const double removed = cut.imprint(ball, 1, kSubtract).removed_volume_mm3;
  const double added = -joined.imprint(ball, 1, kUnite).removed_volume_mm3;
  // The ball's part inside and its part outside make the ball.
  EXPECT_NEAR(removed + added, enclosed_volume_mm3(ball), 1e-10);
  EXPECT_NEAR(enclosed_volume_mm3(joined.result().mesh), 64000.0 + added, 1e-8);
  EXPECT_TRUE(find_faults(joined.result().mesh).none());
}

TEST(ImprintedMesh, KeepsWhatTheToolDoesNotTouch) {
  TriangleMesh part = cube(40.0, 8);
  part.patch.resize(part.num_triangles());
  for (std::size_t i = 0; i < part.num_triangles(); ++i) {
    part.patch[i] = static_cast<std::int32_t>(i % 7);
  }
  ImprintedMesh mesh(part);
  const ImprintResult result = mesh.imprint(turned_ball_at({1.0, 2.0, 20.5}, 3.0), 5, kSubtract);
  ASSERT_TRUE(result.is_done());
  const ImprintedMesh::Labelled out = mesh.result();
  ASSERT_EQ(
      out.mesh.num_triangles(),
      part.num_triangles() + static_cast<std::size_t>(result.new_faces - result.removed_faces));
  EXPECT_EQ(mesh.num_triangles(), out.mesh.num_triangles());
  const std::size_t untouched =
      part.num_triangles() - static_cast<std::size_t>(result.removed_faces);
  for (std::size_t i = 0; i < out.mesh.num_triangles(); ++i) {
    const std::int32_t origin = out.origin[i];
    EXPECT_EQ(out.labels[i], origin < 0 ? 5 : 0);
    EXPECT_EQ(out.mesh.patch[i], origin < 0 ? -1 : origin % 7);
    if (i < untouched) {
      ASSERT_GE(origin, 0);
      EXPECT_TRUE(i == 0 || out.origin[i - 1] < origin);
      for (std::size_t k = 0; k < 3; ++k) {
        EXPECT_EQ(out.mesh.vertex(i, k), part.vertex(static_cast<std::size_t>(origin), k));
      }
    }
  }
}

TEST(ImprintedMesh, CountsTheVolumeItsResultLost) {
  const TriangleMesh part = support::gear(5.0);
  const support::Places places(part);
  ImprintedMesh mesh(part);
  double removed_mm3 = 0.0;
  for (int i = 0; i < 60; ++i) {
    const TriangleMesh tool = support::mixed_tool(places, support::diagonal_mm(part), 3, i);
    ASSERT_EQ(tool_fault(tool), "");
    const ImprintOperation operation = i % 3 == 2 ? kUnite : kSubtract;
    const ImprintResult result = mesh.imprint(tool, i + 1, operation, {.may_break_through = true});
    EXPECT_TRUE(result.is_done()) << i << ": " << outcome_text(result.outcome);
    EXPECT_EQ(result.removed_volume_mm3 < 0.0, operation == kUnite);
    removed_mm3 += result.removed_volume_mm3;
  }
  const TriangleMesh result = mesh.result().mesh;
  EXPECT_TRUE(find_faults(result).none());
  const double lost_mm3 = enclosed_volume_mm3(part) - enclosed_volume_mm3(result);
  EXPECT_NEAR(lost_mm3, removed_mm3, 1e-9 * enclosed_volume_mm3(part));
}

TEST(ImprintedMesh, RemovesOnAverageWhatRandomPointsCount) {
  const TriangleMesh part = support::gear(6.0);
  const PatchTool inside_part(part);
  const support::Places places(part);
  const ImprintedMesh fresh(part);
  constexpr int kTools = 60;
  constexpr int kPoints = 2000;
  double sum_squares = 0.0;
  for (int i = 0; i < kTools; ++i) {
    const TriangleMesh tool = support::mixed_tool(places, support::diagonal_mm(part), 8, 5 * i);
    const PatchTool inside_tool(tool);
    ImprintedMesh mesh = fresh;
    const double removed_mm3 =
        mesh.imprint(tool, 1, kSubtract, {.may_break_through = true}).removed_volume_mm3;
    const BoundingBox bounds = bounding_box(tool);
    Rng rng(9, Stream::kTest, static_cast<std::uint64_t>(i));
    int hits = 0;
    for (int k = 0; k < kPoints; ++k) {
      Vector3d point;
      for (int axis = 0; axis < 3; ++axis) {
        point[axis] = rng.uniform(bounds.min_mm[axis], bounds.max_mm[axis]);
      }
      hits += inside_tool.contains(point) && inside_part.contains(point) ? 1 : 0;
    }
    const double share = static_cast<double>(hits) / kPoints;
    const double deviation = std::sqrt(std::max(share, 1.0 / kPoints) * (1.0 - share) / kPoints);
    const double z = (removed_mm3 / bounds.size_mm().prod() - share) / deviation;
    sum_squares += z * z;
  }
  // The mean of 60 squares of normal numbers is 1 +- sqrt(2 / 60) = 0.18; four deviations.
  EXPECT_NEAR(sum_squares / kTools, 1.0, 0.73);
}

TEST(ImprintedMesh, NamesWhyItRefuses) {
  const TriangleMesh part = cube(40.0, 4);
  const TriangleMesh before = ImprintedMesh(part).result().mesh;
  ImprintedMesh mesh(part);
  const auto outcome = [&](const TriangleMesh& tool,
                           ImprintOperation operation = kSubtract,
                           const ImprintLimits& limits = {}) {
    const ImprintResult result = mesh.imprint(tool, 1, operation, limits);
    EXPECT_EQ(result.removed_volume_mm3, 0.0);
    EXPECT_FALSE(outcome_text(result.outcome).empty());
    return result.outcome;
  };
  EXPECT_EQ(outcome(turned_ball_at({0.0, 0.0, 30.0}, 3.0)), ImprintOutcome::kNoContact);
  EXPECT_EQ(outcome(turned_ball_at({0.0, 0.0, 3.0}, 3.0)), ImprintOutcome::kSwallowed);
  EXPECT_EQ(outcome(turned_ball_at({0.0, 0.0, 3.0}, 3.0), kUnite), ImprintOutcome::kSwallowed);
  EXPECT_EQ(outcome(turned_ball_at({0.0, 0.0, 3.0}, 90.0)), ImprintOutcome::kSwallowsPart);
  EXPECT_EQ(outcome(turned_ball_at({0.0, 0.0, 22.9}, 3.0), kSubtract, {.min_removed_mm3 = 1.0}),
            ImprintOutcome::kTooLittle);
  EXPECT_EQ(outcome(box({-3.0, -3.0, 15.0}, {3.0, 3.0, 20.0}, 1)), ImprintOutcome::kOpenSeam);
  TriangleMesh open = turned_ball_at({1.0, 2.0, 20.5}, 3.0);
  open.triangles.pop_back();
  EXPECT_EQ(outcome(open), ImprintOutcome::kBrokenTool);
  EXPECT_TRUE(is_same(mesh.result().mesh, before));
}

TEST(ImprintedMesh, RefusesTunnelsAndCutOffPiecesUnlessAllowed) {
  const ImprintedMesh plate(box({0.0, 0.0, 0.0}, {40.0, 30.0, 2.0}, 5));
  const TriangleMesh through = turned_ball_at({11.1, 12.2, 1.0}, 3.0);
  ImprintedMesh refused = plate;
  EXPECT_EQ(refused.imprint(through, 1, kSubtract).outcome, ImprintOutcome::kBreaksThrough);
  EXPECT_EQ(refused.imprint(through, 1, kUnite).outcome, ImprintOutcome::kBreaksThrough);
  ImprintedMesh allowed = plate;
  const ImprintResult tunnel = allowed.imprint(through, 1, kSubtract, {.may_break_through = true});
  EXPECT_TRUE(tunnel.is_done());
  EXPECT_EQ(tunnel.seam_loops, 2);
  EXPECT_TRUE(find_faults(allowed.result().mesh).none());
  const ImprintedMesh bar(box({0.0, 0.0, 0.0}, {40.0, 3.0, 2.0}, 5));
  const TriangleMesh slice = box({11.1, -1.0, -1.0}, {12.3, 4.0, 3.1}, 3);
  ImprintedMesh whole = bar;
  EXPECT_EQ(whole.imprint(slice, 1, kSubtract).outcome, ImprintOutcome::kBreaksThrough);
  // 1.2 x 3 x 2 mm are cut out.
  EXPECT_NEAR(whole.imprint(slice, 1, kSubtract, {.may_break_through = true}).removed_volume_mm3,
              7.2,
              1e-10);
  // Two loops on one side are no tunnel: a dent over the end of the plate's corner.
  ImprintedMesh corner = plate;
  EXPECT_TRUE(corner.imprint(turned_ball_at({0.1, 0.2, 1.0}, 3.0), 1, kSubtract).is_done());
}

TEST(ImprintedMesh, WorksOnOpenPartsAwayFromTheirHoles) {
  TriangleMesh part = cube(40.0, 8);
  std::erase_if(part.triangles, [&](const Triangle& t) {
    return part.vertices_mm[static_cast<std::size_t>(t[0])].z() == -20.0 &&
           part.vertices_mm[static_cast<std::size_t>(t[1])].z() == -20.0 &&
           part.vertices_mm[static_cast<std::size_t>(t[2])].z() == -20.0;
  });
  ImprintedMesh mesh(part);
  const MeshFaults before = find_faults(mesh.result().mesh);
  EXPECT_EQ(before.open_edges, 32);  // 8 a side
  EXPECT_TRUE(mesh.imprint(turned_ball_at({1.0, 2.0, 20.5}, 3.0), 1, kSubtract).is_done());
  EXPECT_FALSE(mesh.imprint(turned_ball_at({20.0, 2.0, -20.5}, 3.0), 1, kSubtract).is_done());
  const MeshFaults after = find_faults(mesh.result().mesh);
  EXPECT_EQ(after.open_edges, 32);
  EXPECT_EQ(after.crossing_pairs + after.degenerate + after.repeated_edges, 0);
}

TEST(ImprintedMesh, GivesTheSameBytesForCopiesAndThreads) {
  const TriangleMesh part = support::gear(6.0);
  const support::Places places(part);
  const ImprintedMesh fresh(part);
  std::array<ImprintedMesh::Labelled, 4> results;
  const auto work = [&](ImprintedMesh mesh, ImprintedMesh::Labelled& out) {
    for (int i = 0; i < 20; ++i) {
      mesh.imprint(support::mixed_tool(places, 140.0, 4, i), i + 1, kSubtract);
    }
    out = mesh.result();
  };
  work(ImprintedMesh(part), results[0]);
  std::vector<std::thread> threads;
  for (std::size_t i = 1; i < results.size(); ++i) {
    threads.emplace_back([&, i] { work(fresh, results[i]); });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  for (std::size_t i = 1; i < results.size(); ++i) {
    EXPECT_TRUE(is_same(results[i].mesh, results[0].mesh));
    EXPECT_EQ(results[i].labels, results[0].labels);
    EXPECT_EQ(results[i].origin, results[0].origin);
  }
  EXPECT_TRUE(is_same(ImprintedMesh(part).result().mesh, fresh.result().mesh));
}

TEST(ImprintedMesh, NeedsLessThan150BytesAFaceBesideThePart) {
  const TriangleMesh part = support::gear(2.0);
  const ImprintedMesh mesh(part);
  EXPECT_LT(static_cast<double>(mesh.memory_bytes()) / static_cast<double>(part.num_triangles()),
            150.0);
}

TEST(ImprintedMesh, RefusesUnusableParts) {
  TriangleMesh part = cube(40.0, 2);
  part.triangles[3][1] = 1000;
  EXPECT_THROW(ImprintedMesh{part}, ConfigError);
}

TEST(Jittered, CuresFlushTools) {
  const ImprintedMesh fresh(cube(100.0, 20));
  for (int i = 0; i < 25; ++i) {
    const int row = i / 5;
    const double x_mm = -40.0 + 20.0 * (i % 5);
    const double y_mm = -40.0 + 20.0 * row;
    const TriangleMesh tool =
        box({x_mm - 2.5, y_mm - 2.5, 45.0}, {x_mm + 2.5, y_mm + 2.5, 50.0}, 2);
    Rng rng(6, Stream::kTest, static_cast<std::uint64_t>(i));
    ImprintedMesh mesh = fresh;
    ImprintResult result = mesh.imprint(tool, 1, kSubtract);
    for (int retry = 1; retry <= 8 && !result.is_done(); ++retry) {
      result = mesh.imprint(jittered(tool, jitter_size(retry), rng), 1, kSubtract);
    }
    ASSERT_TRUE(result.is_done()) << i << ": " << outcome_text(result.outcome);
    EXPECT_NEAR(result.removed_volume_mm3, 125.0, 0.1 * 125.0);
  }
}

TEST(Jittered, MovesByAtMostItsSize) {
  const TriangleMesh tool = turned_ball_at({5.0, 6.0, 7.0}, 2.0);
  const double diagonal_mm = support::diagonal_mm(tool);
  for (int i = 0; i < 1000; ++i) {
    Rng rng(7, Stream::kTest, static_cast<std::uint64_t>(i));
    const TriangleMesh moved = jittered(tool, 1e-3, rng);
    EXPECT_NEAR(enclosed_volume_mm3(moved), enclosed_volume_mm3(tool), 1e-9);
    // sqrt(3) of the diagonal by the shift, and sqrt(3) of half of it by the turn.
    const double step_mm = (moved.vertices_mm[0] - tool.vertices_mm[0]).norm();
    EXPECT_LT(step_mm, 2.6e-3 * diagonal_mm);
    EXPECT_GT(step_mm, 0.0);
  }
  EXPECT_DOUBLE_EQ(jitter_size(1), 1e-4);
  EXPECT_DOUBLE_EQ(jitter_size(20), 3e-2);
}

TEST(ToolFault, NamesWhatIsWrong) {
  const TriangleMesh ball = turned_ball_at({0.0, 0.0, 0.0}, 1.0);
  EXPECT_EQ(tool_fault(ball), "");
  TriangleMesh open = ball;
  open.triangles.pop_back();
  EXPECT_EQ(tool_fault(open), "it is not closed: 3 open edges");
  TriangleMesh inverted = ball;
  for (Triangle& triangle : inverted.triangles) {
    std::swap(triangle[0], triangle[1]);
  }
  EXPECT_EQ(tool_fault(inverted), "it is turned inside out");
  TriangleMesh flipped = ball;
  std::swap(flipped.triangles[0][0], flipped.triangles[0][1]);
  EXPECT_NE(tool_fault(flipped), "");
  TriangleMesh flat = ball;
  flat.vertices_mm[static_cast<std::size_t>(flat.triangles[0][0])] =
      flat.vertices_mm[static_cast<std::size_t>(flat.triangles[0][1])];
  EXPECT_EQ(tool_fault(flat), "triangle 0 has no area");
  TriangleMesh spiked = ball;
  spiked.vertices_mm[0] *= -2.0;
  EXPECT_EQ(tool_fault(spiked), "it crosses itself");
}

TEST(FindFaults, CountsCrossingFacesOfTwoBoxes) {
  // An edge of the small box of 12 triangles sticks through one triangle of the large one.
  TriangleMesh mesh = box({0.0, 0.0, 0.0}, {10.0, 10.0, 10.0}, 1);
  EXPECT_TRUE(find_faults(mesh).none());
  const TriangleMesh other = box({7.0, 1.0, 9.0}, {8.0, 1.5, 11.0}, 1);
  const auto first = static_cast<std::int32_t>(mesh.vertices_mm.size());
  mesh.vertices_mm.insert(
      mesh.vertices_mm.end(), other.vertices_mm.begin(), other.vertices_mm.end());
  for (const Triangle& t : other.triangles) {
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  const MeshFaults faults = find_faults(mesh);
  // Two triangles for each of the four walls that go through the plane z = 10.
  EXPECT_EQ(faults.crossing_pairs, 8);
  EXPECT_EQ(faults.open_edges + faults.repeated_edges + faults.degenerate, 0);
  mesh.triangles.push_back(mesh.triangles[0]);
  EXPECT_EQ(find_faults(mesh).repeated_edges, 3);
}

}  // namespace
}  // namespace glint

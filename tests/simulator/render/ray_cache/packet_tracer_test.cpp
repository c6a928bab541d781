// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/ray_cache/packet_tracer.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <utility>

#include <gtest/gtest.h>

#include "core/rng.h"
#include "tests/simulator/geometry/geometry_fixtures.h"
#include "tests/simulator/render/render_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector3d;

Part part_of(TriangleMesh mesh) {
  Part part;
  part.name = "mesh";
  part.mesh = std::move(mesh);
  smooth_normals(part.mesh, 0.5);
  part.box_in_part_mm = bounding_box(part.mesh);
  return part;
}

/// A cube with a triangle of no area, one that lies twice and a spike on its top.
TriangleMesh spiked_cube() {
  TriangleMesh mesh = cube_mesh(10.0);
  mesh.vertices_mm.emplace_back(0.0, 0.0, 14.0);
  mesh.vertices_mm.emplace_back(1.0, 0.0, 10.0);
  mesh.vertices_mm.emplace_back(0.0, 1.0, 10.0);
  mesh.triangles.push_back({8, 9, 10});
  mesh.triangles.push_back({0, 0, 1});
  mesh.triangles.push_back(mesh.triangles[2]);
  return mesh;
}

/// A cube without its top: rays fall in and are sent to and fro.
TriangleMesh open_cube() {
  TriangleMesh mesh = cube_mesh(10.0);
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return std::ranges::all_of(
        t, [&](std::int32_t i) { return mesh.vertices_mm[static_cast<std::size_t>(i)].z() > 0.0; });
  });
  return mesh;
}

/// How many rays of a picture took which way.
struct Ways {
  int missed = 0;
  int once = 0;
  int again = 0;
};

/// The start of a reflected ray above the triangle that was met.
Vector3d start_of(const EscapePacket& escapes,
                  const TrianglePlane& plane,
                  const Vector3d& arriving,
                  std::size_t lane) {
  const Vector3d normal(plane.normal_x, plane.normal_y, plane.normal_z);
  const double side = normal.dot(arriving) > 0.0 ? -1.0 : 1.0;
  return Vector3d(escapes.origin_x[lane], escapes.origin_y[lane], escapes.origin_z[lane]) +
         1e-3 * side * normal;
}

void expect_same(const EscapePacket& quick, const EscapePacket& plain, std::size_t lane) {
  ASSERT_EQ(quick.path[lane], plain.path[lane]);
  ASSERT_EQ(quick.is_grazing[lane], plain.is_grazing[lane]);
  ASSERT_EQ(quick.origin_x[lane], plain.origin_x[lane]);
  ASSERT_EQ(quick.origin_y[lane], plain.origin_y[lane]);
  ASSERT_EQ(quick.origin_z[lane], plain.origin_z[lane]);
  ASSERT_EQ(quick.direction_x[lane], plain.direction_x[lane]);
  ASSERT_EQ(quick.direction_y[lane], plain.direction_y[lane]);
  ASSERT_EQ(quick.direction_z[lane], plain.direction_z[lane]);
  ASSERT_EQ(quick.weight[lane], plain.weight[lane]);
}

/// Traces a picture with and without what the mesh tells of rays that meet nothing, and asks the
/// ray tracer about each ray that is said to have escaped after one reflection.
Ways expect_nothing_overlooked(const Part& part, const CameraSettings& settings) {
  const Bvh bvh(part.mesh);
  const SurfaceDetail detail;
  const RenderSettings render = {.rays_per_axis = 1, .reflectance = 0.9};
  const TraceScene scene(part, bvh, detail, render);
  TraceScene without(part, bvh, detail, render);
  const EscapeCone unknown;
  without.escape_cone = &unknown;
  const PinholeCamera pinhole(intrinsics_of(settings));
  const CameraRays camera(pinhole, camera_from_world(default_viewpoint(settings)));
  PacketTracer quick(scene);
  PacketTracer plain(without);
  Ways ways;
  for (int y = 0; y < settings.height_px; ++y) {
    for (int x = 0; x + kPacketSize <= settings.width_px; x += kPacketSize) {
      Lanes x_px;
      Lanes y_px;
      for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
        x_px[lane] = x + static_cast<double>(lane) + 0.47;
        y_px[lane] = y + 0.53;
      }
      CameraPacket rays;
      EscapePacket by_quick;
      EscapePacket by_plain;
      camera.through(x_px.data(), y_px.data(), kPacketSize, rays);
      quick.trace(rays, by_quick);
      plain.trace(rays, by_plain);
      for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
        expect_same(by_quick, by_plain, lane);
        ways.missed += by_quick.path[lane] == RayPath::kMissed ? 1 : 0;
        ways.again += by_quick.path[lane] >= RayPath::kFollowed ? 1 : 0;
        if (by_quick.path[lane] == RayPath::kOnce && !by_quick.is_grazing[lane]) {
          ++ways.once;
          const Vector3d arriving(
              rays.direction_x[lane], rays.direction_y[lane], rays.direction_z[lane]);
          const Vector3d leaving(
              by_quick.direction_x[lane], by_quick.direction_y[lane], by_quick.direction_z[lane]);
          const TrianglePlane& plane = bvh.plane(quick.hits().triangle[lane]);
          EXPECT_FALSE(bvh.occluded(start_of(by_quick, plane, arriving, lane), leaving, 0.0, 1e6));
        }
      }
    }
  }
  return ways;
}

TEST(PacketTracer, OverlooksNothingOnAGear) {
  const Part gear = build_part({.shape = PartSettings::Shape::kSpurGear});
  const Ways ways = expect_nothing_overlooked(gear, test::far_camera(160, 90, 0.3));
  EXPECT_GT(ways.missed, 1000);
  EXPECT_GT(ways.once, 1000);
  EXPECT_GT(ways.again, 1000);
}

TEST(PacketTracer, OverlooksNothingOnAConvexPart) {
  const Ways ways =
      expect_nothing_overlooked(part_of(cube_mesh(10.0)), test::far_camera(64, 48, 0.5));
  EXPECT_GT(ways.once, 1000);
  EXPECT_EQ(ways.again, 0);
}

TEST(PacketTracer, OverlooksNothingOnDegenerateAndRepeatedTriangles) {
  const Ways ways =
      expect_nothing_overlooked(part_of(spiked_cube()), test::far_camera(64, 48, 0.5));
  EXPECT_GT(ways.once, 1000);
}

TEST(PacketTracer, OverlooksNothingInAnOpenMesh) {
  TriangleMesh mesh = open_cube();
  for (Vector3d& vertex : mesh.vertices_mm) {  // slanted walls, so that rays meet them
    vertex.x() *= vertex.z() < 0.0 ? 0.4 : 1.0;
  }
  const Ways ways =
      expect_nothing_overlooked(part_of(std::move(mesh)), test::far_camera(64, 48, 0.5));
  EXPECT_GT(ways.again, 300);
}

/// Numbers that differ from lane to lane.
IntersectionLanes random_lanes(Rng& rng) {
  IntersectionLanes lanes = {};
  for (double* array : {lanes.point_x,
                        lanes.point_y,
                        lanes.point_z,
                        lanes.leaving_x,
                        lanes.leaving_y,
                        lanes.leaving_z,
                        lanes.start_x,
                        lanes.start_y,
                        lanes.start_z,
                        lanes.rise,
                        lanes.reflectance}) {
    std::generate_n(array, kLanes, [&] { return rng.uniform(-1.0, 1.0); });
  }
  return lanes;
}

HitPacket some_hits() {
  HitPacket hits;
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    hits.triangle[lane] = lane % 3 == 0 ? -1 : static_cast<std::int32_t>(lane);
  }
  return hits;
}

TEST(AskReflected16, TracesRaysWithAHitThatRise) {
  Rng rng(81, Stream::kTest, 0);
  const IntersectionLanes lanes = random_lanes(rng);
  const HitPacket hits = some_hits();
  RayQuery query;
  query.triangle.fill(7);
  ask_reflected16(lanes, hits.triangle.data(), query);
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    EXPECT_EQ(query.origin_y[lane], static_cast<float>(lanes.start_y[lane]));
    EXPECT_EQ(query.direction_z[lane], static_cast<float>(lanes.leaving_z[lane]));
    EXPECT_EQ(query.t_max[lane], std::numeric_limits<float>::infinity());
    EXPECT_EQ(query.valid[lane], hits.triangle[lane] >= 0 && lanes.rise[lane] > 0.0 ? -1 : 0);
    EXPECT_EQ(query.triangle[lane], -1);
    EXPECT_EQ(query.geometry[lane], -1);
  }
}

TEST(EscapeAgain16, ChangesOnlyLanesThatMetThePartAgain) {
  Rng rng(82, Stream::kTest, 0);
  const IntersectionLanes first = random_lanes(rng);
  const IntersectionLanes second = random_lanes(rng);
  const HitPacket hits = some_hits();
  EscapePacket escapes;
  const EscapeArrays arrays = arrays_of(escapes);
  Lanes of_path;
  of_path.fill(0.5);
  escapes.weight.fill(0.25F);
  escape16(first, arrays);
  escape_again16(second, hits.triangle.data(), 0.9, of_path.data(), arrays, escapes.weight.data());
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    const bool is_hit = hits.triangle[lane] >= 0;
    const IntersectionLanes& last = is_hit ? second : first;
    const double expected = is_hit ? 0.5 * (0.9 * second.reflectance[lane]) : 0.5;
    EXPECT_EQ(escapes.seen_z[lane], first.point_z[lane]);
    EXPECT_EQ(escapes.origin_x[lane], last.point_x[lane]);
    EXPECT_EQ(escapes.direction_y[lane], last.leaving_y[lane]);
    EXPECT_EQ(of_path[lane], expected);
    EXPECT_EQ(escapes.weight[lane], is_hit ? static_cast<float>(expected) : 0.25F);
  }
}

TEST(TakeHits16, TellsWhetherAnyRayMetSomething) {
  RayQuery query;
  HitPacket hits;
  EXPECT_FALSE(take_hits16(query, hits));
  query.triangle[9] = 0;
  query.t_max[9] = 2.5F;
  query.u[9] = 0.25F;
  EXPECT_TRUE(take_hits16(query, hits));
  EXPECT_EQ(hits.triangle[9], 0);
  EXPECT_EQ(hits.triangle[8], -1);
  EXPECT_EQ(hits.t_mm[9], 2.5F);
  EXPECT_EQ(hits.u[9], 0.25F);
}

TEST(CommonTriangle16, IsThatOfAllLanesOrNone) {
  HitPacket hits;
  hits.triangle.fill(12);
  EXPECT_EQ(common_triangle16(hits), 12);
  hits.triangle[15] = 13;
  EXPECT_EQ(common_triangle16(hits), -1);
  hits.triangle.fill(-1);
  EXPECT_EQ(common_triangle16(hits), -1);
}

}  // namespace
}  // namespace glint

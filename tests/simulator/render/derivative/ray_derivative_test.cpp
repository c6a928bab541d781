// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/derivative/ray_derivative.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "core/rng.h"
#include "simulator/render/ray_cache/packet_tracer.h"
#include "tests/simulator/render/render_fixtures.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

const CameraSettings kMovingCamera = {
    .width_px = 60, .height_px = 40, .object_pixel_mm = 0.5, .working_distance_mm = 300.0};

/// A part under an oblique camera.
struct MovingBench {
  Part part;
  Bvh bvh;
  SurfaceDetail detail;
  PinholeCamera camera;
  RigidTransform camera_from_world;
  RenderSettings settings;

  explicit MovingBench(Part built, std::vector<HeightFeature> features = {})
      : part(std::move(built)),
        bvh(part.mesh),
        detail(std::move(features)),
        camera(intrinsics_of(kMovingCamera)),
        camera_from_world(glint::camera_from_world({.position_mm = {20.0, -35.0, 290.0},
                                                    .direction = {-20.0, 35.0, -290.0},
                                                    .up = {0.1, 1.0, 0.0}})) {}

  CameraScene scene() const {
    return {.part = part,
            .bvh = bvh,
            .detail = detail,
            .camera = camera,
            .camera_from_world = camera_from_world,
            .settings = settings};
  }

  struct Traced : EscapePacket {
    std::int32_t triangle = -1;
  };

  Traced trace(const Vector2d& pixel_px, const RigidTransform& from_world) const {
    CameraPacket packet;
    Traced escapes;
    CameraRays(camera, from_world).through(&pixel_px.x(), &pixel_px.y(), 1, packet);
    const TraceScene traced(part, bvh, detail, settings);
    PacketTracer tracer(traced);
    tracer.trace(packet, escapes);
    escapes.triangle = tracer.hits().triangle[0];
    return escapes;
  }
};

std::vector<CameraTwist> all_twists() {
  std::vector<CameraTwist> twists;
  for (int axis = 0; axis < 3; ++axis) {
    twists.push_back({.translation_mm = Vector3d::Unit(axis)});
    twists.push_back({.rotation_rad = Vector3d::Unit(axis)});
  }
  twists.push_back({.translation_mm = {0.3, -2.0, 0.5}, .rotation_rad = {0.01, -0.02, 0.005}});
  return twists;
}

Vector3d origin_of_escape(const EscapePacket& e) {
  return {e.origin_x[0], e.origin_y[0], e.origin_z[0]};
}

Vector3d direction_of_escape(const EscapePacket& e) {
  return {e.direction_x[0], e.direction_y[0], e.direction_z[0]};
}

/// The camera after `unit` times a motion.
RigidTransform moved_camera(const RigidTransform& camera_from_world,
                            const CameraTwist& twist,
                            double unit) {
  RigidTransform world_from_camera = inverse(camera_from_world);
  world_from_camera.translation_mm += unit * twist.translation_mm;
  const double angle_rad = unit * twist.rotation_rad.norm();
  if (angle_rad != 0.0) {
    world_from_camera.rotation =
        Eigen::AngleAxisd(angle_rad, twist.rotation_rad.normalized()).toRotationMatrix() *
        world_from_camera.rotation;
  }
  return inverse(world_from_camera);
}

struct Agreement {
  int compared = 0;
  double worst = 0.0;  ///< difference in units of 1 mm/mm, or of the distance per rad
};

/// Compares with cameras that are really moved. `step_mm` on the part.
Agreement compare(const MovingBench& bench, double step_mm) {
  ThreadPool pool(1);
  const std::vector<CameraTwist> twists = all_twists();
  const auto derivatives = corner_derivatives(bench.scene(), twists, pool);
  Agreement agreement;
  for (std::size_t k = 0; k < twists.size(); ++k) {
    const double speed = twists[k].translation_mm.norm() + twists[k].rotation_rad.norm() * 300.0;
    const double unit = step_mm / speed;
    const RigidTransform before = moved_camera(bench.camera_from_world, twists[k], -unit);
    const RigidTransform after = moved_camera(bench.camera_from_world, twists[k], unit);
    const RayDerivative& d = derivatives[k];
    for (int y = 0; y <= 40; y += 2) {
      for (int x = 0; x <= 60; x += 2) {
        const auto i = static_cast<std::size_t>(y * 61 + x);
        const MovingBench::Traced here = bench.trace({x, y}, bench.camera_from_world);
        const MovingBench::Traced a = bench.trace({x, y}, before);
        const MovingBench::Traced b = bench.trace({x, y}, after);
        const Vector3d origin = vector_of(d.origin_x[i], d.origin_y[i], d.origin_z[i]);
        const Vector3d direction = vector_of(d.direction_x[i], d.direction_y[i], d.direction_z[i]);
        if (here.path[0] != RayPath::kOnce) {
          EXPECT_EQ(origin, Vector3d::Zero());
          EXPECT_EQ(direction, Vector3d::Zero());
          continue;
        }
        if (a.path[0] != RayPath::kOnce || b.path[0] != RayPath::kOnce ||
            a.piece[0] != here.piece[0] || b.piece[0] != here.piece[0] ||
            (here.piece[0] < 0 && (a.triangle != here.triangle || b.triangle != here.triangle))) {
          continue;
        }
        const Vector3d origin_change = (origin_of_escape(b) - origin_of_escape(a)) / (2.0 * unit);
        const Vector3d direction_change =
            (direction_of_escape(b) - direction_of_escape(a)) / (2.0 * unit);
        agreement.worst = std::max({agreement.worst,
                                    (origin_change - origin).norm() / speed,
                                    (direction_change - direction).norm() / speed});
        ++agreement.compared;
      }
    }
  }
  return agreement;
}

Part strip_for_motion() {
  return build_part({.shape = PartSettings::Shape::kStrip,
                     .length_mm = 80.0,
                     .width_mm = 50.0,
                     .radius_along_mm = 400.0,
                     .radius_across_mm = 60.0});
}

HeightFeature dent_on(const Part& part, double x_mm, double y_mm, double sigma_mm, bool moves) {
  const Bvh bvh(part.mesh);
  const auto place = place_on_surface(part, bvh, x_mm, y_mm);
  HeightFeature dent;
  dent.label = "dent";
  dent.centre_mm = place->centre_mm;
  dent.u_axis = place->u_axis;
  dent.v_axis = place->v_axis;
  dent.normal = place->normal;
  dent.sigma_mm = sigma_mm;
  dent.height_mm = -0.02 * sigma_mm;
  dent.moves_position = moves;
  return dent;
}

// A plate at z = 1 under a camera at (20, -35, 290) that moves by 1 mm along z: a ray to the point
// p moves its hit by (p - c) / (c_z - 1) sideways, i.e. away from the camera's foot, negated: the
// ray starts higher, so that it lands further out by (p - c) / 289. Directions stay as they are.
TEST(RayDerivative, OfAPlateIsTheHandWorkedOne) {
  PartSettings large = test::plate();
  large.length_mm = 300.0;
  large.width_mm = 300.0;
  const MovingBench bench(build_part(large));
  ThreadPool pool(1);
  const auto d = corner_derivatives(bench.scene(), {{.translation_mm = {0.0, 0.0, 1.0}}}, pool);
  for (int y = 0; y <= 40; y += 8) {
    for (int x = 0; x <= 60; x += 12) {
      const auto i = static_cast<std::size_t>(y * 61 + x);
      const Vector3d p = origin_of_escape(bench.trace({x, y}, bench.camera_from_world));
      EXPECT_NEAR(static_cast<double>(d[0].origin_x[i]), (p.x() - 20.0) / 289.0, 1e-6);
      EXPECT_NEAR(static_cast<double>(d[0].origin_y[i]), (p.y() + 35.0) / 289.0, 1e-6);
      EXPECT_NEAR(static_cast<double>(d[0].origin_z[i]), 0.0, 1e-6);
      EXPECT_NEAR(static_cast<double>(d[0].direction_x[i]), 0.0, 1e-7);
      EXPECT_NEAR(static_cast<double>(d[0].direction_z[i]), 0.0, 1e-7);
    }
  }
}

// The narrowest dent has sigma 0.2 mm: a step of 1e-3 mm errs by (1e-3 / 0.2)^2 / 6 = 4e-6 of its
// derivative's change, which is 2 x 0.02 / 0.2 per mm; floats carry 6e-8 of up to 2.
TEST(RayDerivative, IsThatOfRaysTracedAgainOnAStripWithDents) {
  const Part part = strip_for_motion();
  const MovingBench bench(part,
                          {dent_on(part, 0.0, 0.0, 1.5, false),
                           dent_on(part, -6.0, 4.0, 0.8, true),
                           dent_on(part, 7.0, -3.0, 0.2, false)});
  const Agreement agreement = compare(bench, 1e-3);
  EXPECT_GE(agreement.compared, 1000);
  EXPECT_LT(agreement.worst, 2e-6);
}

TEST(RayDerivative, IsThatOfRaysTracedAgainOnASphere) {
  const MovingBench bench(
      build_part({.shape = PartSettings::Shape::kSphereCap, .radius_mm = 30.0, .height_mm = 12.0}));
  const Agreement agreement = compare(bench, 1e-3);
  EXPECT_GE(agreement.compared, 1000);
  EXPECT_LT(agreement.worst, 2e-6);
}

TEST(RayDerivative, IsThatOfRaysTracedAgainOnAGear) {
  PartSettings gear;
  gear.shape = PartSettings::Shape::kSpurGear;
  const MovingBench bench(build_part(gear));
  const Agreement agreement = compare(bench, 1e-4);  // involutes are strongly bent at their start
  EXPECT_GE(agreement.compared, 1000);
  EXPECT_LT(agreement.worst, 1e-4);
}

// Embree's float direction places a hit on triangles to 300 mm x 6e-8 = 2e-5 mm; over a step of
// 0.02 mm that is 1e-3. Rays that cross from one triangle to the next are left out.
TEST(RayDerivative, IsThatOfRaysTracedAgainOnTriangles) {
  Part part;
  part.mesh.vertices_mm = {{-40, -40, -4}, {40, -40, 0}, {40, 40, -5}, {-40, 40, -2}, {3, 2, 3}};
  part.mesh.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  smooth_normals(part.mesh, 1.0);
  part.box_in_part_mm = bounding_box(part.mesh);
  const MovingBench bench(part);
  const Agreement agreement = compare(bench, 0.02);
  EXPECT_GE(agreement.compared, 1000);
  EXPECT_LT(agreement.worst, 5e-3);
}

TEST(RayDerivative, OfRefinedRaysIsThatOfRaysTracedAgain) {
  const Part part = strip_for_motion();
  const MovingBench bench(part, {dent_on(part, 0.0, 0.0, 0.3, false)});
  ThreadPool pool(1);
  const CornerRays rays = trace_corner_rays(bench.part,
                                            bench.bvh,
                                            bench.detail,
                                            bench.camera,
                                            bench.camera_from_world,
                                            bench.settings,
                                            pool);
  const CameraTwist twist = {.translation_mm = {1.0, 0.0, 0.0}};
  int compared = 0;
  for (const RefinedGroup& group : rays.refined) {
    const auto d = refined_derivatives(bench.scene(), group, {twist}, pool);
    const int n = group.cells_per_axis;
    for (std::size_t i = 0; i < group.rays.weight.size(); i += 7) {
      const std::size_t corners = static_cast<std::size_t>((n + 1) * (n + 1));
      const int pixel = group.pixels[i / corners];
      const auto corner = static_cast<int>(i % corners);
      const int row = pixel / 60;
      const int row_in_pixel = corner / (n + 1);
      const Vector2d at(pixel % 60 + static_cast<double>(corner % (n + 1)) / n,
                        row + static_cast<double>(row_in_pixel) / n);
      const auto a = bench.trace(at, moved_camera(bench.camera_from_world, twist, -1e-3));
      const auto b = bench.trace(at, moved_camera(bench.camera_from_world, twist, 1e-3));
      if (a.path[0] != RayPath::kOnce || b.path[0] != RayPath::kOnce || a.piece[0] != b.piece[0]) {
        continue;
      }
      const Vector3d change = (direction_of_escape(b) - direction_of_escape(a)) / 2e-3;
      const Vector3d direction =
          vector_of(d[0].direction_x[i], d[0].direction_y[i], d[0].direction_z[i]);
      ASSERT_LT((change - direction).norm(), 1e-5);
      ++compared;
    }
  }
  EXPECT_GE(compared, 100);
}

TEST(RayDerivative, OfNoMotionIsZero) {
  const MovingBench bench(build_part(test::plate()));
  ThreadPool pool(1);
  const auto d = corner_derivatives(bench.scene(), {CameraTwist{}}, pool);
  EXPECT_THAT(d[0].origin_x, ::testing::Each(0.0F));
  EXPECT_THAT(d[0].direction_y, ::testing::Each(0.0F));
}

TEST(RayDerivative, IsTheSameBytesForOneAndTwoThreads) {
  const Part part = strip_for_motion();
  const MovingBench bench(part, {dent_on(part, 0.0, 0.0, 0.3, false)});
  ThreadPool one(1);
  ThreadPool two(2);
  const auto a = corner_derivatives(bench.scene(), all_twists(), one);
  const auto b = corner_derivatives(bench.scene(), all_twists(), two);
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].origin_x, b[k].origin_x);
    EXPECT_EQ(a[k].direction_z, b[k].direction_z);
  }
}

}  // namespace
}  // namespace glint

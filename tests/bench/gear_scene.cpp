// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/gear_scene.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "simulator/camera/camera_settings.h"
#include "simulator/light/area/build_lights.h"

namespace glint::bench {
namespace {

using Eigen::Vector3d;

constexpr int kTeeth = 24;
constexpr int kStepsPerTooth = 40;
constexpr int kSteps = kTeeth * kStepsPerTooth;
constexpr int kRings = 32;   ///< of quads on a face
constexpr int kLayers = 12;  ///< of quads on a wall
constexpr double kBore_mm = 10.0;
constexpr double kRoot_mm = 30.0;
constexpr double kTip_mm = 36.0;
constexpr double kThickness_mm = 12.0;
constexpr std::size_t kTriangles = 168960;
constexpr std::array<double, 3> kWavelengths_nm = {620.0, 550.0, 460.0};

/// Rises from 0 at a to 1 at b.
double ramp(double a, double b, double x) {
  return std::clamp((x - a) / (b - a), 0.0, 1.0);
}

double outer_radius_mm(int step) {
  const double u = static_cast<double>(step % kStepsPerTooth) / kStepsPerTooth;
  const double h = ramp(0.10, 0.30, u) - ramp(0.60, 0.80, u);
  return kRoot_mm + (kTip_mm - kRoot_mm) * h * h * (3.0 - 2.0 * h);
}

/// Rows of points around the axis, joined by quads that face away from the metal.
class GridBuilder {
 public:
  /// @param at  (row, step) -> (radius, z) @param is_turned  the front lies on the other side
  template <class RadiusAndHeight>
  void add(int rows, bool is_turned, const RadiusAndHeight& at) {
    const auto first = static_cast<std::int32_t>(points_mm_.size());
    for (int row = 0; row <= rows; ++row) {
      for (int step = 0; step < kSteps; ++step) {
        const std::array<double, 2> place = at(row, step);
        const double angle_rad = 2.0 * kPi * step / kSteps;
        points_mm_.push_back(
            Vector3d(place[0] * std::cos(angle_rad), place[0] * std::sin(angle_rad), place[1])
                .cast<float>());
      }
    }
    for (int row = 0; row < rows; ++row) {
      for (int step = 0; step < kSteps; ++step) {
        const std::int32_t a = first + row * kSteps + step;
        const std::int32_t d = first + row * kSteps + (step + 1) % kSteps;
        add_quad({a, a + kSteps, d + kSteps, d}, is_turned);
      }
    }
  }

  TriangleMesh finish() {
    for (const Eigen::Vector3f& point_mm : points_mm_) {
      mesh_.vertices_mm.emplace_back(point_mm.cast<double>());
    }
    weld(mesh_);
    return std::move(mesh_);
  }

 private:
  void add_quad(std::array<std::int32_t, 4> corners, bool is_turned) {
    if (is_turned) {
      std::ranges::reverse(corners);
    }
    mesh_.triangles.push_back({corners[0], corners[1], corners[2]});
    mesh_.triangles.push_back({corners[0], corners[2], corners[3]});
  }

  /// Kept as floats: GCC 12 drops a conversion to float and straight back when it vectorises.
  std::vector<Eigen::Vector3f> points_mm_;
  TriangleMesh mesh_;
};

Part gear_part(double tilt_rad) {
  Part part;
  part.name = "gear";
  part.mesh = make_gear_mesh();
  part.box_in_part_mm = bounding_box(part.mesh);
  part.scene_from_part = pose_from_angles(Vector3d::Zero(), {tilt_rad, 0.0, 0.0});
  transform(part.mesh, part.scene_from_part);
  return part;
}

MaterialSettings brushed(const GearSetup& setup) {
  MaterialSettings metal;
  metal.type = MaterialSettings::Type::kConductor;
  metal.colour_srgb.assign(std::begin(setup.colour_srgb), std::end(setup.colour_srgb));
  metal.roughness = setup.roughness;
  metal.anisotropy = setup.anisotropy;
  metal.multiple_reflections = setup.has_compensation;
  metal.lay.kind = LaySettings::Kind::kTurned;
  return metal;
}

CameraSettings camera_settings(const GearSetup& setup) {
  return {.width_px = setup.width_px,
          .height_px = setup.height_px,
          .working_distance_mm = setup.distance_mm,
          .focal_x_px = setup.focal_px()};
}

Lights ring_light(const GearSetup& setup, const RigidTransform& scene_from_camera) {
  RingSettings ring;
  ring.placement.mount = LightPlacement::Mount::kCamera;
  ring.placement.position_mm = {0.0, 0.0, setup.ring_ahead_mm};
  ring.emission.radiance = {setup.radiance};
  ring.inner_radius_mm = setup.ring_inner_mm;
  ring.outer_radius_mm = setup.ring_outer_mm;
  return build_lights({{.name = "ring", .settings = ring}},
                      {.scene_from_camera = scene_from_camera},
                      [](const std::filesystem::path&) { return std::vector<LightTriangle>(); });
}

}  // namespace

double GearSetup::focal_px() const {
  return 1.0 / (1.0 / lens_mm - 1.0 / distance_mm) / pixel_mm;
}

TriangleMesh make_gear_mesh() {
  GridBuilder grid;
  const auto on_face = [](double z_mm) {
    return [z_mm](int row, int step) -> std::array<double, 2> {
      return {kBore_mm + (outer_radius_mm(step) - kBore_mm) * row / kRings, z_mm};
    };
  };
  const auto layer_mm = [](int row) { return kThickness_mm * (1.0 * row / kLayers - 0.5); };
  grid.add(kRings, false, on_face(0.5 * kThickness_mm));
  grid.add(kRings, true, on_face(-0.5 * kThickness_mm));
  grid.add(kLayers, true, [&](int row, int step) -> std::array<double, 2> {
    return {outer_radius_mm(step), layer_mm(row)};
  });
  grid.add(kLayers, false, [&](int row, int) -> std::array<double, 2> {
    return {kBore_mm, layer_mm(row)};
  });
  TriangleMesh mesh = grid.finish();
  GLINT_CHECK(mesh.num_triangles() == kTriangles, "no triangle has lost its area");
  GLINT_CHECK(2 * mesh.vertices_mm.size() == kTriangles, "a closed surface with one hole");
  return mesh;
}

GearScene::GearScene(const GearSetup& of_setup)
    : setup(of_setup),
      part(gear_part(setup.tilt_rad)),
      bvh(part.mesh),
      material(brushed(setup), kWavelengths_nm),
      camera(intrinsics_of(camera_settings(setup))),
      camera_from_world(glint::camera_from_world(default_viewpoint(camera_settings(setup)))),
      lights(ring_light(setup, inverse(camera_from_world))) {}

PhysicalScene GearScene::scene() const {
  return {.part = part,
          .bvh = bvh,
          .detail = detail,
          .material = material,
          .lights = lights,
          .camera = camera,
          .camera_from_world = camera_from_world};
}

PathSettings GearScene::paths(int samples, int seed) const {
  return {.samples = samples, .max_reflections = 1 + setup.bounces, .channels = 3, .seed = seed};
}

}  // namespace glint::bench

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every kernel against the functions in double it stands for, lane by lane.
#include <gtest/gtest.h>

#include "simulator/render/path_tracing/path_settings.h"
#include "tests/simulator/render/path_tracing/packet_bench.h"

namespace glint::path_test {
namespace {

using Eigen::Vector3d;

PartSettings faceted_gear() {
  return {.shape = PartSettings::Shape::kSpurGear,
          .facets_mm = 0.02,
          .position_mm = {1.0, -2.0, 3.0},
          .rotation_rad = {1.2, 0.4, 0.3}};
}

std::vector<NamedLight> three_rings() {
  NamedLight low = ring_at(90.0, "low");
  std::get<RingSettings>(low.settings).emission.radiance = {2.0};
  NamedLight high = ring_at(140.0, "high");
  auto& aside = std::get<RingSettings>(high.settings);
  aside.placement.direction = {0.2, -0.3, -1.0};
  NamedLight part = ring_at(120.0, "sectors");
  std::get<RingSettings>(part.settings).segments = {.segments = 3, .separate = true};
  std::get<RingSettings>(part.settings).outer_radius_mm = 60.0;
  return {low, high, part};
}

PathBench gear_bench(const MaterialSettings& material, const std::vector<NamedLight>& lights) {
  CameraSettings camera = small_camera(1.0, 72, 72);
  return {faceted_gear(), material, lights, camera};
}

/// Rays from above onto the part, as a tracer would have them.
PathPacket camera_packet(const PathBench& bench, Rng& rng) {
  PathPacket paths = {};
  for (std::size_t i = 0; i < kLanes; ++i) {
    const Vector3d to(60.0 * rng.uniform() - 30.0, 60.0 * rng.uniform() - 30.0, 0.0);
    const Vector3d from(80.0 * rng.uniform() - 40.0, 80.0 * rng.uniform() - 40.0, 250.0);
    const Eigen::Vector3f d = (to - from).normalized().cast<float>();
    paths.ray.origin_x[i] = static_cast<float>(from.x());
    paths.ray.origin_y[i] = static_cast<float>(from.y());
    paths.ray.origin_z[i] = static_cast<float>(from.z());
    paths.ray.direction_x[i] = d.x();
    paths.ray.direction_y[i] = d.y();
    paths.ray.direction_z[i] = d.z();
    paths.ray.t_max[i] = 1e4F;
    paths.ray.valid[i] = -1;
    paths.density[i] = 1.0F;
  }
  bench.bvh.intersect16(paths.ray, paths.hit, Coherence::kIncoherent);
  return paths;
}

/// The largest difference of lanes that hit the part.
double difference(const VectorLanes& a, const VectorLanes& b, const HitPacket& hits) {
  float largest = 0.0F;
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (hits.triangle[i] >= 0) {
      largest = std::max({largest,
                          std::abs(a.x[i] - b.x[i]),
                          std::abs(a.y[i] - b.y[i]),
                          std::abs(a.z[i] - b.z[i])});
    }
  }
  return static_cast<double>(largest);
}

/// Distances between points, as seen along their rays: rounding moves points of slanted triangles
/// to and fro along the ray.
double seen_difference(const VectorLanes& a, const SurfaceLanes& surface, const PathPacket& paths) {
  double largest = 0.0;
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (paths.hit.triangle[i] < 0) {
      continue;
    }
    const Vector3d d(static_cast<double>(a.x[i] - surface.point.x[i]),
                     static_cast<double>(a.y[i] - surface.point.y[i]),
                     static_cast<double>(a.z[i] - surface.point.z[i]));
    const Vector3d side(static_cast<double>(surface.side.x[i]),
                        static_cast<double>(surface.side.y[i]),
                        static_cast<double>(surface.side.z[i]));
    const Vector3d ray(static_cast<double>(paths.ray.direction_x[i]),
                       static_cast<double>(paths.ray.direction_y[i]),
                       static_cast<double>(paths.ray.direction_z[i]));
    largest = std::max(largest, d.norm() * std::abs(side.dot(ray)));
    EXPECT_LT(std::abs(d.dot(side)), 1.5e-5);  // on the plane
  }
  return largest;
}

void expect_same_surface(const SurfaceLanes& a, const SurfaceLanes& b, const PathPacket& paths) {
  const HitPacket& hits = paths.hit;
  EXPECT_LT(seen_difference(a.point, b, paths), 1.2e-4);  // of rays of 250 mm, 4 to 8 roundings
  EXPECT_LT(difference(a.side, b.side, hits), 1e-6);
  EXPECT_LT(difference(a.tangent, b.tangent, hits), 1e-4);  // near the axis of a turned face
  EXPECT_LT(difference(a.bitangent, b.bitangent, hits), 1e-4);
  EXPECT_LT(difference(a.normal, b.normal, hits), 3e-6);
  EXPECT_LT(difference(a.viewer, b.viewer, hits), 1e-4);
  for (std::size_t i = 0; i < kLanes; ++i) {
    if (hits.triangle[i] >= 0) {
      EXPECT_NEAR(a.tilt[i], b.tilt[i], 3e-6F);
      EXPECT_EQ(a.defect[i], b.defect[i]);
    }
  }
}

TEST(PacketStages, TrianglesAreMetAsByTheScalarCode) {
  using Kind = LaySettings::Kind;
  for (const Kind kind : {Kind::kNone, Kind::kTurned, Kind::kBrushed, Kind::kMilled}) {
    MaterialSettings material = metal_of({0.1}, true, false);
    material.lay.kind = kind;
    material.lay.axis = {1.0, 0.1, 0.0};
    material.lay.direction = {0.3, 1.0, 0.2};
    const PathBench bench = gear_bench(material, {ring_at(100.0)});
    const PhysicalScene scene = bench.scene();
    const PathSettings settings;
    PathTask task(scene, settings);
    ASSERT_TRUE(task.intersects_by_kernel);
    PathTask scalar(scene, settings);
    scalar.intersects_by_kernel = false;
    Rng rng(3, Stream::kTest, 0);
    int hits = 0;
    for (int i = 0; i < kPackets / 4; ++i) {
      const PathPacket paths = camera_packet(bench, rng);
      SurfaceLanes found = {};
      SurfaceLanes expected = {};
      PacketStages(task).intersect(paths, found);
      PacketStages(scalar).intersect(paths, expected);
      expect_same_surface(found, expected, paths);
      hits += static_cast<int>(
          std::ranges::count_if(paths.hit.triangle, [](auto t) { return t >= 0; }));
    }
    EXPECT_GT(hits, 1000);
  }
}

/// What the lanes of a packet reflect of the same lights.
struct Reflected {
  ReflectionLanes towards = {};
  LeavingLanes leaving = {};
};

Reflected reflected_by(const PathTask& task, const PathPacket& paths, std::uint64_t index) {
  const PacketStages stages(task);
  Rng rng(6, Stream::kTest, index);
  const RandomLanes random = random_lanes(rng);
  SurfaceLanes surface = {};
  stages.intersect(paths, surface);
  LightLanes lights;
  stages.ask_lights(paths, surface, random, lights);
  Reflected result;
  stages.reflect(paths, surface, random, &lights, result.towards, result.leaving);
  for (std::size_t i = 0; i < kLanes; ++i) {
    for (std::size_t c = 0; c < 3 && !(lights.density[i] > 0.0F); ++c) {
      result.towards.value.c[c][i] = 0.0F;  // not asked for
    }
  }
  return result;
}

MaterialSettings patterned_metal() {
  MaterialSettings material = metal_of({0.3, 0.1}, true, false);
  material.pattern = {
      .kind = PatternSettings::Kind::kConcentric, .density = 0.4, .colour = 0.8, .scaled = true};
  return material;
}

TEST(PacketStages, APatternOfColourTintsMetalAsTheScalarCodeDoes) {
  const PathBench bench = gear_bench(patterned_metal(), {ring_at(100.0)});
  const PhysicalScene scene = bench.scene();
  const PathSettings settings;
  const PathTask task(scene, settings);
  ASSERT_TRUE(task.metal.has_value());
  PathTask scalar(scene, settings);
  scalar.metal.reset();
  Rng rng(8, Stream::kTest, 0);
  int lit = 0;
  for (std::uint64_t i = 0; i < kPackets; ++i) {
    PathPacket paths = camera_packet(bench, rng);
    for (std::size_t k = 0; k < kLanes; ++k) {
      paths.ray.valid[k] = paths.hit.triangle[k] >= 0 ? paths.ray.valid[k] : 0;
    }
    const Reflected found = reflected_by(task, paths, i);
    const Reflected expected = reflected_by(scalar, paths, i);
    for (std::size_t k = 0; k < kLanes; ++k) {
      if (paths.ray.valid[k] == 0) {
        continue;
      }
      const float value = expected.towards.value.c[1][k];
      EXPECT_NEAR(found.towards.value.c[1][k], value, 1e-4F * (1e-3F + value));
      lit += value > 0.0F ? 1 : 0;
      const float weight = expected.leaving.weight.c[1][k];
      if (weight > 0.0F && expected.leaving.to_light.z[k] > 1e-3F) {
        // Near the horizon float keeps three digits of it.
        EXPECT_NEAR(found.leaving.weight.c[1][k], weight, 2e-3F * weight);
      }
    }
  }
  EXPECT_GT(lit, 1000);
}

TEST(PacketStages, APatternOfRoughnessIsLeftToTheScalarCode) {
  MaterialSettings material = patterned_metal();
  material.pattern.roughness = 0.2;
  const PathBench bench = gear_bench(material, {ring_at(100.0)});
  const PhysicalScene scene = bench.scene();
  const PathSettings settings;
  EXPECT_FALSE(PathTask(scene, settings).metal.has_value());
}

/// A tilted ring, whole or in sectors.
NamedLight tilted_ring(double height_mm, double tilt_rad, int segments, const std::string& name) {
  NamedLight light = ring_at(height_mm, name);
  auto& ring = std::get<RingSettings>(light.settings);
  ring.outer_radius_mm = 60.0;
  ring.tilt_rad = tilt_rad;
  ring.segments = {.segments = segments, .separate = segments > 1};
  return light;
}

/// What is done in double, ray by ray.
struct Scalar {
  bool camera = false;
  bool metal = false;
  bool meeting = false;
};

/// A whole picture by a tracer of its own.
ImageF picture_by(const PathBench& bench, const Scalar& scalar) {
  const PhysicalScene scene = bench.scene();
  const PathSettings settings = {.samples = 16, .max_reflections = 4, .roulette_from = 2};
  PathTask task(scene, settings);
  if (scalar.camera) {
    task.camera_numbers.reset();
  }
  if (scalar.metal) {
    task.metal.reset();
    task.needs_choice = true;
  }
  task.intersects_by_kernel = !scalar.meeting;
  const PinholeIntrinsics& in = bench.camera.intrinsics();
  Film sums = empty_film(in.width_px, in.height_px, task.factors.size(), 3, task.ids);
  TileTracer tracer(task);
  for (const Tile& cell : tiles_of(in.width_px, in.height_px)) {
    tracer.trace(cell, 0, settings.samples, sums);
  }
  EXPECT_EQ(tracer.counts().dropped, 0);
  return total_image(sums, task.factors, 1);
}

/// The same paths but for rounding, which now and then decides an edge otherwise.
void expect_same_pictures(const PathBench& bench) {
  const ImageF expected = picture_by(bench, {.camera = true, .metal = true, .meeting = true});
  EXPECT_GT(mean_of(expected), 1e-3);
  const auto expect_same = [&](const Scalar& scalar, const char* what) {
    const ImageF found = picture_by(bench, scalar);
    EXPECT_NEAR(mean_of(found) / mean_of(expected), 1.0, 5e-3) << what;
    EXPECT_LT(rms_difference(found, expected), 0.1 * mean_of(expected)) << what;
  };
  expect_same({}, "all kernels");
  expect_same({.metal = true, .meeting = true}, "camera");
  expect_same({.camera = true, .meeting = true}, "metal");
  expect_same({.camera = true, .metal = true}, "meeting");
}

TEST(PacketStages, PicturesByKernelsAreThoseOfTheScalarCode) {
  expect_same_pictures(gear_bench(metal_of({0.3, 0.1}, true, false), {ring_at(120.0)}));
  PathBench bench = gear_bench(metal_of({0.3, 0.1}, true, true), three_rings());
  bench.lens = {.aperture_mm = 10.0, .focus_mm = 300.0};
  expect_same_pictures(bench);
  expect_same_pictures(
      gear_bench(metal_of({0.3, 0.1}, true, false), {tilted_ring(110.0, 0.4, 4, "cone")}));
  expect_same_pictures(gear_bench(patterned_metal(), {ring_at(120.0)}));
}

/// A plate and a cylinder of exact surfaces, with a dent, a scratch and a stain on them.
PathBench detailed_bench(PartSettings::Shape shape) {
  MaterialSettings material = metal_of({0.3, 0.1}, true, false);
  material.lay.kind = LaySettings::Kind::kBrushed;
  material.lay.direction = {0.3, 1.0, 0.2};  // along no face's normal
  CameraSettings camera = small_camera(0.5, 80, 64);
  PathBench bench(
      {.shape = shape, .length_mm = 40.0, .width_mm = 30.0, .rotation_rad = {0.2, 0.1, 0.0}},
      material,
      {tilted_ring(110.0, 0.4, 4, "cone")},
      camera);
  std::vector<HeightFeature> features = {
      {.id = 1, .height_mm = -0.06, .sigma_mm = 0.8},
      {.kind = HeightFeature::Kind::kScratch,
       .id = 2,
       .height_mm = -0.05,
       .length_mm = 8.0,
       .width_mm = 0.8},
      {.id = 3, .height_mm = 0.02, .sigma_mm = 1.0, .moves_position = true, .reflectance = 0.5}};
  const double at_mm[3][2] = {{-8.0, 3.0}, {2.0, -4.0}, {9.0, 4.0}};
  for (std::size_t i = 0; i < features.size(); ++i) {
    const auto place = place_on_surface(bench.part, bench.bvh, at_mm[i][0], at_mm[i][1], 0.5);
    EXPECT_TRUE(place.has_value());
    features[i].centre_mm = place->centre_mm;
    features[i].u_axis = place->u_axis;
    features[i].v_axis = place->v_axis;
    features[i].normal = place->normal;
  }
  bench.detail = SurfaceDetail(features);
  return bench;
}

TEST(PacketStages, ExactSurfacesWithDetailAreMetAsByTheScalarCode) {
  for (const auto shape : {PartSettings::Shape::kPlate, PartSettings::Shape::kCylinder}) {
    const PathBench bench = detailed_bench(shape);
    const PhysicalScene scene = bench.scene();
    const PathSettings settings;
    const PathTask task(scene, settings);
    PathTask scalar(scene, settings);
    scalar.intersects_by_kernel = false;
    Rng rng(4, Stream::kTest, 0);
    std::array<int, 4> met = {};
    for (int i = 0; i < kPackets; ++i) {
      const PathPacket paths = camera_packet(bench, rng);
      SurfaceLanes found = {};
      SurfaceLanes expected = {};
      PacketStages(task).intersect(paths, found);
      PacketStages(scalar).intersect(paths, expected);
      expect_same_surface(found, expected, paths);
      for (std::size_t k = 0; k < kLanes; ++k) {
        if (paths.hit.triangle[k] >= 0) {
          EXPECT_EQ(found.reflectance[k], expected.reflectance[k]);
          ++met[static_cast<std::size_t>(std::max(0, found.defect[k]))];
        }
      }
    }
    EXPECT_GT(met[0], 1000);
    EXPECT_GT(std::min({met[1], met[2], met[3]}), 10);
    expect_same_pictures(bench);
  }
}

}  // namespace
}  // namespace glint::path_test

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Direct light without noise against path tracing in random scenes: rings, cones, sectors, LEDs,
// bars, domes over flat and bent parts, at several widths of the metal. Prints the error of each.
// GLINT_SCENES=0,8 chooses scenes, GLINT_SAMPLES=512 the samples of each of the two path-traced
// pictures.
#include <cmath>
#include <cstdlib>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/cpu_clock.h"
#include "core/rng.h"
#include "core/units.h"
#include "tests/simulator/render/direct/picture_bench.h"

namespace glint::direct_test {
namespace {

constexpr int kScenes = 12;
constexpr double kMean = 0.01;
constexpr double kPercentile = 0.03;

RingSettings random_ring(Rng& rng) {
  RingSettings ring;
  ring.placement.position_mm = {rng.uniform(-20.0, 20.0), rng.uniform(-20.0, 20.0), 0.0};
  ring.placement.position_mm[2] = rng.uniform(50.0, 180.0);
  ring.inner_radius_mm = rng.uniform(10.0, 50.0);
  ring.outer_radius_mm = ring.inner_radius_mm + rng.uniform(10.0, 60.0);
  return ring;
}

/// Kinds: 0 ring, 1 cone, 2 LEDs with a lobe, 3 sectors, 4 bar, 5 dome.
NamedLight random_light(Rng& rng, int kind, double radiance) {
  if (kind == 4) {
    BarSettings bar;
    bar.placement.position_mm = {rng.uniform(-40.0, 40.0), 60.0, rng.uniform(60.0, 140.0)};
    bar.placement.direction = {0.0, -0.6, -1.0};
    bar.length_mm = rng.uniform(60.0, 200.0);
    bar.width_mm = rng.uniform(10.0, 40.0);
    bar.emission.radiance = {radiance};
    return {.name = "bar", .settings = bar};
  }
  if (kind == 5) {
    DomeSettings dome;
    dome.radius_mm = rng.uniform(80.0, 160.0);
    dome.rim_rad = rng.uniform(1.0, 1.5);
    dome.emission.radiance = {radiance};
    return {.name = "dome", .settings = dome};
  }
  RingSettings ring = random_ring(rng);
  ring.tilt_rad = kind == 1 ? rng.uniform(0.2, 0.8) : 0.0;
  ring.leds = kind == 2 ? 24 : 0;
  ring.emission.half_angle_rad = kind == 2 ? 0.5 : kPi / 3.0;
  ring.emission.radiance = {radiance};
  if (kind == 3) {
    ring.segments = {.segments = 4, .segment_power = {1.0, 0.2, 0.7, 0.0}, .separate = true};
  }
  return {.name = "ring", .settings = ring};
}

PartSettings random_part(Rng& rng, int index) {
  if (index % 2 == 0) {
    return path_test::flat_plate();
  }
  return {.shape = PartSettings::Shape::kStrip,
          .length_mm = 60.0,
          .width_mm = 30.0,
          .radius_along_mm = rng.uniform(200.0, 900.0),
          .radius_across_mm = rng.uniform(30.0, 150.0),
          .thickness_mm = 3.0};
}

/// @param radiance  of its light
PathBench random_bench(int index, const MaterialSettings& metal, double radiance) {
  Rng rng(47, Stream::kTest, static_cast<std::uint64_t>(index));
  const PartSettings part = random_part(rng, index);
  const NamedLight light = random_light(rng, index % 6, radiance);
  // Nearer than the lights, so that none of them hides the part from it.
  constexpr double kDistance_mm = 35.0;
  const double incidence_rad = rng.uniform(0.0, 55.0) * kRadPerDeg;
  return PathBench(
      build_part(part),
      metal,
      {light},
      {.width_px = 40, .height_px = 30, .object_pixel_mm = 1.0, .working_distance_mm = 300.0},
      view_from(incidence_rad, rng.uniform(0.0, 6.0), kDistance_mm));
}

int samples() {
  const char* wanted = std::getenv("GLINT_SAMPLES");
  return wanted != nullptr ? std::atoi(wanted) : 2048;
}

bool is_wanted(int index) {
  const char* wanted = std::getenv("GLINT_SCENES");
  return wanted == nullptr ||
         fmt::format(",{},", wanted).find(fmt::format(",{},", index)) != std::string::npos;
}

/// Its light made as bright as fills the scale: the 99th percentile of the picture is 1.
PathBench exposed_bench(int index, const MaterialSettings& metal) {
  const PathBench first = random_bench(index, metal, 1.0);
  const ImageF picture = direct_picture(first);
  const std::vector<double> values(picture.values().begin(), picture.values().end());
  const double brightest = percentile_of(values, 0.99);
  return random_bench(index, metal, 1.0 / std::max(brightest, 1e-3));
}

/// CPU seconds.
struct Times {
  double direct_s = 0.0;
  double paths_s = 0.0;
};

/// What paths of the same error would cost: noise falls with the root of the samples. Errors below
/// 0.001 are not told apart from none.
void print(int index,
           const std::string& name,
           const PictureError& error,
           const DirectCounts& counts,
           const Times& times) {
  const double least = std::max(error.rms, 1e-3);
  const double same_s = times.paths_s * error.noise * error.noise / (least * least);
  fmt::print("{:2} {:11} mean {:+.4f} +- {:.4f}, rms {:.4f}, 95 % {:.4f} (noise {:.4f}), ",
             index,
             name,
             error.mean,
             error.mean_noise,
             error.rms,
             error.percentile,
             error.noise);
  fmt::print("{:.1f} ms, {} points of {} rays, {:.0f} places each, paths {:.0f} times as much\n",
             1e3 * times.direct_s,
             counts.points,
             counts.rays,
             static_cast<double>(counts.places) / static_cast<double>(counts.points),
             same_s / times.direct_s);
}

void compare(int index, const std::string& name, const MaterialSettings& metal) {
  const PathBench bench = exposed_bench(index, metal);
  DirectCounts counts;
  const double start_s = process_cpu_s();
  const ImageF picture = direct_picture(bench, {}, &counts);
  const double end_s = process_cpu_s();
  const ImageF a = traced_picture(bench, samples(), 1);
  const ImageF b = traced_picture(bench, samples(), 1000);
  const Times times = {.direct_s = end_s - start_s, .paths_s = process_cpu_s() - end_s};
  const PictureError error = error_of(picture, a, b);
  print(index, name, error, counts, times);
  EXPECT_LT(std::abs(error.mean), kMean) << index;
  EXPECT_LT(error.percentile, kPercentile) << index;
}

TEST(DirectLight, IsThatOfPathTracingInRandomScenes) {
  for (const double alpha : {0.1, 0.2, 0.3, 0.5}) {
    for (int index = 0; index < kScenes; ++index) {
      if (is_wanted(index)) {
        compare(index, fmt::format("alpha {:g}", alpha), path_test::white_metal({alpha}));
      }
    }
  }
}

/// Brushed metal, and a coloured one by its reflectance at normal incidence.
TEST(DirectLight, OfBrushedMetalIsThatOfPathTracing) {
  MaterialSettings coloured = path_test::white_metal({0.3});
  coloured.schlick = true;
  coloured.reflectance = {0.5};
  for (int index = 0; index < kScenes; ++index) {
    if (is_wanted(index)) {
      compare(index, "0.1 x 0.3", path_test::white_metal({0.1, 0.3}));
      compare(index, "0.4 x 0.15", path_test::white_metal({0.4, 0.15}));
      compare(index, "0.3, R0 0.5", coloured);
    }
  }
}

}  // namespace
}  // namespace glint::direct_test

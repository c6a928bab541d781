// SPDX-License-Identifier: GPL-3.0-or-later
//
// Homogeneity where the tunnel's wall hides a part of the view: the closed forms against path
// tracing, over the width of the slot. Prints the worst difference of each tunnel.
// GLINT_TUNNELS=0,8 chooses tunnels, GLINT_SAMPLES=1024 the samples of path tracing.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/thread_pool.h"
#include "studies/evaluation/evaluation.h"

namespace glint {
namespace {

constexpr int kSlots = 41;
/// Of h, in points (percent).
constexpr double kBound_points = 0.05;
/// Path tracing knows the sign of a step beyond this.
constexpr double kClearStep_points = 0.15;

/// A mirror that fills the picture, so that nothing but the part and the wall is seen, under any
/// wall with a slot; no noise and no clipping.
SceneSettings random_scene(std::uint64_t index) {
  Rng rng(20, Stream::kTest, index);
  SceneSettings scene;
  scene.camera = {
      .width_px = 48, .height_px = 48, .object_pixel_mm = 1.0, .working_distance_mm = 600.0};
  scene.part = {.shape = PartSettings::Shape::kStrip,
                .length_mm = 80.0,
                .width_mm = 70.0,
                .radius_along_mm = rng.uniform(300.0, 600.0),
                .radius_across_mm = rng.uniform(60.0, 150.0)};
  const double turn_rad = rng.uniform(-0.2, 0.2);
  scene.viewpoint() = {.position_mm = {rng.uniform(-20.0, 20.0), rng.uniform(-5.0, 5.0), 600.0},
                       .up = {std::sin(turn_rad), std::cos(turn_rad), 0.0}};
  TunnelSettings& t = scene.tunnel;
  t.shape = static_cast<TunnelSettings::Shape>(index % 5);
  t.base_mm = -30.0;
  t.radius_mm = rng.uniform(120.0, 250.0);
  t.half_width_mm = rng.uniform(120.0, 250.0);
  t.height_mm = rng.uniform(120.0, 300.0);
  t.exponent = rng.uniform(1.5, 4.0);
  t.distance_mm = rng.uniform(100.0, 140.0);
  t.opening_rad = rng.uniform(1.0, 1.4);
  t.panel_height_mm = 400.0;  // a roof: the slot is cut into its ridge
  for (double& control : t.control_mm) {
    control = rng.uniform(140.0, 250.0);
  }
  t.length_mm = 1600.0;
  t.period_mm = rng.uniform(8.0, 30.0);
  t.duty = rng.uniform(0.3, 0.7);
  scene.scan.positions = 8 + static_cast<int>(rng.next_u32() % 9);
  scene.sensor.bits = 16;
  scene.sensor.blur_px = rng.uniform(0.0, 1.2);
  return scene;
}

/// @return h_rms in points
double score(SceneStore& store, const SceneSettings& scene) {
  const WantedScores wanted = {.fringes = false, .defects = false, .slot = false, .errors = false};
  return 100.0 * evaluate(store, scene, {}, wanted).scores.at("homogeneity.h_rms");
}

/// At which the camera just sees all of the region.
double passing_slot_mm(SceneStore& store, SceneSettings scene) {
  scene.tunnel.slot_mm = 10.0;
  return 10.0 - 2.0 * evaluate(store, scene).scores.at("view.slot_margin_mm");
}

int samples() {
  const char* wanted = std::getenv("GLINT_SAMPLES");
  return wanted != nullptr ? std::atoi(wanted) : 256;
}

bool is_wanted(std::uint64_t index) {
  const char* wanted = std::getenv("GLINT_TUNNELS");
  return wanted == nullptr ||
         fmt::format(",{},", wanted).find(fmt::format(",{},", index)) != std::string::npos;
}

struct SlotSweep {
  double worst_points = 0.0;
  double at_share = 0.0;             ///< slot / passing slot of it
  double largest_step_points = 0.0;  ///< by paths
  int clear_steps = 0;
  int wrong_signs = 0;
};

SlotSweep sweep(ThreadPool& pool, const SceneSettings& base) {
  SceneStore store(pool);
  SceneSettings scene = base;
  SceneSettings by_paths = base;
  by_paths.render.method = RenderSettings::Method::kPaths;
  by_paths.paths.samples = samples();
  by_paths.paths.batches = 1;
  const double passing_mm = passing_slot_mm(store, base);
  SlotSweep found;
  double last = 0.0;
  double last_by_paths = 0.0;
  for (int i = 0; i < kSlots; ++i) {
    scene.tunnel.slot_mm = passing_mm * (0.7 + 0.35 * i / (kSlots - 1));
    by_paths.tunnel.slot_mm = scene.tunnel.slot_mm;
    const double h = score(store, scene);
    const double expected = score(store, by_paths);
    if (std::abs(h - expected) > found.worst_points) {
      found.worst_points = std::abs(h - expected);
      found.at_share = scene.tunnel.slot_mm / passing_mm;
    }
    const double step = expected - last_by_paths;
    if (i > 0 && std::abs(step) > kClearStep_points) {
      ++found.clear_steps;
      found.wrong_signs += step * (h - last) > 0.0 ? 0 : 1;
    }
    found.largest_step_points = i > 0 ? std::max(found.largest_step_points, std::abs(step)) : 0.0;
    last = h;
    last_by_paths = expected;
  }
  return found;
}

TEST(HiddenEdges, GiveTheHomogeneityOfPathTracing) {
  ThreadPool pool(2);
  int clear_steps = 0;
  for (std::uint64_t index = 0; index < 10; ++index) {
    if (!is_wanted(index)) {
      continue;
    }
    const SceneSettings scene = random_scene(index);
    const SlotSweep found = sweep(pool, scene);
    const std::string name = fmt::format("{} {}", index, shape_name(scene.tunnel.shape));
    fmt::print(
        "{:16} worst {:.4f} points at {:.2f} of the slot, largest step {:.3f}, {} clear "
        "steps, {} wrong\n",
        name,
        found.worst_points,
        found.at_share,
        found.largest_step_points,
        found.clear_steps,
        found.wrong_signs);
    EXPECT_LE(found.worst_points, kBound_points) << name;
    EXPECT_EQ(found.wrong_signs, 0) << name;
    clear_steps += found.clear_steps;
  }
  if (std::getenv("GLINT_TUNNELS") == nullptr) {
    EXPECT_GT(clear_steps, 100);
  }
}

}  // namespace
}  // namespace glint

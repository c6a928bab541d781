// SPDX-License-Identifier: GPL-3.0-or-later
//
// Homogeneity by closed forms against the full integrated sequence: on the gallery's designs and on
// 200 random tunnels. Prints every gallery figure, the worst random cases and the fallback share.
#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/rng.h"
#include "core/thread_pool.h"
#include "core/units.h"
#include "metrics/aspect_image/noise_variance.h"
#include "simulator/render/scan/closed_scan.h"
#include "studies/definition/study.h"
#include "studies/imaging/scene_store.h"
#include "studies/imaging/traced_scene.h"

namespace glint {
namespace {

/// Largest difference of h in points (percent).
constexpr double kBound_points = 0.1;

struct FormComparison {
  std::string name;
  ScanForm form;
  Homogeneity closed;
  Homogeneity full;
  double frame_share = 0.0;  ///< of the region, rendered frame by frame

  double rms_points() const { return 100.0 * std::abs(closed.h_rms - full.h_rms); }

  double abs_points() const { return 100.0 * std::abs(closed.h_abs - full.h_abs); }

  double worst_points() const { return std::max(rms_points(), abs_points()); }
};

FormComparison compare_forms(const std::string& name,
                             const TracedScene& traced,
                             const SceneSettings& scene) {
  const CornerRays& rays = traced.corners;
  const Tunnel tunnel(scene.tunnel);
  const Sensor sensor(scene.sensor, rays.width_px, rays.height_px);
  const Footprints footprints(rays, tunnel, scene.scan, traced.camera_in_world_mm);
  const Mask none(rays.width_px, rays.height_px);
  const double reflectance = scene.render.reflectance;
  const ScanPlan plan = plan_scan(footprints, sensor, traced.region, none, reflectance);
  const ClosedScan closed = scan_closed(footprints, sensor, plan);
  const ScanResult full = scan_integrated(footprints, sensor);
  FormComparison found;
  found.name = name;
  found.form = plan.form;
  const int frames = scene.scan.positions;
  found.closed =
      homogeneity(closed.aspect, closed.clipped_frames, frames, traced.region, scene.metrics);
  if (!closed.deviation.empty()) {
    found.closed =
        with_noise_variance(found.closed, closed.aspect, closed.deviation, traced.region.mask);
  }
  found.full =
      homogeneity(full.aspect, full.sums.clipped_frames, frames, traced.region, scene.metrics);
  found.frame_share = static_cast<double>(plan.form.frame_pixels) /
                      static_cast<double>(count_inside(traced.region.mask));
  return found;
}

void print_comparison(const FormComparison& c) {
  fmt::print(
      "{:60} {:6} h_rms {:8.5f} off {:.4f}  h_abs {:8.5f} off {:.4f}  clipped {:.4f} off "
      "{:.4f}  frames {:5.1f} %\n",
      c.name,
      form_name(c.form.kind),
      c.full.h_rms,
      c.rms_points(),
      c.full.h_abs,
      c.abs_points(),
      c.full.clipped_share,
      std::abs(c.closed.clipped_share - c.full.clipped_share),
      100.0 * c.frame_share);
}

TEST(ClosedForms, ScoreEveryDesignOfTheGalleryAsTheFullSequence) {
  const std::filesystem::path gallery =
      std::filesystem::path(GLINT_SOURCE_DIR) / "studies" / "gallery";
  ThreadPool pool(2);
  int designs = 0;
  for (const auto& folder : std::filesystem::directory_iterator(gallery)) {
    if (!std::filesystem::exists(folder.path() / "study.toml")) {
      continue;  // a scene alone
    }
    const Study study = load_study(folder.path() / "study.toml", {});
    if (needs_paths(study.scene)) {
      continue;  // closed forms are those of level 0
    }
    SceneStore store(pool);
    std::vector<std::pair<std::string, Overrides>> all = {{"baseline", {}}};
    for (const Prototype& prototype : study.prototypes) {
      all.emplace_back(prototype.name, prototype.overrides);
    }
    for (const auto& [name, overrides] : all) {
      SceneSettings scene = scene_with(study, overrides);
      scene.render.method = RenderSettings::Method::kClosed;
      const FormComparison found =
          compare_forms(folder.path().filename().string() + " " + name, *store.trace(scene), scene);
      print_comparison(found);
      EXPECT_LE(found.worst_points(), kBound_points) << found.name;
      EXPECT_NEAR(found.closed.clipped_share, found.full.clipped_share, 1e-3) << found.name;
      ++designs;
    }
  }
  EXPECT_GE(designs, 4);
}

/// Parts that the random tunnels stand over; few, so that they are traced once.
std::vector<SceneSettings> random_parts() {
  SceneSettings base;
  base.render.method = RenderSettings::Method::kClosed;
  base.camera = {
      .width_px = 320, .height_px = 130, .object_pixel_mm = 0.2, .working_distance_mm = 400.0};
  base.part = {.shape = PartSettings::Shape::kStrip,
               .length_mm = 58.0,
               .width_mm = 22.0,
               .radius_along_mm = 400.0,
               .radius_across_mm = 40.0};
  std::vector<SceneSettings> all = {base, base, base, base};
  all[1].part.radius_along_mm = 100.0;
  all[1].part.radius_across_mm = 80.0;
  // Larger than the picture: its border is no rim of the part.
  all[2].part.length_mm = 90.0;
  all[2].part.width_mm = 60.0;
  all[2].part.radius_across_mm = 120.0;
  all[3].part = {.shape = PartSettings::Shape::kSphereCap, .radius_mm = 40.0, .height_mm = 4.0};
  return all;
}

/// Any tunnel, stripes and sensor; whole periods.
SceneSettings random_scene(const std::vector<SceneSettings>& parts, std::uint64_t index) {
  Rng rng(81, Stream::kTest, index);
  SceneSettings scene = parts[index % parts.size()];
  TunnelSettings& t = scene.tunnel;
  t.shape = static_cast<TunnelSettings::Shape>(index % 5);
  t.radius_mm = rng.uniform(60.0, 250.0);
  t.half_width_mm = rng.uniform(60.0, 250.0);
  t.height_mm = rng.uniform(60.0, 250.0);
  t.exponent = rng.uniform(1.5, 5.0);
  t.distance_mm = rng.uniform(40.0, 120.0);
  t.opening_rad = rng.uniform(0.0, 1.6);
  t.panel_height_mm = rng.uniform(80.0, 300.0);
  for (double& control : t.control_mm) {
    control = rng.uniform(70.0, 250.0);
  }
  t.length_mm = rng.uniform(400.0, 1600.0);
  t.slot_mm = rng.uniform() < 0.3 ? 0.0 : rng.uniform(10.0, 40.0);
  t.blocks_view = t.slot_mm > 0.0;
  t.period_mm = rng.uniform(4.0, 40.0);
  t.duty = rng.uniform(0.2, 0.8);
  t.orientation_rad = rng.uniform() < 0.3 ? rng.uniform(-1.0, 1.0) : 0.0;
  t.offset_mm = rng.uniform(0.0, 20.0);
  t.dark_reflectance = rng.uniform() < 0.3 ? rng.uniform(0.0, 0.6) : 0.0;
  scene.scan.positions = 6 + static_cast<int>(rng.uniform(0.0, 42.999));
  const int periods = 1 + static_cast<int>(rng.uniform(0.0, 2.999));
  if (periods > 1) {
    scene.scan.step_mm = periods * t.period_mm / std::cos(t.orientation_rad) / scene.scan.positions;
  }
  scene.sensor.gain = rng.uniform(1.0, 3.0);
  scene.sensor.blur_px = rng.uniform(0.5, 2.0);
  scene.sensor.bits = rng.uniform() < 0.5 ? 8 : 0;
  if (rng.uniform() < 0.5) {
    scene.sensor.full_well_e = 20000.0;
    scene.sensor.read_noise_e = 8.0;
  }
  scene.sensor.seed = static_cast<int>(index);
  return scene;
}

std::string describe(std::uint64_t index, const SceneSettings& s) {
  return fmt::format("{:3} {} {} p{:.1f} d{:.2f} N{} x{:.0f} g{:.2f} b{:.2f}",
                     index,
                     index % 4,
                     shape_name(s.tunnel.shape),
                     s.tunnel.period_mm,
                     s.tunnel.duty,
                     s.scan.positions,
                     s.scan.step_mm > 0.0
                         ? s.scan.step_mm * s.scan.positions * std::cos(s.tunnel.orientation_rad) /
                               s.tunnel.period_mm
                         : 1.0,
                     s.sensor.gain,
                     s.sensor.blur_px);
}

TEST(ClosedForms, ScoreTwoHundredRandomTunnelsAsTheFullSequence) {
  ThreadPool pool(2);
  SceneStore store(pool);
  const std::vector<SceneSettings> parts = random_parts();
  std::vector<std::shared_ptr<const TracedScene>> traced;
  for (const SceneSettings& part : parts) {
    traced.push_back(store.trace(part));
  }
  std::vector<FormComparison> all;
  for (std::uint64_t index = 0; all.size() < 200; ++index) {
    const SceneSettings scene = random_scene(parts, index);
    FormComparison found =
        compare_forms(describe(index, scene), *traced[index % parts.size()], scene);
    if (found.full.lit_share < 0.2) {
      continue;  // a part that hardly mirrors the light is no lighting
    }
    all.push_back(std::move(found));
  }
  std::ranges::sort(all, std::ranges::greater(), &FormComparison::worst_points);
  double frame_share = 0.0;
  int tables = 0;
  for (const FormComparison& found : all) {
    if (found.form.kind == ScanForm::Kind::kTable) {
      frame_share += found.frame_share;
      ++tables;
    }
    EXPECT_LE(found.worst_points(), kBound_points) << found.name;
  }
  fmt::print("{} by table, {:.1f} % of their pixels by frames; worst:\n",
             tables,
             100.0 * frame_share / std::max(1, tables));
  for (std::size_t i = 0; i < 12; ++i) {
    print_comparison(all[i]);
  }
  EXPECT_GE(tables, 150);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/footprint/footprints.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "simulator/render/footprint/footprint_frames.h"
#include "tests/simulator/render/footprint/footprint_fixtures.h"

namespace glint {
namespace {

using State = Footprints::State;

constexpr int kPositions = 6;

/// Strip with a dent, its corner rays, and 16 x 16 rays a pixel as the truth.
struct FootprintScene {
  test::FootprintBench bench{test::bench_strip(), test::bench_camera(), 0.3};
  RayCache fine = bench.sampled(16);
  RayCache coarse = bench.sampled(1);

  static const FootprintScene& get() {
    static const FootprintScene scene;
    return scene;
  }
};

struct FrameError {
  double plain = 0.0;  ///< RMS over all frames, of full scale
  double all = 0.0;
  double largest_plain = 0.0;
  double largest = 0.0;
  std::int64_t num_plain = 0;
  std::int64_t num_cells = 0;
};

/// Frames by one method against the samples of `truth`.
FrameError error_of(const Footprints& footprints,
                    const std::vector<ImageF>& frames,
                    const RayCache& truth,
                    const Tunnel& tunnel,
                    const Eigen::Vector3d& camera_mm) {
  const WallRays wall = intersect_wall(truth, tunnel, camera_mm);
  FrameError error;
  ImageF expected;
  double plain = 0.0;
  double all = 0.0;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    render_frame(truth, wall, tunnel.pattern(footprints.positions().shift_mm[k]), expected);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const double d = static_cast<double>(frames[k].values()[i] - expected.values()[i]);
      all += d * d;
      error.largest = std::max(error.largest, std::abs(d));
      if (footprints.state().values()[i] == State::kPlain) {
        plain += d * d;
        ++error.num_plain;
        error.largest_plain = std::max(error.largest_plain, std::abs(d));
      }
      error.num_cells += footprints.state().values()[i] == State::kCells ? 1 : 0;
    }
  }
  const auto frames_count = static_cast<std::int64_t>(frames.size());
  error.plain = std::sqrt(plain / static_cast<double>(std::max<std::int64_t>(1, error.num_plain)));
  error.all =
      std::sqrt(all / static_cast<double>(frames_count) / static_cast<double>(expected.size()));
  error.num_plain /= frames_count;
  error.num_cells /= frames_count;
  return error;
}

struct Compared {
  FrameError integrated;
  FrameError one_ray;  ///< one point sample a pixel
};

Compared compare(const std::string& name, const TunnelSettings& settings) {
  const FootprintScene& scene = FootprintScene::get();
  const Tunnel tunnel(settings);
  const Eigen::Vector3d& camera_mm = scene.bench.camera_mm;
  const Footprints footprints(scene.bench.rays, tunnel, {.positions = kPositions}, camera_mm);
  std::vector<ImageF> frames = test::integrated_frames(footprints);
  Compared result;
  result.integrated = error_of(footprints, frames, scene.fine, tunnel, camera_mm);
  const WallRays wall = intersect_wall(scene.coarse, tunnel, camera_mm);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    render_frame(scene.coarse, wall, tunnel.pattern(footprints.positions().shift_mm[k]), frames[k]);
  }
  result.one_ray = error_of(footprints, frames, scene.fine, tunnel, camera_mm);
  const FrameError& e = result.integrated;
  fmt::print(
      "{:22} plain {:5} px rmse {:.5f} max {:.4f} | cells {:5} px | all {:.5f} | 1 ray {:.4f}\n",
      name,
      e.num_plain,
      e.plain,
      e.largest_plain,
      e.num_cells,
      e.all,
      result.one_ray.all);
  return result;
}

struct LightCase {
  const char* name;
  TunnelSettings settings;
};

std::vector<LightCase> light_cases() {
  std::vector<LightCase> cases = {{"slot and dent", test::bench_tunnel()}};
  const auto add = [&](const char* name) -> TunnelSettings& {
    cases.push_back({name, test::bench_tunnel()});
    return cases.back().settings;
  };
  add("ends in the picture").length_mm = 90.0;
  add("hidden by the wall").slot_mm = 10.0;
  add("oblique stripes").orientation_rad = 0.6;
  TunnelSettings& uneven = add("ripple and falloff");
  uneven.led_ripple = 0.3;
  uneven.end_falloff = 0.4;
  add("cosine law").cosine_law = true;
  add("dark reflectance").dark_reflectance = 0.5;
  add("duty 0.2").duty = 0.2;
  TunnelSettings& flat = add("leaning panels");
  flat.shape = TunnelSettings::Shape::kFlat;
  flat.distance_mm = 60.0;
  flat.opening_rad = 0.6;
  flat.panel_height_mm = 90.0;
  flat.slot_mm = 0.0;
  TunnelSettings& free = add("free, no slot");
  free.shape = TunnelSettings::Shape::kFree;
  free.control_mm = {70.0, 90.0, 120.0, 110.0, 100.0};
  free.slot_mm = 0.0;
  free.blocks_view = false;
  TunnelSettings& super = add("superellipse");
  super.shape = TunnelSettings::Shape::kSuperellipse;
  super.half_width_mm = 80.0;
  super.height_mm = 110.0;
  return cases;
}

TEST(Footprints, FramesAgreeWithSixteenTimesSixteenRays) {
  for (const LightCase& light : light_cases()) {
    const Compared found = compare(light.name, light.settings);
    EXPECT_LE(found.integrated.plain, 0.002) << light.name;
    EXPECT_LE(found.integrated.all, 0.006) << light.name;
    EXPECT_GT(found.integrated.num_plain, 3000) << light.name;
    EXPECT_GT(found.integrated.num_cells, 100) << light.name;
    // Negative control: one point sample a pixel is far outside the same bounds.
    EXPECT_GT(found.one_ray.plain, 0.002) << light.name;
    EXPECT_GT(found.one_ray.all, 0.006) << light.name;
  }
}

// A pixel of 0.25 mm sees about 0.25 (1 + 2 * 100 / 400) = 0.38 mm of the wall: more than a period
// of 0.3 mm, so every pixel is summed from polygons. The samples themselves see each of its edges
// to half a row.
TEST(Footprints, MayBeWiderThanThePeriod) {
  TunnelSettings dense = test::bench_tunnel();
  dense.period_mm = 0.3;
  const Compared found = compare("period below 1 px", dense);
  EXPECT_GT(found.integrated.num_cells, 5000);
  EXPECT_EQ(found.integrated.num_plain, 0);
  EXPECT_LE(found.integrated.all, 0.006);
  EXPECT_GT(found.one_ray.all, 0.1);
}

// A cylinder of 20 mm sends the camera's rays over the slot and both lower rims of the wall. There
// the pixels' corners below the rim must have the phase of the wall's continuation.
TEST(Footprints, ObliqueStripesAreRightInEveryPixelAroundBothRims) {
  CameraSettings camera = test::bench_camera();
  camera.height_px = 140;
  const test::FootprintBench bench(
      {.shape = PartSettings::Shape::kCylinder, .length_mm = 70.0, .radius_mm = 20.0}, camera);
  const RayCache truth = bench.sampled(16);
  for (const double turn_deg : {30.0, -30.0, 55.0}) {
    TunnelSettings oblique = test::bench_tunnel();
    oblique.orientation_rad = turn_deg * kRadPerDeg;
    oblique.blocks_view = false;  // else the wall hides the cylinder's sides
    const Tunnel tunnel(oblique);
    const Footprints footprints(bench.rays, tunnel, {.positions = kPositions}, bench.camera_mm);
    const FrameError error =
        error_of(footprints, test::integrated_frames(footprints), truth, tunnel, bench.camera_mm);
    EXPECT_LE(error.largest, 0.02) << turn_deg << " degrees";
    EXPECT_GT(error.num_cells, 300) << "pixels on a boundary of the light";
  }
}

// Edges along the picture's columns (0 degrees) or rows (90) cross a whole row of samples at once:
// of 16 x 16 each edge is wrong by up to half a row, 1 / 32 = 0.031 of a pixel, of 64 x 64 by up to
// 0.008. Along the tunnel a pixel of 0.5 mm sees 0.60 to 0.62 mm, so the edge at 0.56 mm in frame 1
// lies at 14.9 to 14.5 sixteenths of it.
TEST(Footprints, StripesAlongRowsAndColumnsAreRightWhereSixteenRowsOfSamplesAreNot) {
  CameraSettings camera = test::bench_camera();
  camera.width_px = 4;
  camera.height_px = 70;
  camera.object_pixel_mm = 0.5;
  const test::FootprintBench bench(
      {.shape = PartSettings::Shape::kCylinder, .length_mm = 70.0, .radius_mm = 20.0},
      camera,
      0.0,
      {},
      0.0);
  const RayCache coarse = bench.sampled(16);
  const RayCache fine = bench.sampled(64);
  for (const double turn_deg : {0.0, 90.0}) {
    TunnelSettings level = test::bench_tunnel();
    level.orientation_rad = turn_deg * kRadPerDeg;
    level.period_mm = 24.0;
    level.offset_mm = 0.27;
    level.blocks_view = false;
    const Tunnel tunnel(level);
    const Footprints footprints(
        bench.rays, tunnel, {.positions = 8, .step_mm = 0.29}, bench.camera_mm);
    const std::vector<ImageF> frames = test::integrated_frames(footprints);
    EXPECT_LE(error_of(footprints, frames, fine, tunnel, bench.camera_mm).largest, 0.02)
        << turn_deg << " degrees";
    EXPECT_GT(error_of(footprints, frames, coarse, tunnel, bench.camera_mm).largest, 0.02)
        << "the samples themselves, " << turn_deg << " degrees";
  }
}

// Strip 18 mm wide, camera 300 mm above, wall at 100 mm: a slot of 18 * 2 / 3 = 12 mm shows all of
// it, one of 6 mm half.
TEST(Footprints, HideWhatTheWallHides) {
  const FootprintScene& scene = FootprintScene::get();
  TunnelSettings narrow = test::bench_tunnel();
  narrow.slot_mm = 6.0;
  const Tunnel wall(narrow);
  const Footprints half(scene.bench.rays, wall, {.positions = 2}, scene.bench.camera_mm);
  EXPECT_NEAR(half.hidden_share(), 0.5, 0.03);
  for (std::size_t i = 0; i < half.occluded().size(); ++i) {
    if (half.occluded().values()[i] != 0) {
      ASSERT_EQ(half.state().values()[i], State::kDark);
    }
  }
  const Tunnel wide(test::bench_tunnel());
  EXPECT_EQ(
      Footprints(scene.bench.rays, wide, {.positions = 2}, scene.bench.camera_mm).hidden_share(),
      0.0);
}

// What is rendered on some pixels is what the whole picture has there; others are left alone.
TEST(Footprints, SomePixelsAreThoseOfTheWholePicture) {
  const FootprintScene& scene = FootprintScene::get();
  const Tunnel tunnel(test::bench_tunnel());
  const Footprints footprints(
      scene.bench.rays, tunnel, {.positions = kPositions}, scene.bench.camera_mm);
  const std::vector<ImageF> whole = test::integrated_frames(footprints);
  Mask mask(scene.bench.rays.width_px, scene.bench.rays.height_px);
  Rng rng(71, Stream::kTest, 0);
  for (auto& value : mask.values()) {
    value = rng.uniform() < 0.3 ? 1 : 0;
  }
  const Spans where = spans_of(mask);
  std::vector<ImageF> some(3, ImageF(mask.width(), mask.height(), -1.0F));
  FootprintFrames(footprints, where).render(2, some);
  for (std::size_t k = 0; k < some.size(); ++k) {
    for (std::size_t i = 0; i < mask.size(); ++i) {
      ASSERT_EQ(some[k].values()[i], mask.values()[i] != 0 ? whole[k + 2].values()[i] : -1.0F)
          << "frame " << k << ", pixel " << i;
    }
  }
}

/// The mean against the mean of all frames; radiance, every pixel.
double mean_radiance_error(double duty, int positions, double step_mm) {
  const FootprintScene& scene = FootprintScene::get();
  TunnelSettings settings = test::bench_tunnel();
  settings.duty = duty;
  settings.dark_reflectance = 0.3;
  const Tunnel tunnel(settings);
  const Footprints footprints(scene.bench.rays,
                              tunnel,
                              {.positions = positions, .step_mm = step_mm},
                              scene.bench.camera_mm);
  const std::vector<ImageF> frames = test::integrated_frames(footprints);
  const Spans all = whole_image(footprints.rays().width_px, footprints.rays().height_px);
  ImageF mean(footprints.rays().width_px, footprints.rays().height_px);
  FootprintFrames(footprints, all).render_mean(all, mean);
  double largest = 0.0;
  for (std::size_t i = 0; i < mean.size(); ++i) {
    double sum = 0.0;
    for (const ImageF& frame : frames) {
      sum += static_cast<double>(frame.values()[i]);
    }
    largest = std::max(largest, std::abs(sum / positions - static_cast<double>(mean.values()[i])));
  }
  return largest;
}

// 24 * 0.5 = 12 is whole, 24 * 0.37 = 8.88 is not; 20 steps of 1.8 mm are 3 periods of 12 mm.
// Floats of a phase of some 10 periods are good to 1e-6, and 24 edges move by that over footprints
// of 0.02.
TEST(Footprints, MeanRadianceIsTheMeanOfAllFrames) {
  EXPECT_LE(mean_radiance_error(0.5, 24, 0.0), 1e-5);
  EXPECT_LE(mean_radiance_error(0.37, 24, 0.0), 1e-5);
  EXPECT_LE(mean_radiance_error(0.43, 7, 0.0), 3e-5);
  EXPECT_LE(mean_radiance_error(0.37, 20, 1.8), 1e-5);
}

// Steps of 0.5 mm of a period of 12: 24 phases. 1.5 mm: 8. 48 positions of 0.5 mm are two periods.
// 23 positions leave one out; 0.7 mm never come back.
TEST(ScanPositions, KnowHowManyPhasesAScanHas) {
  const Tunnel tunnel({.period_mm = 12.0});
  const auto phases = [&](int positions, double step_mm) {
    return ScanPositions(tunnel, {.positions = positions, .step_mm = step_mm}).even_phases();
  };
  EXPECT_EQ(phases(24, 0.0), 24);
  EXPECT_EQ(phases(24, 0.5), 24);
  EXPECT_EQ(phases(24, 1.5), 8);
  EXPECT_EQ(phases(48, 0.5), 24);
  EXPECT_EQ(phases(23, 0.5), 0);
  EXPECT_EQ(phases(24, 0.7), 0);
  EXPECT_EQ(phases(24, 12.0), 1);
}

}  // namespace
}  // namespace glint

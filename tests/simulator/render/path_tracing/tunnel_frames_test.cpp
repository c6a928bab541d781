// SPDX-License-Identifier: GPL-3.0-or-later
//
// A mirror under a fringe tunnel by path tracing against level 0, the renderer of mirrors.
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "simulator/render/footprint/footprint_frames.h"
#include "simulator/render/path_tracing/path_settings.h"
#include "simulator/render/scan/closed_scan.h"
#include "simulator/render/scan/scan.h"
#include "tests/simulator/render/path_tracing/path_bench.h"

namespace glint::path_test {
namespace {

constexpr int kPositions = 6;

/// 46 x 18 mm, curved both ways; the slot is mirrored in it.
PartSettings curved_strip() {
  return {.shape = PartSettings::Shape::kStrip,
          .length_mm = 46.0,
          .width_mm = 18.0,
          .radius_along_mm = 400.0,
          .radius_across_mm = 40.0,
          .thickness_mm = 3.0};
}

CameraSettings strip_camera() {
  return {.width_px = 100, .height_px = 44, .object_pixel_mm = 0.5, .working_distance_mm = 300.0};
}

TunnelSettings strip_tunnel() {
  return {.shape = TunnelSettings::Shape::kSemicylinder,
          .radius_mm = 100.0,
          .length_mm = 600.0,
          .slot_mm = 16.0,
          .period_mm = 24.0};
}

TunnelLight tunnel_scan(const TunnelSettings& settings) {
  return {.name = "tunnel",
          .settings = settings,
          .positions = kPositions,
          .step_mm = scan_step_mm({.positions = kPositions}, settings)};
}

PathBench under_tunnel(const TunnelSettings& tunnel, const MaterialSettings& material) {
  PathBench bench(curved_strip(), material, {}, strip_camera());
  bench.lights = build_lights({}, {}, {}, tunnel_scan(tunnel));
  return bench;
}

std::vector<ImageF> traced_frames(const PathBench& bench,
                                  const TunnelSettings& tunnel,
                                  const PathSettings& settings) {
  const Film sums = bench.render(settings, 2);
  std::vector<ImageF> frames;
  for (const auto& factors : tunnel_frame_factors(tunnel_scan(tunnel))) {
    frames.push_back(total_image(sums, factors, 0));
  }
  return frames;
}

/// Level 0: each pixel's footprint integrated in closed form.
std::vector<ImageF> level0_frames(const PathBench& bench, const TunnelSettings& settings) {
  ThreadPool pool(1);
  const CornerRays rays =
      trace_corner_rays(bench.part, bench.bvh, bench.detail, bench.camera, bench.pose, {}, pool);
  const Tunnel tunnel(settings);
  const Footprints footprints(
      rays, tunnel, {.positions = kPositions}, inverse(bench.pose).translation_mm);
  const Spans all = whole_image(rays.width_px, rays.height_px);
  std::vector<ImageF> frames(kPositions, ImageF(rays.width_px, rays.height_px));
  FootprintFrames(footprints, all).render(0, frames);
  return frames;
}

/// Pixels that see the part alone, and so do their neighbours.
Image<unsigned char> away_from_silhouettes(const PathBench& bench) {
  const ImageF sound = coverage_images(bench.render({.samples = 16, .has_light = false})).sound;
  Image<unsigned char> is_inner(sound.width(), sound.height());
  for (int y = 1; y + 1 < sound.height(); ++y) {
    for (int x = 1; x + 1 < sound.width(); ++x) {
      bool all = true;
      for (int i = 0; i < 9; ++i) {
        all = all && sound(x + i % 3 - 1, y + i / 3 - 1) == 1.0F;
      }
      is_inner(x, y) = all ? 1 : 0;
    }
  }
  return is_inner;
}

struct FrameDifference {
  double rms = 0.0;
  double mean = 0.0;      ///< largest of a frame's mean
  double contrast = 0.0;  ///< RMS of what is compared with about its mean
  int pixels = 0;
};

FrameDifference difference(const std::vector<ImageF>& a,
                           const std::vector<ImageF>& b,
                           const Image<unsigned char>& where) {
  FrameDifference d;
  double sum = 0.0;
  double squares = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    double of_frame = 0.0;
    d.pixels = 0;
    for (std::size_t i = 0; i < where.size(); ++i) {
      if (where.values()[i] == 0) {
        continue;
      }
      ++d.pixels;
      const auto value = static_cast<double>(b[k].values()[i]);
      const double off = static_cast<double>(a[k].values()[i]) - value;
      of_frame += off;
      d.rms += off * off;
      sum += value;
      squares += value * value;
    }
    d.mean = std::max(d.mean, std::abs(of_frame / d.pixels));
  }
  const double count = static_cast<double>(a.size()) * d.pixels;
  d.rms = std::sqrt(d.rms / count);
  d.contrast = std::sqrt(squares / count - sum * sum / (count * count));
  return d;
}

FrameDifference against_level0(const char* name,
                               const TunnelSettings& tunnel,
                               const MaterialSettings& material,
                               int samples) {
  const PathBench bench = under_tunnel(tunnel, material);
  FrameDifference d = difference(traced_frames(bench, tunnel, {.samples = samples, .channels = 1}),
                                 level0_frames(bench, tunnel),
                                 away_from_silhouettes(bench));
  fmt::print("{:28} rmse {:.4f} mean {:.5f} of contrast {:.3f}, {} px\n",
             name,
             d.rms,
             d.mean,
             d.contrast,
             d.pixels);
  return d;
}

TEST(MirrorUnderATunnel, ShowsTheFramesOfLevel0) {
  TunnelSettings oblique = strip_tunnel();
  oblique.orientation_rad = 0.5;
  oblique.duty = 0.3;
  TunnelSettings grey = strip_tunnel();
  grey.shape = TunnelSettings::Shape::kSuperellipse;
  grey.dark_reflectance = 0.5;
  grey.cosine_law = true;
  TunnelSettings shining = strip_tunnel();  // dark stripes that are brighter at the rims
  shining.dark_reflectance = 0.8;
  TunnelSettings flat = strip_tunnel();
  flat.shape = TunnelSettings::Shape::kFlat;
  flat.opening_rad = 1.0;
  TunnelSettings free = strip_tunnel();
  free.shape = TunnelSettings::Shape::kFree;
  free.control_mm = {70.0, 90.0, 120.0, 110.0, 100.0};
  free.blocks_view = false;
  TunnelSettings narrow = strip_tunnel();  // hides a fifth of the part
  narrow.slot_mm = 9.5;
  const std::vector<std::pair<const char*, TunnelSettings>> cases = {
      {"semicylinder", strip_tunnel()},
      {"hidden by the wall", narrow},
      {"oblique, duty 0.3", oblique},
      {"grey superellipse", grey},
      {"shining dark stripes", shining},
      {"leaning panels", flat},
      {"free", free}};
  for (const auto& [name, tunnel] : cases) {
    const FrameDifference d = against_level0(name, tunnel, white_mirror(), 64);
    EXPECT_GT(d.pixels, 2000) << name;
    EXPECT_GT(d.contrast, 0.2) << name;
    EXPECT_LT(d.rms, 0.01) << name;
    EXPECT_LT(d.mean, 0.002) << name;
  }
}

// A strip bent to 12 degrees to either side mirrors the wall up to 24 degrees and more from its
// top. The control has one value, the wall's mean, in all dark stripes.
TEST(MirrorUnderATunnel, ShowsDarkStripesAsBrightAsTheirPlaceIs) {
  TunnelSettings shining = strip_tunnel();
  shining.dark_reflectance = 0.8;
  const PathBench bench = under_tunnel(shining, white_mirror());
  const std::vector<ImageF> traced = traced_frames(bench, shining, {.samples = 64, .channels = 1});
  TunnelSettings black = strip_tunnel();
  TunnelSettings bright = strip_tunnel();
  bright.duty = 1.0;
  std::vector<ImageF> one_value = level0_frames(bench, black);
  const std::vector<ImageF> all_bright = level0_frames(bench, bright);
  const auto mean = static_cast<float>(Tunnel(shining).dark().mean());
  for (std::size_t k = 0; k < one_value.size(); ++k) {
    for (std::size_t i = 0; i < one_value[k].size(); ++i) {
      float& value = one_value[k].values()[i];
      value += mean * (all_bright[k].values()[i] - value);
    }
  }
  const Image<unsigned char> where = away_from_silhouettes(bench);
  const FrameDifference by_place = difference(traced, level0_frames(bench, shining), where);
  const FrameDifference control = difference(traced, one_value, where);
  fmt::print(
      "dark stripes by their place: mean {:.5f}; one value: {:.5f}\n", by_place.mean, control.mean);
  EXPECT_LT(by_place.mean, 0.001);
  EXPECT_GT(control.mean, 0.01);
}

/// A lobe of width alpha smears stripes by about 2 alpha of their distance from the part, 200 um at
/// alpha 0.001; a pixel covers 900 um of the wall. So the difference falls with alpha.
TEST(MetalUnderATunnel, ComesToLevel0AsItGetsSmooth) {
  double last = 1.0;
  for (const double alpha : {0.1, 0.01, 0.001, 1e-4}) {
    const FrameDifference d = against_level0(
        fmt::format("GGX {}", alpha).c_str(), strip_tunnel(), white_metal({alpha, alpha}), 64);
    EXPECT_LT(d.rms, 0.7 * last) << alpha;
    EXPECT_LT(d.rms, alpha < 5e-4 ? 0.008 : alpha < 5e-3 ? 0.03 : 1.0) << alpha;
    EXPECT_LT(d.mean, alpha < 5e-3 ? 0.002 : 1.0) << alpha;
    last = d.rms;
  }
}

/// Where a ray from (0, 0, 1) meets a semicylinder of radius 100 round the x axis: its y and z
/// solve (t dy)^2 + (1 + t dz)^2 = 100^2.
Eigen::Vector3d on_semicylinder(const Eigen::Vector3d& d) {
  const double a = d.y() * d.y() + d.z() * d.z();
  const double t = (-d.z() + std::sqrt(d.z() * d.z() + a * (1e4 - 1.0))) / a;
  return t * d + Eigen::Vector3d::UnitZ();
}

/// Frames of one point of a plate seen from straight above, as sums over directions.
std::vector<double> summed_frames(const Material& material, const TunnelLight& light) {
  constexpr int kRows = 600;
  const TunnelSettings& s = light.settings;
  const auto positions = static_cast<std::size_t>(light.positions);
  const double middle_mm = 0.5 * (light.positions - 1) * light.step_mm;
  std::vector<double> frames(positions, 0.0);
  for (int i = 0; i < kRows; ++i) {
    const double angle = 0.5 * kPi * (i + 0.5) / kRows;
    for (int j = 0; j < 2 * kRows; ++j) {
      const double phi = kPi * (j + 0.5) / kRows;
      const Eigen::Vector3d d(
          std::sin(angle) * std::cos(phi), std::sin(angle) * std::sin(phi), std::cos(angle));
      const Eigen::Vector3d at = on_semicylinder(d);
      if (std::abs(at.y()) < 0.5 * s.slot_mm || std::abs(at.x() - middle_mm) > 0.5 * s.length_mm) {
        continue;
      }
      const double arriving = evaluate(material, {0, 0, 1}, {d.x(), d.y(), d.z()}).value[0] *
                              std::sin(angle) * 0.5 * (kPi / kRows) * (kPi / kRows);
      for (std::size_t k = 0; k < positions; ++k) {
        const double v = (at.x() - static_cast<double>(k) * light.step_mm) / s.period_mm;
        frames[k] += v - std::floor(v) < s.duty ? arriving : 0.0;
      }
    }
  }
  return frames;
}

/// With and without directions drawn towards the wall.
TEST(MetalUnderATunnel, IsAsBrightAsTheSumOverAllDirectionsSays) {
  CameraSettings camera = small_camera(1e-3, 16, 16);
  for (const double alpha : {0.08, 0.3}) {
    const MaterialSettings metal = white_metal({alpha, alpha});
    TunnelSettings tunnel = strip_tunnel();
    tunnel.length_mm = 300.0;
    tunnel.duty = 0.3;
    TunnelLight light = tunnel_scan(tunnel);
    PathBench bench(flat_plate(), metal, {}, camera);
    const std::vector<double> expected = summed_frames(bench.material.plain(), light);
    for (const double drawn_below : {0.0, 2.0}) {
      light.drawn_below = drawn_below;
      bench.lights = build_lights({}, {}, {}, light);
      const Film sums = bench.render({.samples = 512, .channels = 1}, 2);
      const auto factors = tunnel_frame_factors(light);
      for (std::size_t k = 0; k < expected.size(); ++k) {
        EXPECT_GT(expected[k], 0.02);
        EXPECT_NEAR(mean_of(total_image(sums, factors[k], 0)), expected[k], 0.003)
            << alpha << " " << k;
      }
    }
  }
}

/// The pictures of all bins sum up to the wall without stripes, at every roughness.
TEST(MetalUnderATunnel, SeesTheMeanOfAWholeScanAsAnEvenWall) {
  TunnelSettings bright = strip_tunnel();
  bright.duty = 1.0;
  for (const double alpha : {0.05, 0.4}) {
    const PathSettings settings = {.samples = 64, .channels = 1};
    const ImageF mean = under_tunnel(strip_tunnel(), white_metal({alpha, alpha})).picture(settings);
    ImageF even = under_tunnel(bright, white_metal({alpha, alpha})).picture(settings);
    for (float& value : even.values()) {
      value *= 0.5F;  // the duty
    }
    EXPECT_GT(mean_of(even), 0.1);
    EXPECT_LT(rms_difference(mean, even), 1e-5);
  }
}

}  // namespace
}  // namespace glint::path_test

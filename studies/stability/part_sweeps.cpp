// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sweeps of part, defects, view, path tracing, of two designs and of the switches between methods.
#include "studies/stability/part_sweeps.h"

#include <cmath>
#include <set>
#include <string>

#include <fmt/format.h>

#include "core/units.h"

namespace glint::stability {
namespace {

const double kBuiltinPixel_mm = SweptScene().pixel_mm;

constexpr double kDentSlope = 12.13e-3;  ///< 40 um deep, 8 mm wide: h / (sigma sqrt(e))

constexpr double kBarFoot_mm = 21.5;  ///< the light's middle when its foot is on the plate

/// Depth of a dent in um with a steepest slope.
double height_um(double diameter_mm, double slope) {
  return slope * diameter_mm / 4.0 * std::sqrt(std::exp(1.0)) * 1e3;
}

/// A plate is what it is with however narrow triangles.
Sweep slivers() {
  Sweep sweep{.name = "slivers",
              .swept = "width of triangles of 95 mm, mm",
              .title = "a plate as a mesh with ever narrower triangles",
              .sets = quiet_wall()};
  sweep.sets.push_back({"part.shape", "plate"});
  sweep.sets.push_back({"defects", "{}"});
  for (const double width_mm : {1.0, 1e-2, 1e-4, 1e-6, 1e-9, 1e-12, 1e-14}) {
    sweep.values.push_back({.value = width_mm, .sets = {}, .sliver_mm = width_mm});
  }
  return sweep;
}

Sweep dent_over_pixel() {
  Sweep sweep{.name = "dent_over_pixel",
              .swept = "defects.dent.diameter_mm / camera.object_pixel_mm",
              .title = "dents of the same slope, down to below a pixel"};
  for (const double ratio : {13.3, 6.67, 4.0, 2.0, 1.0, 0.5, 0.1}) {
    const double diameter_mm = ratio * kBuiltinPixel_mm;
    sweep.values.push_back(
        {.value = ratio,
         .sets = {{"defects.dent.diameter_mm", number_text(diameter_mm)},
                  {"defects.dent.height_um", number_text(height_um(diameter_mm, kDentSlope))}}});
  }
  return sweep;
}

Sweep facet_over_dent() {
  Sweep sweep{.name = "facet_over_dent",
              .swept = "edge of part.facets_um / defects.dent.diameter_mm",
              .title = "triangles in place of the exact surface"};
  for (const double facets_mm : {0.0, 1e-4, 1e-3, 1e-2, 0.1, 0.5}) {
    // An arc of radius R within s of its chord is sqrt(8 R s) long; R = 40 mm.
    sweep.values.push_back({.value = std::sqrt(8.0 * 40.0 * facets_mm) / 8.0,
                            .sets = {{"part.facets_um", number_text(1e3 * facets_mm)}}});
  }
  return sweep;
}

/// One dent of 16 mm at the apex of a nearly flat strip.
Sweep dent_slope(const char* name, const char* realisation) {
  Sweep sweep{.name = name,
              .swept = "slope of a dent, degrees",
              .title = fmt::format("dents from flat to steep, realised as {}", realisation),
              .sets = {{"defects.dent.x_mm", "[0]"},
                       {"defects.dent.y_mm", "[0]"},
                       {"defects.dent.diameter_mm", "16"},
                       {"defects.dent.realisation", realisation},
                       {"part.radius_across_mm", "400"},
                       {"lighting.tunnel.slot_mm", "0"},
                       {"lighting.tunnel.blocks_view", "false"}}};
  for (const double slope_deg : {0.2, 1.0, 3.0, 10.0, 20.0, 30.0}) {
    const double height = height_um(16.0, std::tan(slope_deg * kRadPerDeg));
    sweep.values.push_back(
        {.value = slope_deg, .sets = {{"defects.dent.height_um", number_text(height)}}});
  }
  return sweep;
}

/// A plate, looked at along the tunnel.
Sweep view_angle() {
  Sweep sweep{.name = "view_angle",
              .swept = "angle between view and normal, degrees",
              .title = "views of a plate down to grazing ones",
              .sets = {{"part.shape", "plate"},
                       {"part.thickness_mm", "0.1"},
                       {"lighting.tunnel.slot_mm", "0"},
                       {"lighting.tunnel.blocks_view", "false"},
                       {"lighting.tunnel.length_mm", "100000"},
                       {"lighting.tunnel.period_mm", "160"}}};
  for (const double deg : {0.0, 30.0, 60.0, 75.0, 85.0, 88.0, 89.0}) {
    const double sine = std::sin(deg * kRadPerDeg);
    const double cosine = std::cos(deg * kRadPerDeg);
    sweep.values.push_back(
        {.value = deg,
         .sets = {{"viewpoint",
                   fmt::format("[{{ position_mm = [{}, 0, {}], direction = [{}, 0, {}] }}]",
                               -600.0 * sine,
                               600.0 * cosine,
                               sine,
                               -cosine)}}});
  }
  return sweep;
}

/// Part, camera, tunnel and dents of another size.
Sweep part_size() {
  Sweep sweep{.name = "part_size",
              .swept = "part.length_mm",
              .title = "the whole scene, from 0.1 mm to 2 m"};
  for (const double length_mm : {190.0, 2000.0, 5000.0, 20.0, 2.0, 1.0, 0.1}) {
    const double scale = length_mm / 190.0;
    SweepValue value{.value = length_mm};
    const std::vector<std::pair<const char*, double>> sizes = {{"part.length_mm", 190},
                                                               {"part.width_mm", 44},
                                                               {"part.radius_along_mm", 400},
                                                               {"part.radius_across_mm", 40},
                                                               {"part.thickness_mm", 3},
                                                               {"camera.object_pixel_mm", 1.2},
                                                               {"camera.working_distance_mm", 600},
                                                               {"lighting.tunnel.radius_mm", 200},
                                                               {"lighting.tunnel.slot_mm", 32},
                                                               {"lighting.tunnel.length_mm", 1600},
                                                               {"lighting.tunnel.period_mm", 16},
                                                               {"defects.dent.height_um", 40},
                                                               {"defects.dent.diameter_mm", 8}};
    for (const auto& [key, size] : sizes) {
      value.sets.push_back({key, number_text(size * scale)});
    }
    value.sets.push_back(
        {"defects.dent.x_mm", fmt::format("[{}, {}]", -50.0 * scale, 40.0 * scale)});
    value.sets.push_back({"defects.dent.y_mm", fmt::format("[{}, {}]", -8.0 * scale, 9.0 * scale)});
    sweep.values.push_back(std::move(value));
  }
  return sweep;
}

Sweep coordinates() {
  Sweep sweep{
      .name = "coordinates",
      .swept = "part.position_mm",
      .title =
          "part and camera far from the origin, along the tunnel, under stripes that "
          "stand still",
      .sets = {
          {"lighting.tunnel.length_mm", "100000"}, {"scan.positions", "1"}, {"defects", "{}"}}};
  for (const double x_mm : {0.0, 10.0, 1e3, 1e4, 4e4, 1e5, 1e6}) {
    sweep.values.push_back(
        {.value = x_mm,
         .sets = {{"part.position_mm", fmt::format("[{}, 0, 0]", number_text(x_mm))},
                  {"viewpoint",
                   fmt::format("[{{ position_mm = [{}, 0, 600], direction = [0, 0, -1] }}]",
                               number_text(x_mm))}}});
  }
  return sweep;
}

Sweep by_paths(const char* name,
               const char* key,
               const char* title,
               std::vector<SweepValue> values) {
  return {.name = name,
          .swept = key,
          .title = title,
          .sets = {{"defects", "{}"}, {"render.paths.samples", "256"}, {"scan.positions", "8"}},
          .values = std::move(values)};
}

Sweep roughness() {
  Sweep sweep =
      by_paths("roughness",
               "material.roughness",
               "rough metal that becomes a mirror",
               key_values("material.roughness", {0.02, 0.01, 0.003, 0.001, 0.0}, "paths"));
  sweep.sets.push_back({"material.type", "conductor"});
  return sweep;
}

Sweep depth_of_field() {
  Sweep sweep = by_paths("depth_of_field",
                         "lens.f_number",
                         "a lens opened wide",
                         key_values("lens.f_number", {64, 16, 4, 1.4, 0.5, 0.1}, "paths"));
  sweep.sets.push_back({"lens.focus_mm", "600"});
  return sweep;
}

Sweep bar_over_plate() {
  return {.name = "light_touching",
          .swept = "lighting.bar.position_mm",
          .title = "an upright light beside a matt plate that comes down on it, mm",
          .kind = Sweep::Kind::kBar,
          .is_beside_bar = true,
          .values = [] {
            std::vector<SweepValue> values;
            for (const double mm : {150.0, 50.0, 10.0, 3.0, 1.0, 0.1, 0.01, 0.0}) {
              values.push_back({.value = mm,
                                .sets = {{"lighting.bar.position_mm",
                                          fmt::format("[0, 21, {}]", kBarFoot_mm + mm)}},
                                .method = "auto"});
            }
            return values;
          }()};
}

/// Two tunnels, the second with a slot that is a little wider; what is disturbed is told by sets.
Sweep winner(const char* name,
             const char* key,
             const char* title,
             const std::vector<double>& values,
             std::vector<KeyValue> sets) {
  return {.name = name,
          .swept = key,
          .title = title,
          .kind = Sweep::Kind::kWinner,
          .sets = std::move(sets),
          .values = key_values(key, values)};
}

Sweep switches() {
  Sweep sweep{.name = "switches",
              .swept = "render.method",
              .title = "the same scene by neighbouring methods: closed, integrated, sampled, paths",
              .kind = Sweep::Kind::kSwitch,
              .sets = {{"defects", "{}"}}};
  sweep.values = {{.value = 1, .sets = {}, .method = "closed"},
                  {.value = 2, .sets = {}, .method = "integrated"},
                  {.value = 3, .sets = {{"render.rays_per_axis", "16"}}, .method = "sampled"},
                  {.value = 4, .sets = {{"render.paths.samples", "256"}}, .method = "paths"}};
  return sweep;
}

/// Rough metal by a rung without noise, in one and four rays a pixel, and by paths.
Sweep rough_switches(const char* name,
                     const char* title,
                     const char* method,
                     const char* roughness) {
  Sweep sweep{.name = name,
              .swept = "render.method",
              .title = title,
              .kind = Sweep::Kind::kSwitch,
              .sets = {{"material.type", "conductor"}, {"material.roughness", roughness}}};
  sweep.values = {{.value = 1, .sets = {{"render.rays_per_axis", "1"}}, .method = method},
                  {.value = 2, .sets = {{"render.rays_per_axis", "2"}}, .method = method},
                  {.value = 3, .sets = {{"render.paths.samples", "256"}}, .method = "paths"}};
  return sweep;
}

Sweep blurred_switches() {
  Sweep sweep = rough_switches("switches_blurred",
                               "rough metal under the tunnel by blurred reflections, then by paths",
                               "blurred",
                               "0.22");
  sweep.sets.push_back({"defects", "{}"});
  return sweep;
}

Sweep direct_switches() {
  Sweep sweep = rough_switches("switches_direct",
                               "rough metal beside a bar by the sum of direct light, then by paths",
                               "direct",
                               "0.55");
  sweep.sets.push_back({"sensor.gain", "100"});
  sweep.is_beside_bar = true;
  return sweep;
}

/// Rough metal with two dents beside a bar, by paths.
Sweep path_switches(const char* name,
                    const char* key,
                    const char* title,
                    std::vector<SweepValue> values) {
  return {.name = name,
          .swept = key,
          .title = title,
          .kind = Sweep::Kind::kSwitch,
          .is_beside_bar = true,
          .sets = {{"material.type", "conductor"},
                   {"material.roughness", "0.55"},
                   {"sensor.gain", "100"},
                   {"defects.dent.x_mm", "[-15, 12]"},
                   {"defects.dent.y_mm", "[-6, 5]"},
                   {"defects.dent.diameter_mm", "10"},
                   {"defects.dent.height_um", "300"}},
          .values = std::move(values)};
}

/// Dents that see themselves, but hardly.
Sweep reflection_switches() {
  Sweep sweep = path_switches("switches_reflections",
                              "render.paths.max_reflections",
                              "dents with ever fewer reflections on the part",
                              key_values("render.paths.max_reflections", {8, 4, 2, 1}, "paths"));
  sweep.sets.push_back({"defects.dent.realisation", "displaced"});
  return sweep;
}

Sweep half_resolution_switches() {
  return path_switches("switches_half_resolution",
                       "resolution and samples",
                       "dents by paths: all pixels, half as many a side, these with more samples",
                       {{.value = 1, .sets = {}, .method = "paths"},
                        {.value = 2, .sets = {}, .method = "paths", .pixel_factor = 2},
                        {.value = 3,
                         .sets = {{"render.paths.samples", "1024"}},
                         .method = "paths",
                         .pixel_factor = 2}});
}

}  // namespace

std::vector<Sweep> part_sweeps() {
  std::vector<Sweep> sweeps = {
      dent_over_pixel(),
      facet_over_dent(),
      slivers(),
      dent_slope("dent_slope_normal", "normal"),
      dent_slope("dent_slope_auto", "auto"),
      view_angle(),
      part_size(),
      coordinates(),
      roughness(),
      depth_of_field(),
      by_paths("samples",
               "render.paths.samples",
               "paths of a pixel, down to one",
               key_values("render.paths.samples", {256, 64, 16, 4, 1}, "paths")),
      bar_over_plate(),
      winner("winner_seed",
             "sensor.seed",
             "the better of two designs with other noise",
             {1, 2, 3, 4, 5},
             {{"sensor.full_well_e", "20000"}, {"sensor.bits", "8"}}),
      winner("winner_blur",
             "sensor.blur_px",
             "the better of two designs with more blur",
             {1.0, 1.1, 1.2, 1.5},
             {}),
      winner("winner_facets",
             "part.facets_um",
             "the better of two designs on triangles",
             {0.0, 0.5, 0.6, 2},
             {}),
      switches(),
      blurred_switches(),
      direct_switches(),
      reflection_switches(),
      half_resolution_switches()};
  const std::set<std::string> of_any_size = {"roughness", "samples", "switches"};
  for (Sweep& sweep : sweeps) {
    sweep.has_own_sizes = !of_any_size.contains(sweep.name);
  }
  return sweeps;
}

}  // namespace glint::stability

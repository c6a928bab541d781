// SPDX-License-Identifier: GPL-3.0-or-later
//
// The gear under a ring light by Glint's path tracer and by Blender's Cycles: CPU time at equal
// relative error, each against a reference of its own (docs/benchmarks.md).
#include <algorithm>
#include <exception>
#include <iostream>
#include <iterator>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/image/image_io.h"
#include "simulator/render/path_tracing/path_settings.h"
#include "tests/bench/peers/gear_errors.h"
#include "tests/bench/peers/process.h"

namespace glint::peers {
namespace {

using nlohmann::json;

constexpr double kGoal = 0.5;
constexpr double kAim = 0.2;
constexpr int kReferenceSeed = 1000;  ///< shares no sample with the measured pictures
/// The comparison is made at the error that Cycles has here.
constexpr int kComparedSamples = 16;

struct Arguments {
  std::filesystem::path script;
  std::filesystem::path folder;
  int rounds = 3;
  int reference_samples = 1024;
};

/// Everything about one renderer.
struct Renderer {
  std::string name;
  GearRun run;
  ImageF reference;
  std::vector<GearPoint> points;
};

void progress(const std::string& what) {
  std::cerr << "bench: " << what << std::endl;
}

/// A reference that an earlier run has left for the same scene, or a new one.
template <class Render>
ImageF reference_of(const std::string& name,
                    const bench::GearScene& gear,
                    const Arguments& arguments,
                    const Render& render) {
  const std::string stem = fmt::format("gear_reference_{}_{}", name, arguments.reference_samples);
  const auto picture = arguments.folder / (stem + ".exr");
  const auto scene = arguments.folder / (stem + ".json");
  if (std::filesystem::exists(picture) && std::filesystem::exists(scene) &&
      read_file(scene) == description_of(gear)) {
    progress(fmt::format("reference of {}: {}", name, picture.string()));
    return read_image(picture);
  }
  progress(fmt::format("reference of {}, {} samples", name, arguments.reference_samples));
  const GearOrder order = {.samples = arguments.reference_samples, .seed = kReferenceSeed};
  ImageF reference = render(std::vector<GearOrder>{order}).pictures.front().luminance;
  write_exr(picture, reference);
  write_file(scene, description_of(gear));
  return reference;
}

/// What a round renders; the longest picture in the first one only.
std::vector<GearOrder> orders_of(int round) {
  std::vector<GearOrder> orders = {{.samples = 4, .seed = round + 1},
                                   {.samples = kComparedSamples, .seed = round + 1}};
  if (round == 0) {
    orders.push_back({.samples = 64, .seed = 1});
  }
  return orders;
}

void append(GearRun& to, const GearRun& more) {
  to.pictures.insert(to.pictures.end(), more.pictures.begin(), more.pictures.end());
  to.first_s = more.first_s;
  to.settings = more.settings;
}

Mask part_of(const bench::GearScene& gear) {
  ThreadPool pool(hardware_threads());
  PathSettings settings = gear.paths(kComparedSamples);
  settings.has_light = false;
  const Film sums = render_paths(gear.scene(), settings, pool);
  Mask mask(sums.width_px, sums.height_px);
  for (std::size_t i = 0; i < mask.size(); ++i) {
    mask.values()[i] = sums.part.values()[i] > 0 ? 1 : 0;
  }
  return mask;
}

json json_of(const Renderer& renderer) {
  json points = json::array();
  for (const GearPoint& point : renderer.points) {
    points.push_back({{"samples", point.samples},
                      {"pictures", point.pictures},
                      {"cpu_s", point.cpu_s},
                      {"relative_rmse", point.error.all},
                      {"relative_rmse_trimmed", point.error.trimmed}});
  }
  return {{"name", renderer.name},
          {"first_s", renderer.run.first_s},
          {"settings", renderer.run.settings},
          {"points", points},
          {"slope", slope_of(renderer.points)}};
}

/// Glint's time over Cycles' at the error of Cycles, in two ways.
struct Ratios {
  double by_root_law = 0.0;  ///< Glint's time at as many samples, times the errors' ratio squared
  double by_points = 0.0;    ///< along Glint's own points
};

const GearPoint& compared(const Renderer& renderer) {
  const auto at = std::ranges::find(renderer.points, kComparedSamples, &GearPoint::samples);
  return *at;
}

Ratios ratios_of(const Renderer& glint, const Renderer& cycles) {
  const GearPoint& ours = compared(glint);
  const GearPoint& theirs = compared(cycles);
  const double errors = ours.error.trimmed / theirs.error.trimmed;
  return {.by_root_law = ours.cpu_s / theirs.cpu_s * errors * errors,
          .by_points = seconds_at_error(glint.points, theirs.error.trimmed) / theirs.cpu_s};
}

std::string verdict(double ratio) {
  return ratio <= kAim ? "aim reached" : ratio <= kGoal ? "goal reached" : "goal missed";
}

void append_points(std::string& out, const Renderer& renderer) {
  for (const GearPoint& point : renderer.points) {
    fmt::format_to(std::back_inserter(out),
                   "{:>8} {:>9} {:>9.3f} {:>10.4f} {:>10.4f}  {}\n",
                   point.samples,
                   point.pictures,
                   point.cpu_s,
                   point.error.all,
                   point.error.trimmed,
                   renderer.name);
  }
}

void append_notes(std::string& out, const Renderer& renderer) {
  fmt::format_to(std::back_inserter(out),
                 "  {}: error falls as samples^{:.2f}; once, not in the times: {:.3f} s\n",
                 renderer.name,
                 slope_of(renderer.points),
                 renderer.run.first_s);
  for (const std::string& line : renderer.run.settings) {
    fmt::format_to(std::back_inserter(out), "  {}: {}\n", renderer.name, line);
  }
}

void report(const Renderer& glint,
            const Renderer& cycles,
            const Likeness& alike,
            const Arguments& arguments) {
  const Ratios ratios = ratios_of(glint, cycles);
  std::string out = "\nGear under a ring light, 168,960 triangles, 612 x 512 px, 3 bounces\n";
  const auto to = std::back_inserter(out);
  fmt::format_to(to,
                 "CPU time of Glint / Cycles at the error of Cycles at {} samples: {:.3f} by the "
                 "square of the errors, {:.3f} along Glint's points; goal {}, aim {}: {}\n\n",
                 kComparedSamples,
                 ratios.by_root_law,
                 ratios.by_points,
                 kGoal,
                 kAim,
                 verdict(ratios.by_root_law));
  fmt::format_to(to,
                 "{:>8} {:>9} {:>9} {:>10} {:>10}\n",
                 "samples",
                 "pictures",
                 "CPU s",
                 "rel RMSE",
                 "trimmed");
  append_points(out, glint);
  append_points(out, cycles);
  fmt::format_to(
      to,
      "\nReferences of {} samples: mean of Cycles / Glint {:.4f}; scaled to equal means they "
      "differ by {:.4f} (pixels), {:.4f} (means of 8 x 8 px)\n",
      arguments.reference_samples,
      alike.mean_ratio,
      alike.pixel_error,
      alike.block_error);
  append_notes(out, glint);
  append_notes(out, cycles);
  std::cout << out;
  const json all = {{"goal", kGoal},
                    {"aim", kAim},
                    {"compared_samples", kComparedSamples},
                    {"cpu_ratio_at_equal_error", ratios.by_root_law},
                    {"cpu_ratio_at_equal_error_along_points", ratios.by_points},
                    {"reference_samples", arguments.reference_samples},
                    {"reference_mean_ratio", alike.mean_ratio},
                    {"reference_pixel_difference", alike.pixel_error},
                    {"reference_block_difference", alike.block_error},
                    {"renderers", json::array({json_of(glint), json_of(cycles)})}};
  write_file(arguments.folder.parent_path() / "gear.json", all.dump(2) + "\n");
}

void run(const Arguments& arguments) {
  make_folder(arguments.folder);
  const bench::GearScene gear;
  const auto by_glint = [&](const std::vector<GearOrder>& orders, int threads) {
    return render_by_glint(gear, orders, threads);
  };
  const auto by_cycles = [&](const std::vector<GearOrder>& orders) {
    return render_by_cycles(gear, orders, arguments.script, arguments.folder, "gear_cycles");
  };
  Renderer glint = {.name = "Glint"};
  Renderer cycles = {.name = "Cycles"};
  for (int round = 0; round < arguments.rounds; ++round) {
    progress(fmt::format("gear, round {} of {}", round + 1, arguments.rounds));
    append(glint.run, by_glint(orders_of(round), 1));
    append(cycles.run, by_cycles(orders_of(round)));
  }
  glint.reference =
      reference_of("glint", gear, arguments, [&](const std::vector<GearOrder>& orders) {
        return by_glint(orders, hardware_threads());
      });
  cycles.reference = reference_of("cycles", gear, arguments, by_cycles);
  const Mask mask = part_of(gear);
  glint.points = points_of(glint.run.pictures, glint.reference, mask);
  cycles.points = points_of(cycles.run.pictures, cycles.reference, mask);
  report(glint, cycles, likeness(glint.reference, cycles.reference, mask), arguments);
}

int main_of(int argc, char** argv) {
  CLI::App app("Glint's path tracer against Blender's Cycles on a gear under a ring light");
  Arguments arguments;
  app.add_option("SCRIPT", arguments.script, "cycles_gear.py")->required();
  app.add_option("FOLDER", arguments.folder, "for pictures; gear.json beside it")->required();
  app.add_option("--rounds", arguments.rounds, "pictures of each kind")->check(CLI::Range(1, 100));
  app.add_option("--reference", arguments.reference_samples, "samples a pixel")
      ->check(CLI::Range(64, 65535));
  CLI11_PARSE(app, argc, argv);
  arguments.script = std::filesystem::absolute(arguments.script);
  arguments.folder = std::filesystem::absolute(arguments.folder);
  if (find_program("blender").empty()) {
    progress(
        "blender is not installed and the gear left out; on Debian: "
        "apt-get install --no-install-recommends blender");
    return 0;
  }
  run(arguments);
  return 0;
}

}  // namespace
}  // namespace glint::peers

int main(int argc, char** argv) {
  try {
    return glint::peers::main_of(argc, argv);
  } catch (const std::exception& error) {
    std::cerr << "bench: " << error.what() << "\n";
    return 1;
  }
}

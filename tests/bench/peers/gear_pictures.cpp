// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/peers/gear_pictures.h"

#include <array>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"
#include "tests/bench/peers/part_mesh.h"
#include "tests/bench/peers/process.h"
#include "tests/simulator/render/path_tracing/path_images.h"

namespace glint::peers {
namespace {

using nlohmann::json;

constexpr std::array<float, 3> kLuminance = {0.2126F, 0.7152F, 0.0722F};

ImageF luminance_of(const Film& sums, const std::vector<double>& factors) {
  ImageF luminance(sums.width_px, sums.height_px);
  for (int channel = 0; channel < 3; ++channel) {
    const ImageF one = total_image(sums, factors, channel);
    for (std::size_t i = 0; i < one.size(); ++i) {
      luminance.values()[i] += kLuminance[static_cast<std::size_t>(channel)] * one.values()[i];
    }
  }
  return luminance;
}

json scene_of(const bench::GearSetup& setup) {
  json colour = json::array();
  for (const double srgb : setup.colour_srgb) {
    colour.push_back(linear_from_srgb(srgb));
  }
  return {{"width_px", setup.width_px},
          {"height_px", setup.height_px},
          {"focal_px", setup.focal_px()},
          {"distance_mm", setup.distance_mm},
          {"ring_ahead_mm", setup.ring_ahead_mm},
          {"ring_inner_mm", setup.ring_inner_mm},
          {"ring_outer_mm", setup.ring_outer_mm},
          {"radiance", setup.radiance},
          {"tilt_rad", setup.tilt_rad},
          {"roughness", setup.roughness},
          {"anisotropy", setup.anisotropy},
          {"colour", colour},
          {"bounces", setup.bounces}};
}

}  // namespace

GearRun render_by_glint(const bench::GearScene& gear,
                        const std::vector<GearOrder>& orders,
                        int threads) {
  ThreadPool pool(threads);
  GearRun run;
  run.settings = {"1 thread; 3 channels; reference on all threads",
                  "gear: conductor, GGX, Schlick, turned about z; no light regained between "
                  "microfacets; flat shading; max_reflections " +
                      std::to_string(1 + gear.setup.bounces),
                  "ring: one annulus; box pixel filter"};
  const double start_s = cpu_seconds();
  const Bvh again(gear.part.mesh);
  run.first_s = cpu_seconds() - start_s;
  for (const GearOrder& order : orders) {
    const double picture_s = cpu_seconds();
    const Film sums = render_paths(gear.scene(), gear.paths(order.samples, order.seed), pool);
    const double cpu_s = cpu_seconds() - picture_s;
    run.pictures.push_back({.order = order,
                            .cpu_s = cpu_s,
                            .luminance = luminance_of(sums, group_factors(gear.lights))});
  }
  return run;
}

GearRun render_by_cycles(const bench::GearScene& gear,
                         const std::vector<GearOrder>& orders,
                         const std::filesystem::path& script,
                         const std::filesystem::path& folder,
                         const std::string& name) {
  const TriangleMesh mesh = bench::make_gear_mesh();
  write_raw_meshes(folder / "gear.raw", {&mesh, 1});
  json job = scene_of(gear.setup);
  job["mesh"] = (folder / "gear.raw").string();
  job["times"] = (folder / (name + "_times.json")).string();
  job["pictures"] = json::array();
  for (const GearOrder& order : orders) {
    const std::string file = fmt::format("{}_{}_{}.exr", name, order.samples, order.seed);
    job["pictures"].push_back(
        {{"samples", order.samples}, {"seed", order.seed}, {"file", (folder / file).string()}});
  }
  write_file(folder / (name + "_job.json"), job.dump(2) + "\n");
  run_blender(script, folder / (name + "_job.json"), folder, folder / (name + ".log"));
  const json times = json::parse(read_file(job["times"].get<std::string>()));
  GearRun run;
  run.first_s = times["first_s"].get<double>();
  run.settings = times["settings"].get<std::vector<std::string>>();
  for (std::size_t i = 0; i < orders.size(); ++i) {
    const std::filesystem::path file = job["pictures"][i]["file"].get<std::string>();
    run.pictures.push_back({.order = orders[i],
                            .cpu_s = times["pictures_s"][i].get<double>(),
                            .luminance = linear_values(read_picture(file).pixels)});
  }
  return run;
}

std::string description_of(const bench::GearScene& gear) {
  return scene_of(gear.setup).dump(2) + "\n";
}

}  // namespace glint::peers

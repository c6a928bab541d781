// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/peers/cycles.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/image/image_io.h"
#include "tests/bench/peers/process.h"

namespace glint::peers {
namespace {

using nlohmann::json;

/// What cycles.py needs to know.
json job_of(const SceneSettings& scene,
            const CyclesSettings& settings,
            const std::string& name,
            const std::filesystem::path& folder) {
  const TunnelSettings& tunnel = scene.tunnel;
  const PinholeIntrinsics camera = intrinsics_of(scene.camera);
  return {{"mesh", (folder / "part.raw").string()},
          {"image", (folder / (name + ".exr")).string()},
          {"times", (folder / (name + "_times.json")).string()},
          {"width_px", camera.width_px},
          {"height_px", camera.height_px},
          {"focal_px", camera.focal_px.x()},
          {"camera_mm", scene.viewpoint().position_mm},
          {"radius_mm", tunnel.radius_mm},
          {"length_mm", tunnel.length_mm},
          {"slot_mm", tunnel.slot_mm},
          {"period_mm", tunnel.period_mm},
          {"duty", tunnel.duty},
          {"step_mm", scan_step_mm(scene.scan, tunnel)},
          {"samples_per_pixel", settings.samples_per_pixel},
          {"is_packed", settings.is_packed},
          {"frames", 1 + settings.timed_frames}};
}

}  // namespace

Result measure_cycles(const SceneSettings& scene,
                      const CyclesSettings& settings,
                      const std::filesystem::path& script,
                      const std::filesystem::path& folder) {
  const std::string name =
      fmt::format("cycles_{}{}", settings.samples_per_pixel, settings.is_packed ? "_packed" : "");
  const json job = job_of(scene, settings, name, folder);
  const auto job_file = folder / (name + "_job.json");
  write_file(job_file, job.dump(2) + "\n");
  const double process_s = run_blender(script, job_file, folder, folder / (name + ".log"));
  const json times = json::parse(read_file(job["times"].get<std::string>()));
  auto later_s = times["frames_s"].get<std::vector<double>>();
  const double first_s = later_s.front();
  later_s.erase(later_s.begin());
  double sum_s = 0.0;
  for (const double frame_s : later_s) {
    sum_s += frame_s;
  }
  const int per_picture = settings.is_packed ? 3 : 1;
  const int pictures = (scene.scan.positions + per_picture - 1) / per_picture;
  const double picture_s = sum_s / static_cast<double>(later_s.size());
  Result result;
  result.tool = "Cycles";
  result.setting = fmt::format(
      "{} spp{}", settings.samples_per_pixel, settings.is_packed ? ", 3 positions in R, G, B" : "");
  result.frame_s = picture_s / per_picture;
  result.warm_s = picture_s * pictures;
  result.cold_s = process_s + picture_s * (pictures - 1 - settings.timed_frames);
  result.frame = read_image(job["image"].get<std::string>());
  result.samples_s = later_s;
  result.notes = fmt::format(
      "{} pictures measured after the first ({:.3g} s), extended to {}; cold: whole process "
      "({:.3g} s for {}), extended",
      later_s.size(),
      first_s,
      pictures,
      process_s,
      1 + settings.timed_frames);
  result.settings = times["settings"].get<std::vector<std::string>>();
  return result;
}

}  // namespace glint::peers

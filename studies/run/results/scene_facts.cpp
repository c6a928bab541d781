// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/run/results/scene_facts.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/image/image_io.h"
#include "core/text.h"
#include "simulator/render/preview/preview.h"
#include "studies/definition/scene_notes.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMaxRows = 24;  ///< of the table of defects; defects.json has all

/// At most so many significant digits, zeros at the end left out, never a power of ten.
std::string rounded(double value, int digits = 3) {
  const double size = std::max(1e-9, std::abs(value));
  const double unit = std::pow(10.0, std::floor(std::log10(size)) - digits + 1);
  const double number = unit >= 1.0 ? std::round(value) : std::round(value / unit) * unit;
  return fmt::format("{:.10g}", number == 0.0 ? 0.0 : number);
}

/// A text of the scene's file.
std::string text_at(const SceneSettings& scene, const char* path) {
  const ConfigNode root = write_scene(scene);
  const ConfigNode* const node = root.at_path(path);
  return node == nullptr ? std::string() : node->text;
}

/// "conductor of roughness 0.25", "mirror".
std::string surface_text(const SceneSettings& scene) {
  const bool is_rough = scene.material.type == MaterialSettings::Type::kConductor;
  return text_at(scene, "material.type") +
         (is_rough ? " of roughness " + rounded(scene.material.roughness) : std::string());
}

std::string part_text(const SceneSettings& scene, const Json& part) {
  if (!part.is_object()) {
    return text_at(scene, "part.shape");
  }
  std::vector<std::string> sizes;
  for (const Json& size_mm : part["size_mm"]) {
    sizes.push_back(rounded(size_mm.get<double>(), 4));
  }
  return fmt::format("{}, {} mm, {} triangles",
                     part["name"].get<std::string>(),
                     join(sizes, " x "),
                     part["triangles"].get<std::int64_t>());
}

std::string camera_text(const SceneSettings& scene) {
  const PinholeIntrinsics in = intrinsics_of(scene);
  const RigidTransform pose = inverse(camera_from_world(scene.viewpoint()));
  const double distance_mm = pose.translation_mm.norm();
  return fmt::format("{} x {} px of {} mm on the part, {} away, {}",
                     in.width_px,
                     in.height_px,
                     rounded(distance_mm / in.focal_px.x()),
                     length_text(distance_mm),
                     scene.sensor.bits == 0 ? std::string("not quantised")
                                            : fmt::format("{} bits", scene.sensor.bits));
}

std::string sensor_text(const SensorSettings& sensor) {
  std::string text = fmt::format("exposure {}, gain {}, blur {} px",
                                 rounded(sensor.exposure),
                                 rounded(sensor.gain),
                                 rounded(sensor.blur_px));
  return text +
         (sensor.full_well_e > 0.0
              ? fmt::format(", noise of a full well of {} electrons, read noise of {} electrons",
                            rounded(sensor.full_well_e),
                            rounded(sensor.read_noise_e))
              : std::string(", no noise"));
}

std::string place_text(const Json& defect) {
  std::vector<std::string> numbers;
  for (const Json& value : defect["centre_mm"]) {
    numbers.push_back(shortest(std::round(value.get<double>() * 100.0) / 100.0 + 0.0));
  }
  return join(numbers, ", ");
}

}  // namespace

Json part_json(const Part& part) {
  const Eigen::Vector3d size = part.box_in_part_mm.size_mm();
  return {{"name", part.name},
          {"size_mm", {size.x(), size.y(), size.z()}},
          {"triangles", part.mesh.num_triangles()}};
}

void write_part_picture(SceneStore& store,
                        const SceneSettings& scene,
                        const std::filesystem::path& file) {
  const std::shared_ptr<const BuiltDefects> part = store.build_defects(scene);
  const PreviewSubject subject = {.mesh = part->built->part.mesh,
                                  .bvh = *part->built->bvh,
                                  .labels = part->made.labels,
                                  .detail = part->detail};
  const PreviewView view = camera_view(scene.camera, scene.viewpoint());
  write_png(file, draw_preview(subject, view, store.pool()).image, PixelDepth::k8Bit);
}

Json scene_facts(const SceneSettings& scene, const Json& part, const std::string& study) {
  Json facts = Json::array();
  const auto add = [&](const char* name, const std::string& text) {
    facts.push_back({name, text});
  };
  add("Part", part_text(scene, part));
  add("Surface", surface_text(scene));
  add("Camera", camera_text(scene));
  add("Sensor", sensor_text(scene.sensor));
  for (const std::string& line : light_lines(scene)) {
    add("Light", line);
  }
  if (const std::string scan = scan_line(scene); !scan.empty()) {
    add("Scan", scan);
  }
  if (!study.empty()) {
    add("Study file", study);
  }
  return facts;
}

std::string study_file(const Study& study) {
  const std::string& file = study.root.place.file;
  return file.empty() ? study.name : std::filesystem::path(file).filename().string();
}

Json defect_table(const Json& defects) {
  Json rows = Json::array();
  for (const Json& defect : defects) {
    if (rows.size() < kMaxRows) {
      rows.push_back({defect["label"],
                      defect["kind"],
                      defect_size_text(defect),
                      rounded(defect["max_slope_mrad"].get<double>()) + " mrad",
                      place_text(defect)});
    }
  }
  Json table = {{"head", {"defect", "kind", "size", "steepest slope", "at x, y, z (mm)"}},
                {"rows", rows}};
  if (defects.size() > kMaxRows) {
    table["more"] =
        fmt::format("The first {} of {}; defects.json has all.", kMaxRows, defects.size());
  }
  return table;
}

std::string defect_size_text(const Json& defect) {
  std::string text;
  if (defect.contains("length_mm")) {
    text = fmt::format("{} mm long, {} mm wide",
                       rounded(defect["length_mm"].get<double>()),
                       rounded(defect["width_mm"].get<double>()));
  } else if (defect.contains("diameter_mm")) {
    text = fmt::format("{} mm wide", rounded(defect["diameter_mm"].get<double>()));
  }
  const double height_um = defect["height_um"].get<double>();
  if (height_um != 0.0) {
    text += fmt::format("{}{} \u00b5m {}",
                        text.empty() ? "" : ", ",
                        rounded(std::abs(height_um)),
                        height_um < 0.0 ? "deep" : "high");
  }
  return text;
}

Json marked_px(const Json& defect) {
  if (!defect.contains("place_px")) {
    return defect["window_px"];
  }
  const double size_mm = defect.value("length_mm", defect.value("diameter_mm", 0.0));
  const double side_px = 1.5 * size_mm / defect["pixel_mm"].get<double>();
  return {defect["place_px"][0].get<double>() - 0.5 * side_px,
          defect["place_px"][1].get<double>() - 0.5 * side_px,
          side_px,
          side_px};
}

}  // namespace glint

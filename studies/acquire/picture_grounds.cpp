// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/picture_grounds.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/config/config.h"
#include "core/file.h"
#include "core/text.h"
#include "studies/imaging/path_lights.h"

namespace glint {
namespace {

constexpr const char* kPart = "[part] ";
constexpr const char* kFeature = "[camera.features] ";

std::string value_in(const PictureGrounds& grounds, const std::string& name) {
  const auto found = grounds.find(name);
  return found == grounds.end() ? "not set" : found->second;
}

void add_camera(const CellCamera& camera, PictureGrounds& grounds) {
  const std::string table = "[camera] ";
  if (!camera.id.empty()) {
    grounds[table + "id"] = camera.id;
  }
  if (camera.gain_db) {
    grounds[table + "gain_db"] = fmt::format("{}", *camera.gain_db);
  }
  if (camera.gain_raw) {
    grounds[table + "gain_raw"] = fmt::format("{}", *camera.gain_raw);
  }
  grounds[table + "pixel_format"] = fmt::format("{}", static_cast<int>(camera.pixel_format));
  grounds[table + "region_px"] = fmt::format("[{}]", fmt::join(camera.region_px, ", "));
  for (const CellFeature& feature : camera.features) {
    grounds[kFeature + feature.name] = feature.value;
  }
}

/// Where the stripes stand at each position, or what a display shows there.
void add_stage(const CellStage& stage, const SceneSettings* scene, PictureGrounds& grounds) {
  const StageScan scan = scene != nullptr ? stage_scan(*scene) : StageScan{};
  const bool is_moved = scene != nullptr && stage.kind == CellStage::Kind::kGrbl;
  const ScanSteps steps = {.to_first_mm = is_moved ? stripe_offset_mm(*scene) : 0.0,
                           .to_next_mm = scan.step_mm};
  const StageWay way = stage_way_of(stage, scan.positions, steps);
  const std::string table = "[stage] ";
  grounds[table + "kind"] = name_of(stage.kind);
  if (stage.kind == CellStage::Kind::kGrbl) {
    grounds[table + "first_mm"] = fmt::format("{}", way.first_mm);
    if (way.positions > 1) {
      grounds[table + "step_mm"] = fmt::format("{}", way.step_mm);
    }
    return;
  }
  const auto shown = std::min(stage.pictures.size(), static_cast<std::size_t>(way.positions));
  for (std::size_t i = 0; i < shown; ++i) {
    grounds[fmt::format("{}pictures, number {}", table, i + 1)] =
        "SHA-256 " + sha256_hex(read_file(stage.pictures[i]));
  }
}

}  // namespace

PictureGrounds picture_grounds(const SceneSettings* scene, const Cell& cell) {
  PictureGrounds grounds;
  if (scene != nullptr) {
    const ConfigNode tables = write_scene(*scene);
    const ConfigNode* part = tables.find("part");
    for (std::size_t i = 0; part != nullptr && i < part->names.size(); ++i) {
      const bool is_mesh = part->names[i] == "file" && !scene->part.file.empty();
      grounds[kPart + part->names[i]] = is_mesh
                                            ? "SHA-256 " + sha256_hex(read_file(scene->part.file))
                                            : value_to_toml(part->items[i]);
    }
  }
  add_camera(camera_of(cell), grounds);
  if (cell.stage) {
    add_stage(*cell.stage, scene, grounds);
  }
  return grounds;
}

std::string ground_difference(const PictureGrounds& there, const PictureGrounds& now) {
  PictureGrounds all = there;
  all.insert(now.begin(), now.end());
  for (const auto& [name, value] : all) {
    const bool is_known = there.contains(name) && now.contains(name);
    if (!name.starts_with(kFeature) && !is_known) {
      continue;
    }
    if (value_in(there, name) != value_in(now, name)) {
      return fmt::format(
          "{} is {} there, and {} now", name, value_in(there, name), value_in(now, name));
    }
  }
  return {};
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate_cell/round_pictures.h"

#include <utility>

#include <fmt/format.h>

#include "core/file.h"
#include "studies/cell/pose_numbers.h"

namespace glint::calibrate_cell_detail {

using Json = nlohmann::ordered_json;

std::optional<Json> ended_round(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "acquired.json";
  if (!std::filesystem::exists(file)) {
    return std::nullopt;
  }
  Json ended = Json::parse(read_file(file), nullptr, false);
  const bool has_ended = ended.is_object() && ended.value("status", "stopped") != "stopped";
  return has_ended ? std::optional(std::move(ended)) : std::nullopt;
}

Json acquire_round(const AcquireOptions& options,
                   MountedPrototypes& prototypes,
                   const MotionPermit& permit) {
  std::optional<Json> ended = ended_round(options.out);
  return ended ? std::move(*ended) : acquire_pictures(options, prototypes, permit);
}

std::string pose_convention_toml() {
  return "[convention]\nunit = \"mm\"\nrotation = \"rotation_vector\"\nangle = \"rad\"\n"
         "direction = \"base_from_flange\"\n";
}

std::string pose_toml(const std::string& picture, const Eigen::Isometry3d& base_from_flange) {
  return fmt::format(
      "\n[[pose]]\nname = \"{}\"\npose = {}\n", picture, six_numbers(base_from_flange).dump());
}

}  // namespace glint::calibrate_cell_detail

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate_cell/placement_record.h"

#include <system_error>

#include <fmt/format.h>

#include "core/error.h"
#include "core/file.h"
#include "studies/acquire/acquired.h"
#include "studies/acquire/journal.h"
#include "studies/calibrate_cell/round_pictures.h"

namespace glint::calibrate_cell_detail {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

/// An empty object where there is no file, or it holds none.
Json object_in(const fs::path& file) {
  Json json = fs::exists(file) ? Json::parse(read_file(file), nullptr, false) : Json::object();
  return json.is_object() ? json : Json::object();
}

}  // namespace

fs::path PlacementRecord::numbered(const std::string& name,
                                   int number,
                                   const std::string& ending) const {
  return folder_ / fmt::format("{}_{}{}", name, number, ending);
}

fs::path PlacementRecord::file_of_found(int number) const {
  return numbered("found", number, ".json");
}

int PlacementRecord::last_put_down() const {
  return object_in(folder_ / "placed.json").value("placed", 0);
}

bool PlacementRecord::is_put_down(int number) const {
  const fs::path pictures = numbered("placement", number);
  if (ended_round(pictures)) {
    return true;
  }
  if (last_put_down() == number) {
    return fs::exists(pictures);  // put_down() makes it
  }
  if (recorded_sessions(pictures) > 0) {
    throw ConfigError(fmt::format(
        "{}: holds only some of the pictures of placement {}, and the part has been put down for "
        "placement {} since; remove this folder, and the same command takes them anew",
        pictures.string(),
        number,
        last_put_down()));
  }
  return false;
}

void PlacementRecord::put_down(int number) const {
  make_folder_durably(numbered("placement", number));
  write_file_durably(folder_ / "placed.json", Json{{"placed", number}}.dump() + "\n");
  std::error_code none;
  fs::remove(file_of_found(number), none);
  fs::remove(numbered("edges", number, ".csv"), none);
}

/// SHA-256 of the accepted pictures in their order.
Json PlacementRecord::digests(int number) const {
  Json digests = Json::array();
  for (const AcquiredPicture& picture : read_acquired(numbered("placement", number)).pictures) {
    if (picture.is_accepted) {
      digests.push_back(picture.sha256);
    }
  }
  return digests;
}

std::optional<Json> PlacementRecord::found(int number, const std::string& scene) const {
  const Json kept = object_in(file_of_found(number));
  const bool is_of_scene =
      kept.value("scene", "") == scene && kept.contains("told") && kept["told"].contains("settled");
  // Files of earlier programs do not tell of which pictures they are.
  if (!is_of_scene || kept.value("pictures", Json()) != digests(number)) {
    return std::nullopt;
  }
  return kept["told"];
}

void PlacementRecord::keep_found(int number, const std::string& scene, const Json& told) const {
  write_file(file_of_found(number),
             Json{{"scene", scene}, {"pictures", digests(number)}, {"told", told}}.dump() + "\n");
}

}  // namespace glint::calibrate_cell_detail

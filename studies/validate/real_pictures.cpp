// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/real_pictures.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/pose_keys.h"
#include "core/error.h"
#include "core/file.h"
#include "studies/compare/compare_sources.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::json;

bool is_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored);
}

/// @throws ConfigError that says what is wrong with the file
[[noreturn]] void refuse(const fs::path& file, const std::string& what) {
  throw ConfigError(fmt::format("{}: {}", file.string(), what));
}

Json parsed(const fs::path& file) {
  Json json = Json::parse(read_file(file), nullptr, false);
  if (!json.is_object() || json.value("kind", Json()) != "acquired") {
    refuse(file, "is no list of acquired pictures: needs \"kind\": \"acquired\"");
  }
  if (!json.contains("pictures") || !json["pictures"].is_array()) {
    refuse(file, "has no list \"pictures\"");
  }
  return json;
}

std::optional<RigidTransform> pose_in(const Json& picture) {
  const auto found = picture.find("base_from_flange");
  const auto is_number = [](const Json& item) { return item.is_number(); };
  if (found == picture.end() || !found->is_array() || found->size() != 6 ||
      !std::ranges::all_of(*found, is_number)) {
    return std::nullopt;
  }
  const auto numbers = found->get<std::vector<double>>();
  return transform_of(PoseSettings{.translation_mm = {numbers[0], numbers[1], numbers[2]},
                                   .rotation_vector_rad = {numbers[3], numbers[4], numbers[5]}});
}

double number_in(const Json& picture, const char* key) {
  const auto found = picture.find(key);
  return found != picture.end() && found->is_number() ? found->get<double>() : 0.0;
}

std::string text_in(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// The mean of the view's sequence, or its first accepted picture.
fs::path picture_of(const fs::path& folder, const Json& picture, const std::string& view) {
  const fs::path mean = folder / "views" / view / "aspect.png";
  return is_there(mean) ? mean : folder / text_in(picture, "file");
}

void read_pictures(const fs::path& file, const Json& json, RealDesign& design) {
  std::set<std::string> seen;
  std::size_t rejected = 0;
  for (const Json& picture : json["pictures"]) {
    const std::string view = picture.is_object() ? text_in(picture, "view") : std::string();
    if (view.empty() || text_in(picture, "file").empty()) {
      refuse(file, "has a picture without \"view\" or \"file\"");
    }
    if (picture.value("accepted", Json(true)) != true) {
      ++rejected;
      continue;
    }
    if (!seen.insert(view).second) {
      continue;
    }
    const fs::path at = picture_of(design.folder, picture, view);
    if (!is_there(at)) {
      throw IoError(
          fmt::format("{}: there is no such file, {} names it", at.string(), file.string()));
    }
    design.views.push_back({.name = view,
                            .picture = at,
                            .base_from_flange = pose_in(picture),
                            .position_sigma_mm = number_in(picture, "position_sigma_mm"),
                            .rotation_sigma_rad = number_in(picture, "rotation_sigma_rad")});
  }
  if (rejected > 0) {
    design.notes.push_back(
        fmt::format("{}: {} pictures were rejected when they were taken", design.name, rejected));
  }
}

RealDesign read_acquired(const std::string& name, const fs::path& folder) {
  const fs::path file = folder / "acquired.json";
  const Json json = parsed(file);
  RealDesign design = {.name = name, .folder = folder};
  const std::string calibration = text_in(json, "calibration");
  if (!calibration.empty()) {
    design.calibration = folder / calibration;
  }
  design.is_of_twin = json.value("twin", Json(false)) == true;
  read_pictures(file, json, design);
  if (design.views.empty()) {
    refuse(file, "has no accepted picture");
  }
  if (const std::string status = text_in(json, "status"); status != "complete") {
    design.notes.push_back(fmt::format("{}: its pictures are {}", name, status));
  }
  return design;
}

}  // namespace

RealDesign read_real_design(const std::string& name, const fs::path& folder) {
  if (is_there(folder / "acquired.json")) {
    return read_acquired(name, folder);
  }
  RealDesign design = {.name = name, .folder = folder};
  for (const CompareSource& source : compare_sources(folder)) {
    design.views.push_back({.name = source.name, .picture = source.picture});
  }
  return design;
}

}  // namespace glint

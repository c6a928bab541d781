// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/acquired.h"

#include <algorithm>
#include <cctype>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/file.h"
#include "core/units.h"
#include "studies/cell/pose_numbers.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

fs::path path_in(const fs::path& folder, const Json& json, const char* key) {
  const auto found = json.find(key);
  return found != json.end() && found->is_string() ? folder / found->get<std::string>()
                                                   : fs::path();
}

}  // namespace

std::vector<AcquiredPicture> Acquired::of_view(const std::string& view) const {
  std::vector<AcquiredPicture> found;
  std::ranges::copy_if(
      pictures, std::back_inserter(found), [&view](const AcquiredPicture& picture) {
        return picture.is_accepted && picture.view == view;
      });
  std::ranges::stable_sort(found, {}, &AcquiredPicture::position);
  return found;
}

std::vector<std::string> Acquired::views() const {
  std::vector<std::string> names;
  for (const AcquiredPicture& picture : pictures) {
    if (picture.is_accepted && std::ranges::find(names, picture.view) == names.end()) {
      names.push_back(picture.view);
    }
  }
  return names;
}

fs::path Acquired::aspect_of(const std::string& view) const {
  return folder / "views" / folder_name_of(view) / "aspect.png";
}

Json picture_json(const AcquiredPicture& picture) {
  return {{"view", picture.view},
          {"position", picture.position},
          {"lights", picture.lights},
          {"file", picture.file},
          {"accepted", picture.is_accepted},
          {"reason", picture.reason},
          {"base_from_flange", six_numbers(picture.base_from_flange)},
          {"joints_deg", joints_deg(picture.joints_rad)},
          {"position_sigma_mm", picture.position_sigma_mm},
          {"rotation_sigma_rad", picture.rotation_sigma_rad},
          {"exposure_us", picture.exposure_us},
          {"gain_db", picture.gain_db ? Json(*picture.gain_db) : Json(nullptr)},
          {"stage_mm", picture.stage_mm ? Json(*picture.stage_mm) : Json(nullptr)},
          {"frame_id", picture.frame_id},
          {"camera_time_ns", picture.camera_time_ns},
          {"host_time_s", picture.host_time_s},
          {"sharpness", picture.sharpness},
          {"sha256", picture.sha256}};
}

AcquiredPicture picture_of_json(const Json& json) {
  try {
    AcquiredPicture picture = {.view = json.at("view"),
                               .position = json.at("position"),
                               .lights = json.at("lights"),
                               .file = json.at("file"),
                               .is_accepted = json.at("accepted"),
                               .reason = json.at("reason"),
                               .base_from_flange = pose_of_numbers(json.at("base_from_flange")),
                               .joints_rad = joints_of_deg(json.at("joints_deg")),
                               .position_sigma_mm = json.at("position_sigma_mm"),
                               .rotation_sigma_rad = json.at("rotation_sigma_rad"),
                               .exposure_us = json.at("exposure_us"),
                               .frame_id = json.at("frame_id"),
                               .camera_time_ns = json.at("camera_time_ns"),
                               .host_time_s = json.at("host_time_s"),
                               .sharpness = json.value("sharpness", 0.0),
                               .sha256 = json.at("sha256")};
    if (!json.at("gain_db").is_null()) {
      picture.gain_db = json.at("gain_db").get<double>();
    }
    if (!json.at("stage_mm").is_null()) {
      picture.stage_mm = json.at("stage_mm").get<double>();
    }
    return picture;
  } catch (const Json::exception& error) {
    throw ConfigError(fmt::format("pictures: is no picture of glint acquire: {}", error.what()));
  }
}

Acquired read_acquired(const fs::path& folder) {
  const fs::path file = folder / "acquired.json";
  const Json json = Json::parse(read_file(file), nullptr, false);
  if (!json.is_object() || json.value("kind", "") != "acquired" || !json.contains("pictures") ||
      !json["pictures"].is_array()) {
    throw ConfigError(fmt::format("{}: is no acquired.json of glint acquire", file.string()));
  }
  Acquired acquired = {.folder = folder,
                       .status = json.value("status", ""),
                       .scene = path_in(folder, json, "scene"),
                       .cell = path_in(folder, json, "cell"),
                       .calibration = path_in(folder, json, "calibration"),
                       .is_twin = json.value("twin", false)};
  try {
    for (const Json& picture : json["pictures"]) {
      acquired.pictures.push_back(picture_of_json(picture));
    }
  } catch (const ConfigError& error) {
    throw ConfigError(fmt::format("{}: {}", file.string(), error.what()));
  }
  return acquired;
}

std::string folder_name_of(const std::string& view) {
  std::string name = view;
  std::ranges::transform(name, name.begin(), [](char c) {
    const bool is_plain =
        std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.';
    return is_plain ? c : '_';
  });
  return name.empty() || name.front() == '.' ? "_" + name : name;
}

}  // namespace glint

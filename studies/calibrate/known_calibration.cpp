// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate/known_calibration.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/key_writer.h"
#include "core/config/toml.h"
#include "core/error.h"
#include "core/file.h"
#include "core/units.h"
#include "hardware/calibration/rotation.h"
#include "studies/calibrate/settings_from_sets.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

Eigen::Vector3d vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Eigen::Isometry3d pose_of(const Json& json) {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = rotation_of(vector_of(json.at("rotation_vector_rad")));
  pose.translation() = vector_of(json.at("translation_mm"));
  return pose;
}

PinholeIntrinsics intrinsics_of(const Json& json) {
  PinholeIntrinsics intrinsics;
  intrinsics.width_px = json.at("width_px").get<int>();
  intrinsics.height_px = json.at("height_px").get<int>();
  for (const int i : {0, 1}) {
    const auto k = static_cast<std::size_t>(i);
    intrinsics.focal_px[i] = json.at("focal_px").at(k).get<double>();
    intrinsics.center_px[i] = json.at("center_px").at(k).get<double>();
    intrinsics.tangential[k] = json.at("tangential").at(k).get<double>();
  }
  for (std::size_t i = 0; i < 3; ++i) {
    intrinsics.radial[i] = json.at("radial").at(i).get<double>();
  }
  return intrinsics;
}

LensMask free_terms(const Json& names) {
  LensMask is_free = {};
  for (std::size_t i = 0; i < kLensSize; ++i) {
    is_free[i] = std::ranges::find(names, Json(std::string(kLensNames[i]))) != names.end();
  }
  return is_free;
}

/// The keys of a board's file alone: beside them stands what the calibration says of it.
Board board_of(const Json& json, const std::string& file) {
  Json keys = Json::object();
  for (const char* name :
       {"kind", "cols", "rows", "square_mm", "mark", "marker_mm", "dictionary"}) {
    if (json.contains(name)) {
      keys[name] = json[name];
    }
  }
  return parse_board_json(keys.dump(), file);
}

/// 0 x 0 where a number is not known.
Eigen::MatrixXd covariance_of(const Json& json) {
  const auto size = static_cast<Eigen::Index>(json.size());
  Eigen::MatrixXd covariance(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index k = 0; k < size; ++k) {
      const Json& value = json.at(static_cast<std::size_t>(i)).at(static_cast<std::size_t>(k));
      if (value.is_null()) {
        return {};
      }
      covariance(i, k) = value.get<double>();
    }
  }
  return covariance;
}

constexpr const char* kConvention = "convention";
constexpr const char* kOwnSolution = "glint";

ConfigNode convention_node(PoseConvention convention) {
  ConfigNode node = ConfigNode::table();
  KeyWriter writer(node);
  visit_keys(writer, convention);
  return node;
}

KnownCalibration calibration_of(const Json& json, const fs::path& file) {
  KnownCalibration known{.file = file,
                         .intrinsics = intrinsics_of(json.at("intrinsics")),
                         .is_free = free_terms(json.at("intrinsics").at("free")),
                         .board = board_of(json.at("board"), file.string()),
                         .rms_px = json.at("rms_px").get<double>()};
  known.given_board = known.board;
  known.given_board.square_mm = json["board"].value("given_square_mm", known.board.square_mm);
  known.given_board.mark = json["board"].value("given_mark", known.board.mark);
  if (json.at("prediction_rms_px").is_number()) {
    known.prediction_rms_px = json["prediction_rms_px"].get<double>();
  }
  known.covariance = covariance_of(json.at("covariance"));
  known.convention = convention_in(json);
  if (json.at("hand_eye").is_object()) {
    const bool is_in_hand = json["hand_eye"].at("to").get<std::string>() == "flange";
    known.mounting = is_in_hand ? Mounting::kEyeInHand : Mounting::kEyeToHand;
    known.poses = {.hand_eye = pose_of(json["hand_eye"]),
                   .board = pose_of(json.at("board").at("pose"))};
    const std::string solver = json["hand_eye"].value("method", kOwnSolution);
    known.closed_form = solver == kOwnSolution ? std::string() : solver;
    const Json& noise = json.at("noise");
    known.noise = {.corner_px = noise.at("corner_px").get<double>(),
                   .robot_rad = noise.at("robot_deg").get<double>() * kRadPerDeg,
                   .robot_mm = noise.at("robot_mm").get<double>(),
                   .pattern_px = noise.at("pattern_px").get<double>()};
  }
  return known;
}

}  // namespace

KnownCalibration read_calibration(const fs::path& path) {
  std::error_code ignored;
  const fs::path file = fs::is_directory(path, ignored) ? path / "calibration.json" : path;
  const Json json = Json::parse(read_file(file), nullptr, false);
  try {
    if (json.is_object()) {
      return calibration_of(json, file);
    }
  } catch (const Json::exception&) {
    // said below
  }
  throw ConfigError(fmt::format("{}: is no calibration.json of glint calibrate", file.string()));
}

Json convention_json(PoseConvention convention) {
  const ConfigNode node = convention_node(std::move(convention));
  Json json = Json::object();
  for (std::size_t i = 0; i < node.names.size(); ++i) {
    // Words and lists of numbers are written alike in TOML and JSON.
    json[node.names[i]] = Json::parse(value_to_toml(node.items[i]));
  }
  return json;
}

std::optional<PoseConvention> convention_in(const Json& calibration) {
  const auto found = calibration.find(kConvention);
  if (found == calibration.end() || !found->is_object()) {
    return std::nullopt;
  }
  std::vector<KeyValue> sets;
  for (const auto& [key, value] : found->items()) {
    sets.push_back({.path = fmt::format("{}.{}", kConvention, key), .value = value.dump()});
  }
  return settings_from_sets<PoseConvention>(sets, kConvention);
}

std::string sets_between(const PoseConvention& taken, const PoseConvention& other) {
  const ConfigNode before = convention_node(taken);
  const ConfigNode after = convention_node(other);
  std::string text;
  for (std::size_t i = 0; i < after.names.size(); ++i) {
    const ConfigNode* old = before.find(after.names[i]);
    if (old == nullptr || value_to_toml(*old) != value_to_toml(after.items[i])) {
      const ConfigNode& value = after.items[i];
      text +=
          fmt::format(" --set convention.{}={}",
                      after.names[i],
                      value.kind == ConfigNode::Kind::kText ? value.text : value_to_toml(value));
    }
  }
  return text;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/poses/camera_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "core/config/keys.h"
#include "core/config/located_yaml.h"
#include "core/config/toml.h"
#include "core/file.h"
#include "core/text.h"
#include "hardware/poses/located_xml.h"
#include "hardware/poses/pose_convention.h"
#include "simulator/camera/camera_settings.h"
#include "simulator/camera/lens_settings.h"

namespace glint {
namespace {

constexpr double kHalfPixel = 0.5;  ///< see opencv_from_pixel()

/// The first of several names that a table has.
const ConfigNode* find_any(const ConfigNode& table, std::span<const std::string_view> names) {
  for (const std::string_view name : names) {
    if (const ConfigNode* node = table.find(name)) {
      return node;
    }
  }
  return nullptr;
}

double number_of(const ConfigNode& node, std::string_view key) {
  if (!node.is_number() || !std::isfinite(node.number)) {
    refuse_key(node.place, key, "must be a finite number");
  }
  return node.number;
}

double required(const ConfigNode& table, std::string_view key) {
  const ConfigNode* node = table.find(key);
  if (node == nullptr) {
    refuse_key(table.place, key, "is missing");
  }
  return number_of(*node, key);
}

int size_of(const ConfigNode& table, std::span<const std::string_view> names) {
  const ConfigNode* node = find_any(table, names);
  if (node == nullptr) {
    return 0;
  }
  constexpr double kLargest = 1e6;
  const double value = number_of(*node, names.front());
  if (value != std::floor(value) || value < 1.0 || value > kLargest) {
    refuse_key(
        node->place, names.front(), fmt::format("is {}, must be a whole number of pixels", value));
  }
  return static_cast<int>(value);
}

void add_numbers(const ConfigNode& list, std::string_view key, std::vector<double>& numbers) {
  for (const ConfigNode& item : list.items) {
    if (item.is_array()) {
      for (const ConfigNode& inner : item.items) {
        numbers.push_back(number_of(inner, key));
      }
    } else {
      numbers.push_back(number_of(item, key));
    }
  }
}

/// Numbers of a matrix: a list, a list of rows, or rows, cols and data, which XML holds as a text.
std::vector<double> matrix_of(const ConfigNode& node, std::string_view key) {
  const ConfigNode* data = node.is_table() ? node.find("data") : &node;
  std::vector<double> numbers;
  if (data != nullptr && data->is_array()) {
    add_numbers(*data, key, numbers);
  } else if (data != nullptr && data->kind == ConfigNode::Kind::kText) {
    std::string words = data->text;
    std::ranges::replace_if(
        words, [](char c) { return c == '\n' || c == '\t' || c == '\r'; }, ' ');
    for (const std::string& word : split(words, ' ')) {
      if (word.empty()) {
        continue;
      }
      double value = 0.0;
      const auto [rest, error] = std::from_chars(word.data(), word.data() + word.size(), value);
      if (error != std::errc() || rest != word.data() + word.size() || !std::isfinite(value)) {
        refuse_key(data->place, key, fmt::format("'{}' is no finite number", word));
      }
      numbers.push_back(value);
    }
  } else {
    refuse_key(node.place, key, "must be a matrix: rows, cols and data");
  }
  return numbers;
}

void check_focal(const PinholeIntrinsics& intrinsics, const Place& place, std::string_view key) {
  if (!(intrinsics.focal_px.minCoeff() > 0.0)) {
    refuse_key(place,
               key,
               fmt::format("focal lengths are {} and {} px, must be > 0",
                           shortest(intrinsics.focal_px.x()),
                           shortest(intrinsics.focal_px.y())));
  }
}

void set_distortion(const ConfigNode& node, PinholeIntrinsics& intrinsics) {
  constexpr std::string_view kKey = "distortion_coefficients";
  const std::vector<double> d = matrix_of(node, kKey);
  for (std::size_t i = 5; i < d.size(); ++i) {
    if (d[i] != 0.0) {
      refuse_key(
          node.place,
          kKey,
          fmt::format(
              "number {} is {}, only k1 k2 p1 p2 k3 may differ from 0", i + 1, shortest(d[i])));
    }
  }
  const auto at = [&](std::size_t i) { return i < d.size() ? d[i] : 0.0; };
  intrinsics.radial = {at(0), at(1), at(4)};
  intrinsics.tangential = {at(2), at(3)};
}

/// The nine numbers of a camera matrix without skew, row by row.
std::vector<double> camera_matrix(const ConfigNode& matrix, std::string_view key) {
  std::vector<double> k = matrix_of(matrix, key);
  if (k.size() != 9) {
    refuse_key(matrix.place, key, fmt::format("has {} numbers, must have 9", k.size()));
  }
  if (k[1] != 0.0 || k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0) {
    refuse_key(matrix.place, key, "must be fx 0 cx, 0 fy cy, 0 0 1: skew is not known here");
  }
  return k;
}

PinholeIntrinsics opencv_camera(const ConfigNode& root, const ConfigNode& matrix) {
  constexpr std::string_view kKey = "camera_matrix";
  const std::vector<double> k = camera_matrix(matrix, kKey);
  PinholeIntrinsics intrinsics = {
      .width_px = size_of(root, std::array<std::string_view, 2>{"image_width", "imageWidth"}),
      .height_px = size_of(root, std::array<std::string_view, 2>{"image_height", "imageHeight"}),
      .focal_px = {k[0], k[4]},
      .center_px = {k[2] + kHalfPixel, k[5] + kHalfPixel}};
  check_focal(intrinsics, matrix.place, kKey);
  const ConfigNode* model = root.find("distortion_model");
  if (model != nullptr && model->text != "plumb_bob") {
    refuse_key(model->place,
               "distortion_model",
               fmt::format(R"(is "{}", must be "plumb_bob" (k1 k2 p1 p2 k3))", model->text));
  }
  const ConfigNode* distortion = find_any(
      root,
      std::array<std::string_view, 4>{"distortion_coefficients", "dist_coeffs", "distCoeffs", "D"});
  if (distortion != nullptr) {
    set_distortion(*distortion, intrinsics);
  }
  return intrinsics;
}

/// Of the models of a ViSP camera the one with distortion, else the first.
const ConfigNode& visp_model(const ConfigNode& camera) {
  const ConfigNode* models = camera.find("model");
  if (models == nullptr) {
    refuse_key(camera.place, "model", "is missing");
  }
  const auto is_distorted = [](const ConfigNode& model) {
    const ConfigNode* type = model.find("type");
    return type != nullptr && type->text == "perspectiveProjWithDistortion";
  };
  if (!models->is_array()) {
    return *models;
  }
  const auto found = std::ranges::find_if(models->items, is_distorted);
  return found == models->items.end() ? models->items.front() : *found;
}

PinholeIntrinsics visp_camera(const ConfigNode& cameras) {
  if (cameras.is_array()) {
    refuse_key(
        cameras.place, "camera", fmt::format("there are {}, must be one", cameras.items.size()));
  }
  const ConfigNode& model = visp_model(cameras);
  const ConfigNode* type = model.find("type");
  const bool is_distorted = type != nullptr && type->text == "perspectiveProjWithDistortion";
  if (!is_distorted && (type == nullptr || type->text != "perspectiveProjWithoutDistortion")) {
    refuse_key(type == nullptr ? model.place : type->place,
               "type",
               "must be perspectiveProjWithDistortion or perspectiveProjWithoutDistortion");
  }
  PinholeIntrinsics intrinsics = {
      .width_px = size_of(cameras, std::array<std::string_view, 1>{"image_width"}),
      .height_px = size_of(cameras, std::array<std::string_view, 1>{"image_height"}),
      .focal_px = {required(model, "px"), required(model, "py")},
      .center_px = {required(model, "u0") + kHalfPixel, required(model, "v0") + kHalfPixel}};
  check_focal(intrinsics, model.place, "px");
  if (is_distorted) {
    intrinsics.radial[0] = required(model, "kud");
  }
  return intrinsics;
}

CameraFile glint_camera(const ConfigNode& root) {
  const ConfigNode* table = root.find("camera");
  if (table == nullptr) {
    refuse_key(root.place, "camera", "is missing, must be a table [camera] as in a scene");
  }
  std::vector<Problem> errors;
  CameraSettings settings;
  KeyReader reader(table, "camera", errors);
  visit_keys(reader, settings);
  reader.report_unknown();
  LensSettings lens;
  KeyReader lens_reader(root.find("lens"), "lens", errors);
  visit_keys(lens_reader, lens);
  lens_reader.report_unknown();
  throw_if_any(errors);
  CameraFile file = {.intrinsics = intrinsics_of(settings, lens), .kind = "TOML"};
  if (lens.f_number > 0.0) {
    const LensGeometry geometry = lens_geometry(settings, lens);
    file.sharp_near_mm = geometry.near_mm;
    file.sharp_far_mm = geometry.far_mm;
  }
  return file;
}

CameraFile camera_of(const ConfigNode& root) {
  if (!root.is_table()) {
    refuse_key(root.place, "camera_matrix", "is missing");
  }
  if (const ConfigNode* camera = root.find("camera")) {
    return {.intrinsics = visp_camera(*camera), .kind = "ViSP"};
  }
  const ConfigNode* matrix = find_any(
      root, std::array<std::string_view, 4>{"camera_matrix", "cameraMatrix", "Camera_Matrix", "K"});
  if (matrix == nullptr) {
    refuse_key(root.place, "camera_matrix", "is missing, and so is ViSP's <camera>");
  }
  return {.intrinsics = opencv_camera(root, *matrix), .kind = "OpenCV or ROS"};
}

}  // namespace

CameraFile parse_camera_file(std::string_view text,
                             const std::string& file,
                             std::string_view ending) {
  if (ending == ".toml") {
    return glint_camera(parse_toml(text, file));
  }
  if (ending == ".yaml" || ending == ".yml") {
    return camera_of(parse_located_yaml(text, file));
  }
  if (ending == ".xml") {
    return camera_of(parse_located_xml(text, file));
  }
  throw ConfigError(
      fmt::format("{}: a camera's file must end in .toml, .yaml, .yml or .xml", file));
}

CameraFile read_camera_file(const std::filesystem::path& path) {
  return parse_camera_file(read_file(path), path.string(), path.extension().string());
}

}  // namespace glint

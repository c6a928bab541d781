// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/poses/pose_file.h"

#include <algorithm>
#include <array>
#include <map>

#include <fmt/format.h>

#include "core/config/located_json.h"
#include "core/config/located_yaml.h"
#include "core/config/toml.h"
#include "core/file.h"
#include "core/text.h"
#include "hardware/poses/convention_merge.h"
#include "hardware/poses/pose_reading.h"
#include "hardware/poses/pose_table.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

constexpr std::array<std::string_view, 3> kPoseKeys = {
    "pose", "base_from_flange", "flange_from_base"};

bool is_one_of(std::string_view word, std::span<const std::string_view> words) {
  return std::ranges::find(words, word) != words.end();
}

// --- Trees ---------------------------------------------------------------------------------------

/// Numbers of a list, or of a list of rows, row by row.
void add_numbers(const ConfigNode& node, int depth, std::vector<double>& numbers) {
  for (const ConfigNode& item : node.items) {
    if (item.is_number()) {
      numbers.push_back(item.number);
    } else if (item.is_array() && depth == 0) {
      add_numbers(item, 1, numbers);
    } else {
      refuse_key(item.place, "pose", "must be a list of numbers, or of rows of numbers");
    }
  }
}

/// The list of a matrix as ViSP and OpenCV write it; nullptr when it is none.
const ConfigNode* matrix_data(const ConfigNode& node) {
  const ConfigNode* data = node.find("data");
  return node.find("rows") != nullptr && node.find("cols") != nullptr && data != nullptr ? data
                                                                                         : nullptr;
}

std::vector<double> numbers_of(const ConfigNode& node) {
  const ConfigNode* data = node.is_table() ? matrix_data(node) : &node;
  if (data == nullptr || !data->is_array()) {
    refuse_key(node.place, "pose", "must be a list of numbers, or of rows of numbers");
  }
  std::vector<double> numbers;
  add_numbers(*data, 0, numbers);
  return numbers;
}

std::string text_of(const ConfigNode& node, std::string_view key) {
  if (node.kind == ConfigNode::Kind::kText) {
    return node.text;
  }
  if (node.kind == ConfigNode::Kind::kInteger || node.kind == ConfigNode::Kind::kNumber) {
    return shortest(node.number);
  }
  refuse_key(node.place, std::string(key), "must be a text or a number");
}

void set_direction(PoseFile& file, std::string_view key, const Place& place) {
  if (key == "pose") {
    return;
  }
  const PoseDirection direction =
      key == "base_from_flange" ? PoseDirection::kBaseFromFlange : PoseDirection::kFlangeFromBase;
  PoseDirection& known = file.convention.direction;
  if (known != PoseDirection::kAuto && known != direction) {
    refuse_key(
        place, std::string(key), "an earlier pose has the other direction, all must have one");
  }
  known = direction;
}

/// One key of a pose's table.
void read_key(const std::string& key, const ConfigNode& item, WrittenPose& pose, PoseFile& file) {
  if (is_one_of(key, kPoseNameKeys)) {
    pose.name = text_of(item, key);
  } else if (is_one_of(key, kPoseStampKeys)) {
    if (!item.is_number()) {
      refuse_key(item.place, key, "must be a number of seconds");
    }
    pose.has_stamp = true;
    pose.stamp_s = item.number;
  } else if (is_one_of(key, kPoseKeys)) {
    if (!pose.numbers.empty()) {
      refuse_key(item.place, key, "a second set of numbers, a pose has one");
    }
    pose.numbers = numbers_of(item);
    pose.place = item.place;
    set_direction(file, key, item.place);
  } else {
    refuse_key(item.place,
               key,
               fmt::format("unknown key, known are {}, {}, {}",
                           quoted_list(kPoseNameKeys),
                           quoted_list(kPoseStampKeys),
                           quoted_list(kPoseKeys)));
  }
}

WrittenPose table_pose(const ConfigNode& table, PoseFile& file) {
  WrittenPose pose = {.place = table.place};
  for (std::size_t i = 0; i < table.items.size(); ++i) {
    read_key(table.names[i], table.items[i], pose, file);
  }
  if (pose.numbers.empty()) {
    refuse_key(table.place,
               "pose",
               fmt::format("is missing, one of {} is needed", quoted_list(kPoseKeys)));
  }
  return pose;
}

const ConfigNode* pose_list(const ConfigNode& root) {
  if (root.is_array()) {
    return &root;
  }
  const ConfigNode* list = root.find("poses");
  return list != nullptr ? list : root.find("pose");
}

/// A matrix alone in its file, also below one name.
const ConfigNode* single_matrix(const ConfigNode& root) {
  if (!root.is_table()) {
    return nullptr;
  }
  if (matrix_data(root) != nullptr) {
    return &root;
  }
  return root.items.size() == 1 && root.items.front().is_table() &&
                 matrix_data(root.items.front()) != nullptr
             ? &root.items.front()
             : nullptr;
}

void read_convention(const ConfigNode& root, PoseFile& file) {
  std::vector<Problem> errors;
  KeyReader reader(root.find("convention"), "convention", errors);
  visit_keys(reader, file.convention);
  reader.report_unknown();
  for (std::size_t i = 0; i < root.names.size(); ++i) {
    if (!is_one_of(root.names[i], std::array<std::string_view, 3>{"convention", "pose", "poses"})) {
      errors.push_back({.kind = Problem::Kind::kUnknownKey,
                        .place = root.items[i].place,
                        .key = root.names[i],
                        .text = R"(unknown key, known are "convention", "poses")"});
    }
  }
  throw_if_any(errors);
}

PoseFile poses_of_tree(const ConfigNode& root, const std::string& name) {
  PoseFile file;
  if (const ConfigNode* matrix = single_matrix(root)) {
    file.poses.push_back({.name = name, .numbers = numbers_of(*matrix), .place = matrix->place});
    return file;
  }
  if (root.is_table()) {
    read_convention(root, file);
  }
  const ConfigNode* list = pose_list(root);
  if (list == nullptr || !list->is_array()) {
    refuse_key(root.place, "poses", "is missing, must be a list of poses");
  }
  const bool is_flat =
      !list->items.empty() && std::ranges::all_of(list->items, &ConfigNode::is_number);
  if (is_flat) {
    file.poses.push_back({.name = name, .numbers = numbers_of(*list), .place = list->place});
    return file;
  }
  for (const ConfigNode& item : list->items) {
    file.poses.push_back(item.is_table() && matrix_data(item) == nullptr
                             ? table_pose(item, file)
                             : WrittenPose{.numbers = numbers_of(item), .place = item.place});
  }
  return file;
}

// --- All files -----------------------------------------------------------------------------------

std::string place_text(const WrittenPose& pose) {
  return fmt::format("{}:{}", pose.place.file, pose.place.line);
}

/// The pose that has the same key, which is remembered when there is none.
template <class Key>
const WrittenPose* earlier(const Key& key,
                           const WrittenPose& pose,
                           std::map<Key, const WrittenPose*>& known) {
  const auto [at, is_new] = known.try_emplace(key, &pose);
  return is_new ? nullptr : at->second;
}

void check_doubled(std::span<const WrittenPose> poses) {
  std::vector<Problem> errors;
  std::map<std::string, const WrittenPose*> names;
  std::map<double, const WrittenPose*> stamps;
  for (const WrittenPose& pose : poses) {
    if (const WrittenPose* known = pose.name.empty() ? nullptr : earlier(pose.name, pose, names)) {
      errors.push_back(
          {.place = pose.place,
           .key = "name",
           .text = fmt::format(
               "\"{}\" is the name of an earlier pose, {}", pose.name, place_text(*known))});
    }
    if (const WrittenPose* known = pose.has_stamp ? earlier(pose.stamp_s, pose, stamps) : nullptr) {
      errors.push_back({.place = pose.place,
                        .key = "stamp_s",
                        .text = fmt::format("{} is the stamp of an earlier pose, {}",
                                            shortest(pose.stamp_s),
                                            place_text(*known))});
    }
  }
  throw_if_any(errors);
}

}  // namespace

PoseFile parse_pose_file(std::string_view text, const std::string& file, std::string_view ending) {
  if (const std::size_t zero = text.find('\0'); zero != text.npos) {
    throw ConfigError(fmt::format(
        "{}: is no text in UTF-8: byte {} is 0, as every other one is in UTF-16", file, zero + 1));
  }
  const std::string name = fs::path(file).stem().string();
  if (ending == ".csv") {
    return parse_pose_table(text, file);
  }
  if (ending == ".json") {
    return poses_of_tree(parse_located_json(text, file), name);
  }
  if (ending == ".toml") {
    return poses_of_tree(parse_toml(text, file), name);
  }
  if (ending == ".yaml" || ending == ".yml") {
    return poses_of_tree(parse_located_yaml(text, file), name);
  }
  throw ConfigError(
      fmt::format("{}: a file of poses must end in .csv, .json, .toml, .yaml or .yml", file));
}

RobotPoses robot_poses(const PoseFile& written, const PoseConvention& said) {
  if (written.poses.empty()) {
    throw ConfigError("poses", "there is none, at least one is needed");
  }
  const PoseConvention known = overruled(written.convention, said);
  ResolvedConvention resolved = resolved_convention(written.poses, known);
  check_doubled(written.poses);
  std::vector<PoseConvention> otherwise = other_conventions(written.poses, known);
  RobotPoses result = {.convention = resolved.convention,
                       .told = std::move(resolved.told),
                       .written = written.poses,
                       .otherwise = std::move(otherwise)};
  std::vector<Problem> errors;
  for (const WrittenPose& pose : written.poses) {
    try {
      result.poses.push_back({.name = pose.name,
                              .base_from_flange = base_from_flange(pose, result.convention),
                              .place = pose.place});
    } catch (const ConfigError& error) {
      errors.insert(errors.end(), error.problems().begin(), error.problems().end());
    }
  }
  throw_if_any(errors);
  return result;
}

RobotPoses read_poses(std::span<const fs::path> files, const PoseConvention& said) {
  PoseFile all;
  FileConventions conventions(said);
  for (const fs::path& file : files) {
    PoseFile one = parse_pose_file(read_file(file), file.string(), file.extension().string());
    if (one.poses.empty()) {
      throw ConfigError(file.string() + ": poses: there is none, at least one is needed");
    }
    all.poses.insert(all.poses.end(), one.poses.begin(), one.poses.end());
    conventions.add(one.convention, file.string());
  }
  all.convention = conventions.all();
  return robot_poses(all, said);
}

}  // namespace glint

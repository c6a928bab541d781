// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/poses/pose_pairing.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <numeric>
#include <optional>

#include <fmt/format.h>

#include "core/error.h"

namespace glint {
namespace {

using Keys = std::vector<std::string>;

std::string file_name(const std::string& name) {
  return std::filesystem::path(name).filename().string();
}

/// Without the ending, where it has letters: "pose_1.5" keeps its own.
std::string stem(const std::string& name) {
  const std::filesystem::path path(name);
  const std::string ending = path.extension().string();
  const bool is_ending = ending.find_first_not_of(".0123456789") != ending.npos;
  return is_ending ? path.stem().string() : path.filename().string();
}

/// The last digits without leading zeros; empty when there are none.
std::string last_number(const std::string& name) {
  constexpr std::string_view kDigits = "0123456789";
  const std::string text = stem(name);
  const std::size_t last = text.find_last_of(kDigits);
  if (last == text.npos) {
    return "";
  }
  const std::size_t before = text.find_last_not_of(kDigits, last);
  const std::size_t first = before == text.npos ? 0 : before + 1;
  const std::string digits = text.substr(first, last - first + 1);
  const std::size_t nonzero = digits.find_first_not_of('0');
  return nonzero == digits.npos ? "0" : digits.substr(nonzero);
}

Keys mapped(std::span<const std::string> names, std::string (*key)(const std::string&)) {
  Keys keys(names.size());
  std::ranges::transform(names, keys.begin(), key);
  return keys;
}

/// The first key that occurs twice, or is empty.
std::optional<std::string> fault_of(const Keys& keys) {
  Keys sorted = keys;
  std::ranges::sort(sorted);
  if (!sorted.empty() && sorted.front().empty()) {
    return "one has none";
  }
  const auto twice = std::ranges::adjacent_find(sorted);
  return twice == sorted.end() ? std::nullopt
                               : std::optional(fmt::format("\"{}\" occurs twice", *twice));
}

/// Names of which the other side has no key.
Keys unmatched(std::span<const std::string> names, const Keys& keys, const Keys& others) {
  Keys result;
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (std::ranges::find(others, keys[i]) == others.end()) {
      result.push_back(names[i]);
    }
  }
  return result;
}

std::string listed(const Keys& names) {
  constexpr std::size_t kMax = 5;
  const std::span<const std::string> shown(names.data(), std::min(names.size(), kMax));
  return fmt::format("{}{}", fmt::join(shown, ", "), names.size() > kMax ? ", ..." : "");
}

std::vector<std::size_t> indices(const Keys& pictures, const Keys& poses) {
  std::map<std::string, std::size_t> pose_at;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    pose_at[poses[i]] = i;
  }
  std::vector<std::size_t> result;
  for (const std::string& key : pictures) {
    result.push_back(pose_at.at(key));
  }
  return result;
}

/// What is wrong with pairing by these keys; empty: nothing.
std::string fault_between(std::span<const std::string> pictures,
                          std::span<const std::string> pose_names,
                          const Keys& picture_keys,
                          const Keys& pose_keys) {
  if (const auto fault = fault_of(picture_keys)) {
    return "of the pictures' keys " + *fault;
  }
  if (const auto fault = fault_of(pose_keys)) {
    return "of the poses' keys " + *fault;
  }
  const Keys without_pose = unmatched(pictures, picture_keys, pose_keys);
  if (!without_pose.empty()) {
    return fmt::format("no pose for {}", listed(without_pose));
  }
  const Keys without_picture = unmatched(pose_names, pose_keys, picture_keys);
  return without_picture.empty() ? "" : fmt::format("no picture for {}", listed(without_picture));
}

[[noreturn]] void refuse(const std::string& text) {
  throw ConfigError("poses.pair_by", text);
}

/// For each picture the pose's name that its path ends with, folder by folder; the path itself
/// where there is none.
Keys ends_of_paths(std::span<const std::string> pictures, std::span<const std::string> pose_names) {
  Keys keys(pictures.begin(), pictures.end());
  for (std::string& key : keys) {
    const std::string path = "/" + key;
    const auto found = std::ranges::find_if(pose_names, [&path](const std::string& name) {
      return !name.empty() && path.ends_with("/" + name);
    });
    key = found == pose_names.end() ? key : *found;
  }
  return keys;
}

Pairing by_order(std::size_t num_pictures, std::size_t num_poses) {
  if (num_pictures != num_poses) {
    refuse(fmt::format("there are {} pictures and {} poses, \"order\" needs as many of both",
                       num_pictures,
                       num_poses));
  }
  Pairing pairing = {.pose_of = std::vector<std::size_t>(num_pictures),
                     .told = "pair_by = \"order\": the first pose is that of the first picture"};
  std::iota(pairing.pose_of.begin(), pairing.pose_of.end(), std::size_t{0});
  return pairing;
}

/// Pairs by what both names are made into.
struct Way {
  PairBy by;
  std::string (*key)(const std::string&);
  const char* told;
};

constexpr std::array kWays = {
    Way{PairBy::kName, file_name, "pair_by = \"name\": names agree"},
    Way{PairBy::kName, stem, "pair_by = \"name\": names agree but for endings"},
    Way{PairBy::kLastNumber,
        last_number,
        "pair_by = \"last_number\": last numbers of the names agree"}};

Pairing by_keys(std::span<const std::string> pictures,
                std::span<const std::string> pose_names,
                PairBy by) {
  std::string first_fault;
  for (const Way& way : kWays) {
    if (by != PairBy::kAuto && by != way.by) {
      continue;
    }
    const Keys picture_keys = mapped(pictures, way.key);
    const Keys pose_keys = mapped(pose_names, way.key);
    const std::string fault = fault_between(pictures, pose_names, picture_keys, pose_keys);
    if (fault.empty()) {
      return {.pose_of = indices(picture_keys, pose_keys), .told = way.told};
    }
    // Of names that agree in part the missing ones are what is wrong.
    const bool is_near = unmatched(pictures, picture_keys, pose_keys).size() < pictures.size();
    if (first_fault.empty() || (is_near && way.by == PairBy::kName)) {
      first_fault = fault;
    }
    if (is_near && way.by == PairBy::kName && by == PairBy::kAuto && way.key == stem) {
      break;
    }
  }
  refuse(
      fmt::format("poses and pictures cannot be paired: {}; allowed are \"name\", "
                  "\"last_number\" and \"order\"",
                  first_fault));
}

}  // namespace

Pairing pair_poses(std::span<const std::string> pictures,
                   std::span<const std::string> pose_names,
                   PairBy by) {
  const bool has_names =
      std::ranges::any_of(pose_names, [](const std::string& name) { return !name.empty(); });
  if (by == PairBy::kOrder || (by == PairBy::kAuto && !has_names)) {
    return by_order(pictures.size(), pose_names.size());
  }

  const Keys names(pose_names.begin(), pose_names.end());
  const Keys ends = ends_of_paths(pictures, pose_names);
  const bool has_folders = std::ranges::any_of(
      names, [](const std::string& name) { return name.find('/') != name.npos; });
  if (has_folders && by != PairBy::kLastNumber &&
      fault_between(pictures, pose_names, ends, names).empty()) {
    return {.pose_of = indices(ends, names),
            .told = "pair_by = \"name\": names agree with the ends of paths"};
  }

  return by_keys(pictures, pose_names, by);
}

}  // namespace glint

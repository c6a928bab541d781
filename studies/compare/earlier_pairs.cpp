// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/earlier_pairs.h"

#include <array>
#include <charconv>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "core/error.h"
#include "studies/output/result_folder.h"
#include "studies/output/staged_folder.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

constexpr const char* kRefined = "refined.toml";
constexpr auto kPairFiles =
    std::to_array<const char*>({"overlay.png", "simulated.png", "difference.exr", kRefined});

/// A name that pair_folder() gives: not "pair_001", which a person may have called a copy.
bool is_pair_folder(const std::string& name) {
  constexpr std::string_view kBegin = "pair_";
  std::size_t number = 0;
  const char* end = name.data() + name.size();
  return name.starts_with(kBegin) &&
         std::from_chars(name.data() + kBegin.size(), end, number).ptr == end && number > 0 &&
         pair_folder(number - 1) == name;
}

}  // namespace

std::string pair_folder(std::size_t index) {
  return fmt::format("pair_{:02d}", index + 1);
}

std::vector<std::string> earlier_pairs(const fs::path& out) {
  std::vector<std::string> names;
  if (result_kind_of(out) != ResultKind::kCompare) {
    return names;
  }
  std::error_code ignored;
  for (const fs::path& entry : sorted_entries(out)) {
    const std::string name = entry.filename().string();
    if (is_pair_folder(name) && fs::is_directory(fs::symlink_status(entry, ignored))) {
      names.push_back(name);
    }
  }
  return names;
}

void check_inputs_kept_in_pairs(std::span<const fs::path> inputs,
                                const fs::path& out,
                                std::span<const std::string> pairs) {
  for (const fs::path& input : inputs) {
    for (const std::string& pair : pairs) {
      for (const char* name : kPairFiles) {
        std::error_code ignored;  // no such file: not read
        if (!input.empty() && fs::equivalent(input, out / pair / name, ignored)) {
          throw ConfigError(fmt::format(
              "{}: is read, and lies where results are written: copy it to another folder or under "
              "a name of your own, or choose another output folder than {}",
              input.string(),
              out.string()));
        }
      }
    }
  }
}

std::vector<fs::path> stale_files(const fs::path& out, const fs::path& stage) {
  std::vector<fs::path> stale;
  if (result_kind_of(out) != ResultKind::kCompare) {
    return stale;
  }
  const auto add = [&](const fs::path& file) {
    std::error_code ignored;
    if (fs::is_regular_file(out / file, ignored) && !fs::exists(stage / file, ignored)) {
      stale.push_back(file);
    }
  };
  add(kRefined);
  for (const std::string& pair : earlier_pairs(out)) {
    for (const char* name : kPairFiles) {
      add(fs::path(pair) / name);
    }
  }
  return stale;
}

void remove_stale_files(const fs::path& out, std::span<const fs::path> stale) {
  std::error_code ignored;
  for (const fs::path& file : stale) {
    fs::remove(out / file, ignored);
    if (file.has_parent_path()) {
      fs::remove(out / file.parent_path(), ignored);  // stays where it is not empty
    }
  }
}

}  // namespace glint

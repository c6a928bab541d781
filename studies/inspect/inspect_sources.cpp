// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspect/inspect_sources.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

#include "core/error.h"
#include "core/file.h"
#include "studies/inspect/picture_sequence.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

bool is_folder(const fs::path& path) {
  std::error_code ignored;
  return fs::is_directory(path, ignored);
}

/// The last part of a path, also of "out/run/" and ".".
std::string last_name(const fs::path& path) {
  std::string name = path.filename().string();
  if (name.empty() || name == "." || name == "..") {
    std::error_code error;
    const fs::path whole = fs::weakly_canonical(path, error);
    name = whole.filename().empty() ? whole.parent_path().filename().string()
                                    : whole.filename().string();
  }
  return name.empty() ? "part" : name;
}

/// What it stands for in the result's folder must not be hidden or leave it.
std::string folder_name(std::string name) {
  std::ranges::replace(name, '/', '_');
  return name.starts_with(".") ? "_" + name : name;
}

fs::path if_there(const fs::path& path) {
  return is_there(path) ? path : fs::path();
}

PicturedPart design_source(const fs::path& folder, const std::string& name) {
  return {.name = name,
          .pictures = pictures_in(folder / "sequence"),
          .mask = if_there(folder / "part_mask.png"),
          .scene = if_there(folder / "scene.toml"),
          .truth = if_there(folder / "defects.json")};
}

/// The designs of a run: the baseline, the winner, then the others by name.
std::vector<fs::path> designs_in(const fs::path& folder) {
  std::vector<fs::path> designs;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; at != end; at.increment(error)) {
    if (is_folder(at->path() / "sequence") && !at->path().filename().string().starts_with(".")) {
      designs.push_back(at->path());
    }
  }
  const auto rank = [](const fs::path& path) {
    return path.filename() == "baseline" ? 0 : path.filename() == "winner" ? 1 : 2;
  };
  std::ranges::sort(designs, [&](const fs::path& a, const fs::path& b) {
    return rank(a) != rank(b) ? rank(a) < rank(b)
                              : natural_less(a.filename().string(), b.filename().string());
  });
  return designs;
}

void add_folder(const fs::path& folder, bool is_only, std::vector<PicturedPart>& sources) {
  const std::string name = last_name(folder);
  if (is_folder(folder / "sequence")) {
    sources.push_back(design_source(folder, name));
    return;
  }
  const std::vector<fs::path> designs = designs_in(folder);
  for (const fs::path& design : designs) {
    const std::string own = design.filename().string();
    sources.push_back(design_source(design, is_only ? own : fmt::format("{}_{}", name, own)));
  }
  if (designs.empty()) {
    sources.push_back({.name = name, .pictures = pictures_in(folder)});
  }
}

void make_unique(std::vector<PicturedPart>& sources) {
  std::set<std::string> used;
  for (PicturedPart& source : sources) {
    source.name = folder_name(source.name);
    const std::string name = source.name;
    for (int number = 2; !used.insert(source.name).second; ++number) {
      source.name = fmt::format("{}_{}", name, number);
    }
  }
}

/// One name for pictures that are one part: what their names begin with.
std::string common_name(const std::vector<fs::path>& files) {
  if (files.size() == 1) {
    return files.front().stem().string();
  }
  const std::string folder = last_name(fs::absolute(files.front()).parent_path());
  return folder.empty() ? "part" : folder;
}

}  // namespace

std::vector<PicturedPart> part_sources(const std::vector<fs::path>& inputs, bool is_each) {
  std::vector<fs::path> files;
  std::vector<fs::path> folders;
  for (const fs::path& input : inputs) {
    if (!is_there(input)) {
      throw IoError(input.string() + ": there is no such file or folder");
    }
    (is_folder(input) ? folders : files).push_back(input);
  }
  if (files.empty() && folders.empty()) {
    throw ConfigError("no picture is given");
  }
  if (!files.empty() && !folders.empty()) {
    throw ConfigError(fmt::format(
        "{}: is a file and {} a folder: give the pictures of one part, or folders of parts",
        files.front().string(),
        folders.front().string()));
  }
  std::vector<PicturedPart> sources;
  if (is_each) {
    for (const fs::path& folder : folders) {
      const std::vector<fs::path> pictures = pictures_in(folder);
      files.insert(files.end(), pictures.begin(), pictures.end());
    }
    for (const fs::path& file : files) {
      sources.push_back({.name = file.stem().string(), .pictures = {file}});
    }
  } else if (!files.empty()) {
    sources.push_back({.name = common_name(files), .pictures = files});
  } else {
    for (const fs::path& folder : folders) {
      add_folder(folder, folders.size() == 1, sources);
    }
  }
  make_unique(sources);
  return sources;
}

}  // namespace glint

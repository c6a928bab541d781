// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/compare_sources.h"

#include <algorithm>
#include <array>
#include <set>

#include <fmt/format.h>

#include "core/csv.h"
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

fs::path if_there(const fs::path& path) {
  std::error_code ignored;
  return fs::exists(path, ignored) ? path : fs::path();
}

/// The last part of a path that has a name, also of "out/run/".
std::string last_name(const fs::path& path) {
  const fs::path whole = path.filename().empty() ? path.parent_path() : path;
  return whole.filename().string();
}

/// The picture of a rendered view or of a design, the one with the most grey levels.
fs::path picture_of_view(const fs::path& folder) {
  constexpr std::array<const char*, 4> kNames = {
      "image.tif", "image.png", "aspect.png", "aspect.exr"};
  for (const char* name : kNames) {
    fs::path file = if_there(folder / name);
    if (!file.empty()) {
      return file;
    }
  }
  return {};
}

bool is_view(const fs::path& folder) {
  return !if_there(folder / "scene.toml").empty() && !picture_of_view(folder).empty();
}

/// What `glint render --masks` leaves: masks and geometry, which are pictures by their names alone.
bool is_view_without_picture(const fs::path& folder) {
  return !if_there(folder / "scene.toml").empty() && !if_there(folder / "part_mask.png").empty() &&
         picture_of_view(folder).empty();
}

[[noreturn]] void throw_without_picture(const fs::path& view) {
  throw ConfigError(view.string() +
                    ": holds the masks of a view and no picture of it: render it without --masks");
}

CompareSource view_source(const fs::path& folder) {
  return {.name = last_name(folder),
          .picture = picture_of_view(folder),
          .geometry = if_there(folder / "geometry.exr"),
          .mask = if_there(folder / "part_mask.png"),
          .scene = if_there(folder / "scene.toml"),
          .truth = if_there(folder / "defects.json")};
}

std::vector<CompareSource> views_in(const fs::path& folder) {
  std::vector<fs::path> views;
  fs::path without_picture;
  std::error_code error;
  for (fs::directory_iterator at(folder, error), end; !error && at != end; at.increment(error)) {
    if (!is_folder(at->path()) || at->path().filename().string().starts_with(".")) {
      continue;
    }
    if (is_view(at->path())) {
      views.push_back(at->path());
    } else if (is_view_without_picture(at->path())) {
      without_picture = at->path();
    }
  }
  if (views.empty() && !without_picture.empty()) {
    throw_without_picture(without_picture);
  }
  std::ranges::sort(views, [](const fs::path& a, const fs::path& b) {
    return natural_less(a.filename().string(), b.filename().string());
  });
  std::vector<CompareSource> sources;
  for (const fs::path& view : views) {
    sources.push_back(view_source(view));
  }
  return sources;
}

std::set<std::string> names_of(const std::vector<CompareSource>& sources) {
  std::set<std::string> names;
  for (const CompareSource& source : sources) {
    names.insert(source.name);
  }
  return names;
}

bool is_named(const CompareSource& source, const std::string& name) {
  return source.name == name || source.picture.filename().string() == name ||
         source.picture.string() == name;
}

const CompareSource* find(const std::vector<CompareSource>& sources, const std::string& name) {
  const auto found = std::ranges::find_if(
      sources, [&](const CompareSource& source) { return is_named(source, name); });
  return found == sources.end() ? nullptr : &*found;
}

const CompareSource& named(const std::vector<CompareSource>& sources,
                           const CsvField& field,
                           const char* side) {
  const CompareSource* source = find(sources, field.text);
  const auto count = std::ranges::count_if(
      sources, [&](const CompareSource& other) { return is_named(other, field.text); });
  if (count > 1) {
    throw ConfigError(Problem{
        .place = field.place,
        .text = fmt::format(
            "{} {} pictures are called {}: name each by its path", count, side, field.text)});
  }
  if (source == nullptr) {
    throw ConfigError(Problem{
        .place = field.place,
        .text = fmt::format(
            "there is no {} picture {}, there is {}", side, field.text, sources.front().name)});
  }
  return *source;
}

bool is_head(const CsvRow& row) {
  return row.size() >= 2 && row[0].text == "simulated" && row[1].text == "real" &&
         (row.size() == 2 || (row.size() == 3 && row[2].text == "mask"));
}

/// @param folder  that the mask's path is relative to
fs::path mask_of(const CsvField& field, const fs::path& folder) {
  const fs::path mask = folder / field.text;
  if (!field.text.empty() && if_there(mask).empty()) {
    throw ConfigError(
        Problem{.place = field.place, .text = fmt::format("there is no mask {}", mask.string())});
  }
  return field.text.empty() ? fs::path() : mask;
}

std::vector<ComparePair> pairs_of_csv(const fs::path& file,
                                      const std::vector<CompareSource>& simulated,
                                      const std::vector<CompareSource>& reals) {
  std::vector<CsvRow> rows = parse_csv(read_file(file), file.string(), '#');
  if (!rows.empty() && is_head(rows[0])) {
    rows.erase(rows.begin());
  }
  std::vector<ComparePair> pairs;
  for (const CsvRow& row : rows) {
    if (row.size() != 2 && row.size() != 3) {
      throw ConfigError(Problem{
          .place = row[0].place,
          .text = fmt::format("{} fields, must be two or three: simulated,real,mask", row.size())});
    }
    pairs.push_back(
        {.simulated = named(simulated, row[0], "simulated"), .real = named(reals, row[1], "real")});
    if (row.size() == 3) {
      pairs.back().real_mask = mask_of(row[2], file.parent_path());
    }
  }
  if (pairs.empty()) {
    throw ConfigError(file.string() + ": holds no pair; a line is: simulated,real");
  }
  return pairs;
}

[[noreturn]] void throw_missing_pair(const std::vector<CompareSource>& simulated,
                                     const std::vector<CompareSource>& reals) {
  const std::set<std::string> names = names_of(reals);
  const auto missing = std::ranges::find_if(
      simulated, [&](const CompareSource& source) { return !names.contains(source.name); });
  const CompareSource& lonely = missing != simulated.end() ? *missing : simulated.front();
  throw ConfigError(fmt::format(
      "{}: has no real picture: {} simulated and {} real pictures are given, and their names "
      "differ; give equal names, equal numbers, or a CSV file with --pairs",
      lonely.picture.string(),
      simulated.size(),
      reals.size()));
}

/// Whether each simulated picture has a real one of its name, and no name stands twice.
bool have_partners(const std::vector<CompareSource>& simulated,
                   const std::vector<CompareSource>& reals) {
  const std::set<std::string> names = names_of(reals);
  return names.size() == reals.size() && names_of(simulated).size() == simulated.size() &&
         std::ranges::all_of(
             simulated, [&](const CompareSource& source) { return names.contains(source.name); });
}

ComparePlan paired_by_name(const std::vector<CompareSource>& simulated,
                           const std::vector<CompareSource>& reals) {
  ComparePlan plan;
  for (const CompareSource& source : simulated) {
    plan.pairs.push_back({.simulated = source, .real = *find(reals, source.name)});
  }
  if (reals.size() > simulated.size()) {
    plan.notes.push_back(fmt::format("{} real pictures have no simulated one of their name",
                                     reals.size() - simulated.size()));
  }
  return plan;
}

ComparePlan paired_in_order(const std::vector<CompareSource>& simulated,
                            const std::vector<CompareSource>& reals) {
  if (simulated.size() != reals.size()) {
    throw_missing_pair(simulated, reals);
  }
  ComparePlan plan;
  plan.notes.emplace_back("Names differ: pictures were paired in the natural order of their names");
  for (std::size_t i = 0; i < reals.size(); ++i) {
    plan.pairs.push_back({.simulated = simulated[i], .real = reals[i]});
  }
  return plan;
}

}  // namespace

std::vector<CompareSource> compare_sources(const fs::path& path) {
  if (if_there(path).empty()) {
    throw IoError(path.string() + ": there is no such file or folder");
  }
  if (!is_folder(path)) {
    return {{.name = path.stem().string(), .picture = path}};
  }
  if (is_view(path)) {
    return {view_source(path)};
  }
  if (is_view_without_picture(path)) {
    throw_without_picture(path);
  }
  std::vector<CompareSource> sources = views_in(path);
  if (sources.empty()) {
    for (const fs::path& picture : pictures_in(path)) {
      sources.push_back({.name = picture.stem().string(), .picture = picture});
    }
  }
  return sources;
}

ComparePlan plan_comparison(const CompareInputs& inputs) {
  const std::vector<CompareSource> simulated = compare_sources(inputs.simulated);
  std::vector<CompareSource> reals;
  for (const fs::path& path : inputs.reals) {
    const std::vector<CompareSource> sources = compare_sources(path);
    reals.insert(reals.end(), sources.begin(), sources.end());
  }
  ComparePlan plan;
  if (!inputs.pairs.empty()) {
    plan.pairs = pairs_of_csv(inputs.pairs, simulated, reals);
    return plan;
  }
  if (simulated.size() == 1) {
    std::ranges::for_each(reals, [&](const CompareSource& real) {
      plan.pairs.push_back({.simulated = simulated[0], .real = real});
    });
    return plan;
  }
  // Views or designs of a run against one photograph: which of them is like it?
  if (reals.size() == 1 && std::ranges::all_of(simulated, &CompareSource::is_rendered)) {
    std::ranges::for_each(simulated, [&](const CompareSource& source) {
      plan.pairs.push_back({.simulated = source, .real = reals[0]});
    });
    plan.notes.push_back(
        fmt::format("One real picture goes with all {} simulated ones", simulated.size()));
    return plan;
  }
  return have_partners(simulated, reals) ? paired_by_name(simulated, reals)
                                         : paired_in_order(simulated, reals);
}

}  // namespace glint

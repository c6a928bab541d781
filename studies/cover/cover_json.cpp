// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cover/cover_json.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/csv.h"
#include "core/file.h"

namespace glint {
namespace fs = std::filesystem;

namespace {

using Json = nlohmann::ordered_json;

Json vector_json(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json view_json(const SceneCoverage& covered, std::size_t i) {
  const std::size_t viewpoint = covered.used[i];
  const ViewShare& share = covered.coverage.views[i];
  const Viewpoint& pose = covered.viewpoints[viewpoint];
  return {{"name", view_name(viewpoint)},
          {"adds", share.adds},
          {"sees", share.sees},
          {"only", share.only},
          {"viewpoint",
           {{"position_mm", pose.position_mm}, {"direction", pose.direction}, {"up", pose.up}}}};
}

Json gap_json(const CoverageGap& gap) {
  return gap.area_mm2 > 0.0 ? Json{{"area_mm2", gap.area_mm2},
                                   {"size_mm", gap.size_mm},
                                   {"place_mm", vector_json(gap.place_mm)},
                                   {"normal", vector_json(gap.normal)},
                                   {"mostly", state_name(gap.state)}}
                            : Json(nullptr);
}

/// Of the inspected area: half of it, and 95 % of it, shows defects of that size or larger ones.
Json smallest_json(const SceneCoverage& covered,
                   const CoverageSettings& settings,
                   const std::optional<PodReference>& pod) {
  struct Sized {
    double size_mm = 0.0;
    double area_mm2 = 0.0;
  };

  std::vector<Sized> sizes;
  double whole_mm2 = 0.0;
  for (std::size_t i = 0; i < covered.of_cell.size(); ++i) {
    if (const double size_mm = smallest_defect_mm(covered.of_cell[i], settings, pod);
        size_mm > 0.0) {
      sizes.push_back({.size_mm = size_mm, .area_mm2 = covered.cells.areas_mm2[i]});
      whole_mm2 += covered.cells.areas_mm2[i];
    }
  }
  if (sizes.empty()) {
    return nullptr;
  }
  std::ranges::sort(sizes, {}, &Sized::size_mm);
  const auto at = [&](double share) {
    double sum_mm2 = 0.0;
    for (const Sized& sized : sizes) {
      sum_mm2 += sized.area_mm2;
      if (sum_mm2 >= share * whole_mm2) {
        return sized.size_mm;
      }
    }
    return sizes.back().size_mm;
  };
  return {{"median_um", 1e3 * at(0.5)},
          {"p95_um", 1e3 * at(0.95)},
          {"worst_um", 1e3 * sizes.back().size_mm},
          {"defect_px", settings.defect_px}};
}

const Json* find_in(const Json& json, const char* key) {
  const auto found = json.is_object() ? json.find(key) : json.end();
  return found != json.end() ? &*found : nullptr;
}

}  // namespace

std::string view_name(std::size_t viewpoint) {
  return fmt::format("view_{:02}", viewpoint + 1);
}

double smallest_defect_mm(const CellCoverage& cell,
                          const CoverageSettings& settings,
                          const std::optional<PodReference>& pod) {
  if (cell.views == 0) {
    return 0.0;
  }
  const auto pixel_mm = static_cast<double>(cell.pixel_mm);
  const double found_mm = pod && pod->pixel_mm > 0.0 ? pod->a90_mm * pixel_mm / pod->pixel_mm : 0.0;
  return std::max(settings.defect_px * pixel_mm, found_mm);
}

std::vector<float> smallest_defects_um(const SceneCoverage& covered,
                                       const CoverageSettings& settings,
                                       const std::optional<PodReference>& pod) {
  std::vector<float> sizes;
  for (const CellCoverage& cell : covered.of_cell) {
    sizes.push_back(static_cast<float>(1e3 * smallest_defect_mm(cell, settings, pod)));
  }
  return sizes;
}

PodReference read_pod(const fs::path& folder) {
  const fs::path file = folder / "result.json";
  const Json result = Json::parse(read_file(file), nullptr, false);
  const Json* pod = find_in(result, "pod");
  const Json* size = pod == nullptr ? nullptr : find_in(*pod, "size");
  const Json* designs = pod == nullptr ? nullptr : find_in(*pod, "designs");
  if (size == nullptr || !size->is_string() || designs == nullptr) {
    throw ConfigError(fmt::format(
        "{}: holds no probability of detection; --pod takes the folder of a run with [pod]",
        file.string()));
  }
  const auto key = size->get<std::string>();
  if (!key.ends_with("_mm")) {
    throw ConfigError(
        fmt::format("{}: its sizes are {}; allowed are widths: diameter_mm, width_mm, length_mm",
                    file.string(),
                    key));
  }
  PodReference best;
  for (const auto& [name, design] : designs->items()) {
    const Json* fit = find_in(design, "fit");
    const Json* a90 = fit == nullptr ? nullptr : find_in(*fit, "a90");
    const Json* value = a90 == nullptr ? nullptr : find_in(*a90, "value");
    if (value != nullptr && value->is_number() &&
        (best.design.empty() || value->get<double>() < best.a90_mm)) {
      best = {.design = name, .a90_mm = value->get<double>()};
    }
  }
  if (best.design.empty()) {
    throw ConfigError(fmt::format("{}: no design has a size that is found nine times of ten (a90)",
                                  file.string()));
  }
  return best;
}

Json coverage_json(const SceneCoverage& covered,
                   const CoverageSettings& settings,
                   const std::optional<PodReference>& pod) {
  Json views = Json::array();
  for (std::size_t i = 0; i < covered.used.size(); ++i) {
    views.push_back(view_json(covered, i));
  }
  Json states = Json::object();
  for (int i = 0; i < kCellStates; ++i) {
    states[std::string(state_name(static_cast<CellState>(i)))] =
        covered.state_shares[static_cast<std::size_t>(i)];
  }
  Json result = {{"schema", 1},
                 {"status", "done"},
                 {"c1", covered.coverage.c1()},
                 {"ck", covered.coverage.ck},
                 {"redundancy", covered.coverage.redundancy},
                 {"views", views},
                 {"largest_gap_mm2", covered.gap.area_mm2},
                 {"largest_gap", gap_json(covered.gap)},
                 {"states", states},
                 {"smallest_defect", smallest_json(covered, settings, pod)},
                 {"area_mm2", covered.area_mm2},
                 {"points", covered.cells.size()},
                 {"has_light", covered.has_light}};
  if (covered.choice) {
    result["choice"] = {
        {"candidates", covered.viewpoints.size()},
        {"method", settings.choice == CoverageSettings::Choice::kExact ? "exact" : "greedy"},
        {"proven", covered.choice->is_proven}};
  }
  if (pod) {
    result["pod"] = {
        {"design", pod->design}, {"a90_mm", pod->a90_mm}, {"pixel_um", 1e3 * pod->pixel_mm}};
  }
  return result;
}

std::string views_csv(const SceneCoverage& covered) {
  std::vector<std::string> head = {"view", "chosen", "sees", "adds", "only"};
  for (const auto& [name, unit] :
       {std::pair("position", "_mm"), std::pair("direction", ""), std::pair("up", "")}) {
    for (const char axis : {'x', 'y', 'z'}) {
      head.push_back(fmt::format("{}_{}{}", name, axis, unit));
    }
  }
  std::string csv = csv_row(head);
  const Coverage all = coverage_of(covered.visibility, covered.cells.areas_mm2, 1);
  for (std::size_t i = 0; i < covered.viewpoints.size(); ++i) {
    const auto used = std::ranges::find(covered.used, i);
    const bool is_used = used != covered.used.end();
    const ViewShare& share =
        is_used ? covered.coverage.views[static_cast<std::size_t>(used - covered.used.begin())]
                : all.views[i];
    std::vector<std::string> fields = {view_name(i),
                                       is_used ? "1" : "0",
                                       shortest(share.sees),
                                       is_used ? shortest(share.adds) : "",
                                       is_used ? shortest(share.only) : ""};
    for (const double value : vector_of(covered.viewpoints[i])) {
      fields.push_back(shortest(value));
    }
    csv += csv_row(fields);
  }
  return csv;
}

}  // namespace glint

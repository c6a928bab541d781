// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/part/defect_metadata.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/config.h"
#include "core/config/key_writer.h"
#include "core/units.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using Eigen::Vector3d;

Json to_json(const ConfigNode& node) {
  using Kind = ConfigNode::Kind;
  switch (node.kind) {
    case Kind::kBoolean:
      return node.boolean;
    case Kind::kInteger:
      return node.integer;
    case Kind::kNumber:
      return node.number;
    case Kind::kText:
      return node.text;
    case Kind::kArray: {
      Json list = Json::array();
      for (const ConfigNode& item : node.items) {
        list.push_back(to_json(item));
      }
      return list;
    }
    case Kind::kTable:
      break;
  }
  Json table = Json::object();
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    table[node.names[i]] = to_json(node.items[i]);
  }
  return table;
}

/// The table as the scene file would have it, every key present.
template <class Settings>
Json table_of(Settings settings) {
  ConfigNode table = ConfigNode::table();
  KeyWriter writer(table);
  visit_keys(writer, settings);
  return to_json(table);
}

Json to_json(const Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

/// JSON has no infinity.
Json finite_or_null(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}

Json sizes_json(const Defect& defect) {
  if (is_line(defect.type)) {
    return {{"length_mm", defect.length_mm}, {"width_mm", defect.width_mm}};
  }
  return {{"diameter_mm", defect.diameter_mm}};
}

Json place_json(const Defect& defect, const RigidTransform& part_from_scene) {
  const SurfacePlace& place = defect.place;
  return {{"scene_mm", to_json(place.centre_mm)},
          {"part_mm", to_json(part_from_scene * place.centre_mm)},
          {"normal", to_json(place.normal)},
          {"u_axis", to_json(place.u_axis)},
          {"v_axis", to_json(place.v_axis)},
          {"triangle", defect.triangle},
          {"off_surface_mm", defect.off_surface_mm}};
}

Json refusals_json(const std::vector<std::pair<std::string, int>>& refusals) {
  Json counts = Json::object();
  for (const auto& [reason, count] : refusals) {
    counts[reason] = count;
  }
  return counts;
}

Json defect_json(const RealisedDefect& made, const RigidTransform& part_from_scene) {
  const Defect& defect = made.defect;
  Json json = {{"label", defect.label},
               {"id", defect.id},
               {"group", defect.group},
               {"number", defect.number},
               {"type", type_name(defect.type)},
               {"realisation", realisation_name(defect.realisation)},
               {"made", made.is_made}};
  if (!made.is_made) {
    json["reason"] = made.reason;
  }
  json["place"] = defect.triangle >= 0 ? place_json(defect, part_from_scene) : Json(nullptr);
  json["depth_um"] = defect.depth_mm / kMmPerUm;
  json["wanted_depth_um"] = defect.wanted_depth_mm / kMmPerUm;
  json["wall_mm"] = finite_or_null(defect.wall_mm);
  json.update(sizes_json(defect));
  json["angle_deg"] = defect.angle_rad * kDegPerRad;
  json["tilt_deg"] = defect.tilt_rad * kDegPerRad;
  json["tilt_direction_deg"] = defect.tilt_direction_rad * kDegPerRad;
  json["tool"] = defect.tool;
  json["seed"] = defect.seed;
  json["removed_volume_mm3"] = made.removed_volume_mm3;
  json["faces"] = made.faces;
  json["attempts"] = made.attempts;
  json["jitters"] = made.jitters;
  json["refusals"] = refusals_json(made.refusals);
  return json;
}

/// Over all defects, in the order of the alphabet.
Json all_refusals(const DefectivePart& part) {
  std::map<std::string, int> sums;
  for (const RealisedDefect& made : part.defects) {
    for (const auto& [reason, count] : made.refusals) {
      sums[reason] += count;
    }
  }
  return refusals_json({sums.begin(), sums.end()});
}

}  // namespace

namespace {

/// In micrometres, without an exponent.
std::string depth_text(double depth_mm) {
  const double depth_um = depth_mm / kMmPerUm;
  return depth_um < 1000.0 ? fmt::format("{:.4g}", depth_um) : fmt::format("{:.0f}", depth_um);
}

Json tables_of(const std::vector<NamedGroup>& groups) {
  Json tables = Json::object();
  for (const auto& [name, group] : groups) {
    tables[name] = table_of(group);
  }
  return tables;
}

}  // namespace

std::string shallow_note(const DefectivePart& part) {
  constexpr int kListed = 3;
  int count = 0;
  std::string list;
  for (const RealisedDefect& made : part.defects) {
    const Defect& defect = made.defect;
    if (!made.is_made || defect.depth_mm >= defect.wanted_depth_mm || ++count > kListed) {
      continue;
    }
    list += fmt::format("{}{} {} um deep instead of {} um in a wall of {:.3g} mm",
                        count > 1 ? ", " : "",
                        defect.label,
                        depth_text(defect.depth_mm),
                        depth_text(defect.wanted_depth_mm),
                        defect.wall_mm);
  }
  if (count == 0) {
    return "";
  }
  return fmt::format(
      "{} of the defects {} shallower than height_um says, for a depth takes at "
      "most wall_share of the wall below it: {}{}; when_thin = \"refuse\" draws "
      "other places instead",
      count,
      count == 1 ? "is" : "are",
      list,
      count > kListed ? ", ..." : "");
}

nlohmann::ordered_json defects_json(const DefectivePart& part,
                                    const std::vector<NamedGroup>& groups,
                                    const ImprintSettings& settings,
                                    std::uint64_t seed,
                                    const RigidTransform& scene_from_part) {
  Json list = Json::array();
  double removed_volume_mm3 = 0.0;
  std::size_t num_made = 0;
  const RigidTransform part_from_scene = inverse(scene_from_part);
  for (const RealisedDefect& made : part.defects) {
    list.push_back(defect_json(made, part_from_scene));
    removed_volume_mm3 += made.is_made ? made.removed_volume_mm3 : 0.0;
    num_made += made.is_made ? 1 : 0;
  }
  return {{"schema", 1},
          {"seed", seed},
          {"imprint", table_of(settings)},
          {"groups", tables_of(groups)},
          {"made", num_made},
          {"given_up", part.defects.size() - num_made},
          {"removed_volume_mm3", removed_volume_mm3},
          {"limited_vertices", part.limited_vertices},
          {"refusals", all_refusals(part)},
          {"defects", list}};
}

}  // namespace glint

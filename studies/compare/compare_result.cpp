// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/compare_result.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/median.h"
#include "core/units.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

Json optional_json(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json slope_json(const std::optional<Estimate>& slope) {
  return slope ? Json{{"value", slope->value},
                      {"low", slope->low},
                      {"high", slope->high},
                      {"unit", "px/1000 px"}}
               : Json(nullptr);
}

Json rings_json(const RingOffsets& rings) {
  Json list = Json::array();
  for (const OffsetRing& ring : rings.rings) {
    Json& row = list.emplace_back();
    row["inner_px"] = ring.inner_px;
    row["outer_px"] = ring.outer_px;
    row["points"] = ring.points;
    row["radial_px"] = ring.has_radial ? Json(ring.radial_px) : Json(nullptr);
    row["tangential_px"] = ring.has_tangential ? Json(ring.tangential_px) : Json(nullptr);
  }
  return list;
}

Json texture_json(const SurfaceTexture& texture) {
  return {{"windows", texture.windows},
          {"window_px", texture.window_px},
          {"spread", texture.spread},
          {"autocorrelation_px", texture.autocorrelation_px},
          {"longest_px", texture.longest_px},
          {"lay_deg", texture.lay_rad * kDegPerRad},
          {"lay_strength", texture.lay_strength},
          {"cooccurrence",
           {{"contrast", texture.cooccurrence.contrast},
            {"correlation", texture.cooccurrence.correlation},
            {"energy", texture.cooccurrence.energy},
            {"entropy_bits", texture.cooccurrence.entropy}}},
          {"radial_spectrum", texture.radial},
          {"angular_spectrum", texture.angular}};
}

Json texture_pair_json(const PairAppearance& look) {
  if (!look.texture) {
    return nullptr;
  }
  return {{"simulated", texture_json(look.simulated)},
          {"real", texture_json(look.real)},
          {"radial_spectrum_distance", look.texture->radial},
          {"angular_spectrum_distance", look.texture->angular},
          {"contrast_distance", look.texture->contrast},
          {"length_distance", look.texture->length},
          {"lay_distance_deg", look.texture->lay_rad * kDegPerRad}};
}

Json turn_json(const std::optional<BetterTurn>& turn) {
  return turn ? Json{{"name", turn->name},
                     {"correlation", turn->correlation},
                     {"correlation_as_is", turn->correlation_as_is}}
              : Json(nullptr);
}

Json edges_json(const std::vector<PartEdge>& edges) {
  Json list = Json::array();
  for (const PartEdge& edge : edges) {
    Json& row = list.emplace_back();
    row = {{"name", edge.name},
           {"middle_px", {edge.middle_px.x(), edge.middle_px.y()}},
           {"points", edge.points},
           {"mean_px", edge.mean_px},
           {"offset_px", edge.offset_px},
           {"sigma_px", edge.sigma_px > 0.0 ? Json(edge.sigma_px) : Json(nullptr)},
           {"shift_px", {edge.shift_px.x(), edge.shift_px.y()}}};
    if (!edge.surface.empty()) {
      row["surface"] = edge.surface;
      row["beyond"] = edge.beyond;
      row["middle_mm"] = {edge.middle_mm.x(), edge.middle_mm.y(), edge.middle_mm.z()};
      row["length_mm"] = edge.length_mm;
      row["offset_mm"] = edge.offset_mm;
    }
  }
  return list;
}

Json causes_json(const PairCauses& causes) {
  Json list = Json::array();
  for (const ToldCause& cause : causes.told) {
    Json& row = list.emplace_back();
    row["name"] = cause.name;
    row["value"] = cause.value;
    row["unit"] = cause.unit;
    row["sigma"] = cause.sigma;
    row["share"] = cause.share;
    row["of"] = cause.of;
    if (!cause.group.empty()) {
      row["group"] = cause.group;
    }
  }
  return list;
}

Json regions_json(const std::vector<RegionAppearance>& regions) {
  Json list = Json::array();
  for (const RegionAppearance& region : regions) {
    list.push_back({{"name", region.name},
                    {"pixels", region.pixels},
                    {"grey", region.grey},
                    {"difference", region.difference},
                    {"residual_rms", region.residual_rms},
                    {"correlation", region.correlation},
                    {"ssim", region.ssim},
                    {"gmsd", region.gmsd},
                    {"histogram_distance", region.histogram_distance}});
  }
  return list;
}

Json seen_json(const SeenDefect& seen) {
  Json json = {{"found", seen.is_beyond_picture ? Json(nullptr) : Json(seen.is_found)}};
  json["found_as"] = seen.is_found ? Json(seen.found_as) : Json(nullptr);
  json["contrast"] = seen.contrast ? Json{{"value", seen.contrast->value},
                                          {"low", seen.contrast->low},
                                          {"high", seen.contrast->high}}
                                   : Json(nullptr);
  return json;
}

Json moved_json(const std::optional<MovedPlace>& moved) {
  if (!moved) {
    return nullptr;
  }
  Json json = {{"shift_px", {moved->shift_px.x(), moved->shift_px.y()}},
               {"turn_deg", moved->turn_rad * kDegPerRad},
               {"scale", moved->scale},
               {"rest_px", moved->rest_px}};
  if (!moved->untold.isZero(0.0)) {
    json["untold"] = {moved->untold.x(), moved->untold.y()};
  }
  return json;
}

/// Median of a number that each pair may have.
std::optional<double> median_of(const Json& pairs, const char* key) {
  std::vector<double> values;
  for (const Json& pair : pairs) {
    if (pair[key].is_number()) {
      values.push_back(pair[key].get<double>());
    }
  }
  return values.empty() ? std::nullopt : std::optional(median(values));
}

/// Of pictures that fit better when they are turned: what they seem to be.
std::string turns_sentence(const Json& pairs) {
  std::size_t count = 0;
  std::string name;
  for (const Json& pair : pairs) {
    if (pair["better_turn"].is_object()) {
      const auto turn = pair["better_turn"]["name"].get<std::string>();
      name = count == 0 || name == turn ? turn : "mirrored or turned";
      ++count;
    }
  }
  if (count == 0) {
    return "";
  }
  return pairs.size() == 1
             ? fmt::format("The real picture seems to be {}. ", name)
             : fmt::format("{} of {} real pictures seem to be {}. ", count, pairs.size(), name);
}

/// " (or shift_x, which cannot be distinguished from it)", or nothing.
std::string group_text(const Json& cause) {
  std::vector<std::string> others;
  for (const Json& name : cause.value("group", Json::array())) {
    if (name != cause["name"]) {
      others.push_back(name.get<std::string>());
    }
  }
  return others.empty() ? ""
                        : fmt::format(" (or {}, which cannot be distinguished from it)",
                                      fmt::join(others, ", "));
}

/// Of a single pair: "; explained by k1 = 0.0194 +- 0.0004, gain = 1.2".
std::string causes_sentence(const Json& pairs) {
  if (pairs.size() != 1 || pairs[0]["causes"].empty()) {
    return "";
  }
  std::string text;
  for (const Json& cause : pairs[0]["causes"]) {
    const std::string unit = cause["unit"].get<std::string>();
    text += fmt::format("{}{} = {:.3g}{} +- {:.1g}{}",
                        text.empty() ? "; explained by " : ", ",
                        cause["name"].get<std::string>(),
                        cause["value"].get<double>(),
                        unit.empty() ? "" : " " + unit,
                        cause["sigma"].get<double>(),
                        group_text(cause));
  }
  return text;
}

std::string overlap_sentence(const Json& pairs) {
  std::string text;
  if (const auto iou = median_of(pairs, "iou")) {
    text += fmt::format("The silhouettes overlap by {:.2f} %", 100.0 * *iou);
  }
  if (const auto distance = median_of(pairs, "mean_distance_px")) {
    text += fmt::format(
        "{} edges lie {:.3f} px apart on average", text.empty() ? "The" : ", their", *distance);
  }
  return text.empty() ? "No edges were found in both pictures" : text;
}

/// How far the outlines agree.
void add_agreement(const PairGeometry& geometry, Json& json) {
  const bool has_edges = geometry.distance.points > 0;
  const auto if_edges = [&](double value) { return has_edges ? Json(value) : Json(nullptr); };
  json["iou"] = optional_json(geometry.iou);
  json["dice"] = optional_json(geometry.dice);
  json["mean_distance_px"] = if_edges(geometry.distance.mean_px);
  json["hd95_px"] = if_edges(geometry.distance.p95_px);
  json["offset_px"] = if_edges(geometry.distance.offset_px);
  json["ring_slope"] = slope_json(geometry.rings.radial_slope);
  json["tangential_slope"] = slope_json(geometry.rings.tangential_slope);
}

void add_appearance(const PairAppearance& look, Json& json) {
  json["ssim"] = look.ssim;
  json["histogram_distance"] = look.histogram_distance;
  json["exposure"] = {{"gain", look.exposure.gain}, {"offset", look.exposure.offset}};
  json["residual_rms"] = look.residual_rms;
  json["correlation"] = look.correlation;
  json["gmsd"] = look.gmsd;
}

/// Where the outlines come from, and what is off where.
void add_edges(const PairGeometry& geometry, Json& json) {
  json["outline"] = {{"simulated", name_of(geometry.outlines.simulated.method)},
                     {"real", name_of(geometry.outlines.real.method)},
                     {"points", geometry.distance.points},
                     {"share", geometry.distance.share}};
  json["rings"] = rings_json(geometry.rings);
  json["edges"] = edges_json(geometry.edges);
  json["unlisted_edges"] = {{"count", geometry.unlisted.count},
                            {"outline_share", geometry.unlisted.outline_share}};
}

}  // namespace

Json pair_json(const ComparedPair& pair, const PairCauses& causes) {
  Json json;
  json["simulated"] = pair.simulated.source.name;
  json["real"] = pair.real.source.name;
  add_agreement(pair.geometry, json);
  json["causes"] = causes_json(causes);
  if (causes.edges) {
    json["edge_misfit_px"] = {{"before", causes.edges->before_px},
                              {"after", causes.edges->after_px},
                              {"noise", causes.edges->noise_px}};
  }
  add_appearance(pair.appearance, json);
  add_edges(pair.geometry, json);
  json["regions"] = regions_json(pair.regions);
  json["texture"] = texture_pair_json(pair.appearance);
  json["better_turn"] = turn_json(pair.better_turn);
  json["notes"] = pair.notes;
  for (const std::string& note : causes.notes) {
    json["notes"].push_back(note);
  }
  return json;
}

Json inspection_json(const InspectedPair& pair) {
  Json result;
  const auto side = [&](const InspectedSide& inspected) {
    return Json{{"found", inspected.found},
                {"missed", inspected.missed},
                {"false_alarms", inspected.false_alarms}};
  };
  result["simulated"] = side(pair.simulated);
  result["real"] = side(pair.real);
  result["defects"] = Json::array();
  for (std::size_t i = 0; i < pair.known.size(); ++i) {
    Json& row = result["defects"].emplace_back();
    row["id"] = pair.known[i].id;
    row["label"] = pair.known[i].label;
    row["kind"] = pair.known[i].kind;
    row["simulated"] = seen_json(pair.simulated.defects[i]);
    row["real"] = seen_json(pair.real.defects[i]);
  }
  result["moved"] = moved_json(pair.moved);
  result["notes"] = pair.notes;
  return result;
}

Json yardstick_json(const std::optional<Yardstick>& yardstick) {
  if (!yardstick) {
    return nullptr;
  }
  Json rows = Json::array();
  for (const YardstickRow& row : yardstick->rows) {
    rows.push_back({{"name", row.name},
                    {"real", row.real},
                    {"real_quartiles", {row.real_low, row.real_high}},
                    {"simulated", row.simulated},
                    {"multiple", row.multiple}});
  }
  return {{"reals", yardstick->reals},
          {"pairs", yardstick->pairs},
          {"multiple", yardstick->multiple},
          {"low", yardstick->low},
          {"high", yardstick->high},
          {"window_px", yardstick->window_px},
          {"measures", rows}};
}

std::string compare_verdict(const Json& pairs, const std::optional<Yardstick>& yardstick) {
  std::string text = turns_sentence(pairs);
  if (yardstick && yardstick->multiple > 0.0) {
    text += fmt::format(
        "The simulation differs from the photographs {:.1f} times as much as they differ from each "
        "other",
        yardstick->multiple);
    text += yardstick->high > yardstick->low
                ? fmt::format(" ({:.1f} to {:.1f}). ", yardstick->low, yardstick->high)
                : std::string(". ");
  }
  text += overlap_sentence(pairs);
  if (const auto ssim = median_of(pairs, "ssim")) {
    text += fmt::format("; structural similarity {:.3f}", *ssim);
  }
  text += causes_sentence(pairs);
  return text + (pairs.size() > 1 ? fmt::format(" (medians of {} pairs).", pairs.size()) : ".");
}

}  // namespace glint

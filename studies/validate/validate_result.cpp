// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/validate_result.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/median.h"
#include "core/units.h"
#include "hardware/calibration/lens_vector.h"
#include "studies/validate/common_exposure.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;

Json optional_json(const std::optional<double>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json list_of(const Eigen::Vector3d& v, double per = 1.0) {
  return {per * v.x(), per * v.y(), per * v.z()};
}

Json motion_json(const Eigen::Matrix<double, 6, 1>& motion,
                 const Eigen::Matrix<double, 6, 1>& sigma) {
  const double degrees = 180.0 / kPi;
  return {{"turn_deg", list_of(motion.head<3>(), degrees)},
          {"turn_sigma_deg", list_of(sigma.head<3>(), degrees)},
          {"shift_mm", list_of(motion.tail<3>())},
          {"shift_sigma_mm", list_of(sigma.tail<3>())}};
}

std::optional<double> mean_before(const Json& before) {
  double sum = 0.0;
  double count = 0.0;
  for (const Json& row : before) {
    if (row["mean_distance_px"].is_number()) {
      sum += row["mean_distance_px"].get<double>();
      count += 1.0;
    }
  }
  return count > 0.0 ? std::optional(sum / count) : std::nullopt;
}

}  // namespace

Json estimated_json(const Estimate& estimate) {
  return {{"value", estimate.value}, {"low", estimate.low}, {"high", estimate.high}};
}

Json seen_json(const validate_detail::SeenContrasts& seen) {
  const auto share = [](int hits, int all) {
    return all > 0 ? estimated_json(wilson(hits, all)) : Json(nullptr);
  };
  return {{"defects", seen.defects},
          {"defects_simulated", seen.defects_simulated},
          {"defects_real", seen.defects_real},
          {"found_simulated", seen.found_simulated},
          {"found_real", seen.found_real},
          {"rate_simulated", share(seen.found_simulated, seen.defects_simulated)},
          {"rate_real", share(seen.found_real, seen.defects_real)},
          {"found_on_both", seen.found_both},
          {"same_class", seen.same_class},
          {"right_class_simulated", share(seen.right_simulated, seen.found_simulated)},
          {"right_class_real", share(seen.right_real, seen.found_real)},
          {"contrasts", seen.seen},
          {"contrasts_apart", seen.apart}};
}

Json overlap_json(const std::string& design, const std::string& view, const ComparedPair& pair) {
  const bool has_edges = pair.geometry.distance.points > 0;
  const RingOffsets& rings = pair.geometry.rings;
  Json row = {{"design", design}, {"view", view}};
  row["iou"] = optional_json(pair.geometry.iou);
  row["mean_distance_px"] = has_edges ? Json(pair.geometry.distance.mean_px) : Json(nullptr);
  row["hd95_px"] = has_edges ? Json(pair.geometry.distance.p95_px) : Json(nullptr);
  row["ring_slope"] = rings.radial_slope ? estimated_json(*rings.radial_slope) : Json(nullptr);
  return row;
}

Json edges_json(const ValidationFindings& findings, double limit_px, const Json& before) {
  const GeometryFit& fit = findings.geometry;
  Json json;
  json["before_calibration_px"] = optional_json(mean_before(before));
  json["mean_distance_px"] = optional_json(findings.distance_px);
  json["limit_px"] = limit_px;
  json["rms_px"] = fit.before_px;
  json["pose_px"] = fit.pose_px;
  json["pose_budget_px"] = fit.pose_budget_px;
  json["lens_px"] = fit.lens_px;
  json["lens_budget_px"] = fit.lens_budget_px;
  json["rest_px"] = fit.after_px;
  json["noise_px"] = fit.noise_px;
  json["blur_difference_px2"] = optional_json(findings.blur_px2);
  return json;
}

Json geometry_json(const GeometryFit& fit) {
  if (!fit.is_known) {
    return nullptr;
  }
  Json lens = Json::object();
  for (std::size_t i = 0; i < kLensSize; ++i) {
    const auto at = static_cast<Eigen::Index>(i);
    lens[std::string(kLensNames[i])] = {{"change", fit.lens[at]}, {"sigma", fit.sigma[at]}};
  }
  const auto names = [](const std::vector<GeometryFault>& faults) {
    Json list = Json::array();
    for (const GeometryFault fault : faults) {
      list.push_back(name_of(fault));
    }
    return list;
  };
  return {{"beyond_budget", names(fit.faults)},
          {"or", names(fit.or_these)},
          {"lens", lens},
          {"hand_eye", motion_json(fit.hand_eye, fit.sigma.segment<6>(9))},
          {"part", motion_json(fit.part, fit.sigma.segment<6>(15))}};
}

Json grey_json(const ValidationFindings& findings) {
  Json list = Json::array();
  for (const DesignGrey& grey : findings.grey) {
    Json row = {{"design", grey.design}};
    row["before_share"] = grey.fit.is_known ? Json(grey.fit.before) : Json(nullptr);
    const bool is_fitted = grey.fit.is_known && !grey.fit.is_exposure_only;
    row["exposed_share"] = is_fitted ? Json(grey.fit.exposed) : Json(nullptr);
    row["after_share"] = is_fitted ? Json(grey.fit.after) : Json(nullptr);
    row["limit_share"] = findings.limits.grey_share;
    const bool is_bounded = grey.fit.is_known && std::isfinite(grey.fit.rounding);
    row["rounding_share"] = is_bounded ? Json(grey.fit.rounding) : Json(nullptr);
    row["values"] = Json::array();
    for (const GreyValue& value : grey.fit.values) {
      Json number = {{"name", name_of(value.fault)}};
      number["light"] = value.light.empty() ? Json(nullptr) : Json(value.light);
      number["index"] = value.index;
      number["value"] = value.value;
      number["sigma"] = value.sigma;
      row["values"].push_back(std::move(number));
    }
    list.push_back(std::move(row));
  }
  return list;
}

Json texture_json(const ValidationFindings& findings) {
  return {{"spectrum_log10", optional_json(findings.texture)}, {"limit", findings.limits.texture}};
}

namespace {

Json ranking_json(const Ranking& ranking) {
  Json pairs = Json::array();
  for (const RankedPair& pair : ranking.pairs) {
    pairs.push_back({{"first", pair.first},
                     {"second", pair.second},
                     {"simulated", estimated_json(pair.simulated)},
                     {"real", estimated_json(pair.real)},
                     {"level", pair.is_level},
                     {"against", pair.is_against}});
  }
  return {{"simulated", ranking.simulated},
          {"real", ranking.real},
          {"agrees", ranking.agrees},
          {"pairs", pairs}};
}

}  // namespace

Json rankings_json(const std::vector<ObjectiveRanking>& rankings) {
  Json list = Json::array();
  for (const ObjectiveRanking& by : rankings) {
    Json row = {{"objective", by.objective}, {"is_maximised", by.is_maximised}};
    row["ranking"] = by.ranking ? ranking_json(*by.ranking) : Json(nullptr);
    row["reason"] = by.ranking ? Json(nullptr) : Json(by.reason);
    list.push_back(std::move(row));
  }
  return list;
}

Json change_json(const SceneChange& change) {
  Json lights = Json::array();
  for (const LightChange& light : change.lights) {
    lights.push_back({{"name", light.name},
                      {"moved_mm", list_of(light.moved_mm)},
                      {"segment_power", light.segment_power}});
  }
  return {{"exposure", change.exposure},
          {"roughness", change.roughness},
          {"blur_px2", change.blur_px2},
          {"lights", lights}};
}

namespace {

/// A score's values in the views, and the rendering's standard error of the last one.
struct SideValues {
  std::vector<double> values;
  std::optional<double> error;
};

/// With 95 %: of the mean over the views; of one view by its rendering, where that has noise.
Json side_json(const SideValues& side) {
  constexpr double kNormal95 = 1.96;
  const double value = side.values.front();
  if (side.values.size() > 1) {
    Json json = estimated_json(mean_of(side.values));
    json["interval"] = "views";
    return json;
  }
  if (side.error) {
    const double reach = kNormal95 * *side.error;
    return {{"value", value},
            {"low", value - reach},
            {"high", value + reach},
            {"interval", "rendering"}};
  }
  return {{"value", value}, {"low", nullptr}, {"high", nullptr}, {"interval", "one view: none"}};
}

}  // namespace

Json both_scores_json(const std::vector<BothScores>& views) {
  std::map<std::string, std::pair<SideValues, SideValues>> scores;
  for (const BothScores& both : views) {
    for (const auto& [name, value] : both.simulated) {
      if (const auto real = both.real.find(name); real != both.real.end()) {
        auto& [simulated_side, real_side] = scores[name];
        simulated_side.values.push_back(value);
        real_side.values.push_back(real->second);
        if (const auto error = both.simulated.find(name + ".error");
            error != both.simulated.end()) {
          simulated_side.error = error->second;
        }
      }
    }
  }
  Json json = Json::object();
  for (const auto& [name, sides] : scores) {
    json[name] = {{"simulated", side_json(sides.first)}, {"real", side_json(sides.second)}};
  }
  return json;
}

SceneChange common_change(const ValidationFindings& findings) {
  SceneChange change = {.blur_px2 = findings.blur_px2.value_or(0.0)};
  std::vector<double> roughness;
  for (const DesignGrey& grey : findings.grey) {
    if (!grey.fit.is_known) {
      continue;
    }
    if (!grey.fit.is_exposure_only) {
      roughness.push_back(grey.fit.change.roughness);
    }
    for (const LightChange& light : grey.fit.change.lights) {
      if (std::ranges::find(change.lights, light.name, &LightChange::name) == change.lights.end()) {
        change.lights.push_back(light);
      }
    }
  }
  if (const GreyFit* cell = validate_detail::common_fit(findings.grey)) {
    change.exposure = cell->change.exposure;
    change.roughness = roughness.empty() ? 1.0 : median(roughness);
  }
  return change;
}

namespace {

using validate_detail::kMinBlurPx;
using validate_detail::kMinExposure;
using validate_detail::kMinLightMm;
using validate_detail::kMinPower;
using validate_detail::kMinRoughness;

constexpr std::array<const char*, 3> kPlaceAxes = {"x_mm", "y_mm", "z_mm"};

double matters_of(GreyFault fault) {
  switch (fault) {
    case GreyFault::kExposure:
      return kMinExposure;
    case GreyFault::kLightPower:
    case GreyFault::kSegments:
      return kMinPower;
    case GreyFault::kLightPlace:
      return kMinLightMm;
    case GreyFault::kRoughness:
      break;
  }
  return kMinRoughness;
}

class UndeterminedSearch {
 public:
  void look_at(const GreyFit& fit) {
    for (const std::vector<GreyValue>* values : {&fit.values, &fit.kept}) {
      for (const GreyValue& value : *values) {
        look_at(value);
      }
    }
  }

  void look_at(Undetermined number) {
    if (number.sigma && *number.sigma <= number.matters) {
      return;
    }
    const auto same = std::ranges::find_if(found_, [&number](const Undetermined& other) {
      return other.name == number.name && other.of == number.of && other.value == number.value;
    });
    if (same == found_.end()) {
      found_.push_back(std::move(number));
    } else if (same->sigma && number.sigma) {
      same->sigma = std::max(*same->sigma, *number.sigma);
    }
  }

  std::vector<Undetermined> found() { return std::move(found_); }

 private:
  void look_at(const GreyValue& value) {
    const bool is_place = value.fault == GreyFault::kLightPlace;
    const bool is_known = std::isfinite(value.sigma);
    look_at({.name = name_of(value.fault),
             .of = value.light,
             .value = is_place ? kPlaceAxes.at(static_cast<std::size_t>(value.index)) : "factor",
             .sigma = is_known ? std::optional(value.sigma) : std::nullopt,
             .matters = matters_of(value.fault)});
  }

  std::vector<Undetermined> found_;
};

void look_at_part(const ValidationFindings& findings, UndeterminedSearch& search) {
  const GeometryFit& fit = findings.geometry;
  const Eigen::Matrix<double, 6, 1> sigma =
      fit.is_known ? Eigen::Matrix<double, 6, 1>(fit.sigma.segment<6>(15)) : findings.part_sigma;
  search.look_at({.name = "part_pose",
                  .of = "",
                  .value = "turned_deg",
                  .sigma = sigma.head<3>().norm() * kDegPerRad,
                  .matters = findings.limits.pose_rad * kDegPerRad});
  search.look_at({.name = "part_pose",
                  .of = "",
                  .value = "moved_mm",
                  .sigma = sigma.tail<3>().norm(),
                  .matters = findings.limits.pose_mm});
}

std::string undetermined_text(const Undetermined& number) {
  std::string name = number.name;
  std::ranges::replace(name, '_', ' ');
  const std::string sigma =
      number.sigma ? fmt::format("known to {:.3g} (one standard deviation)", *number.sigma)
                   : "the pictures say nothing of it";
  return fmt::format("{}{}, {}: undetermined, {}; {:.3g} would matter",
                     name,
                     number.of.empty() ? "" : " of " + number.of,
                     number.value,
                     sigma,
                     number.matters);
}

}  // namespace

std::vector<Undetermined> undetermined_of(const ValidationFindings& findings) {
  UndeterminedSearch search;
  for (const DesignGrey& grey : findings.grey) {
    if (grey.fit.is_known) {
      search.look_at(grey.fit);
    } else {
      search.look_at({.name = "light_power",
                      .of = grey.design,
                      .value = "factor",
                      .sigma = std::nullopt,
                      .matters = kMinPower});
    }
  }
  look_at_part(findings, search);
  if (!findings.blur_px2) {
    search.look_at({.name = "blur",
                    .of = "",
                    .value = "added_px",
                    .sigma = std::nullopt,
                    .matters = kMinBlurPx});
  }
  return search.found();
}

Json undetermined_json(const std::vector<Undetermined>& numbers) {
  Json list = Json::array();
  for (const Undetermined& number : numbers) {
    Json row = {{"name", number.name}};
    row["of"] = number.of.empty() ? Json(nullptr) : Json(number.of);
    row["value"] = number.value;
    row["sigma"] = number.sigma ? Json(*number.sigma) : Json(nullptr);
    row["matters"] = number.matters;
    row["text"] = undetermined_text(number);
    list.push_back(std::move(row));
  }
  return list;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/validate_verdict.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/text.h"
#include "core/units.h"
#include "studies/validate/common_exposure.h"

namespace glint {
namespace {

using Json = nlohmann::ordered_json;
using validate_detail::kMinBlurPx;
using validate_detail::kMinExposure;
using validate_detail::kMinLightMm;
using validate_detail::kMinPower;
using validate_detail::kMinRoughness;
using validate_detail::kSigmas;

constexpr double kBudgetSigmas = 3.0;  ///< of what calibration and placement predict
constexpr double kDeadPower = 0.3;     ///< a segment below that is called dead

double degrees(double rad) {
  return rad * 180.0 / kPi;
}

class Judge {
 public:
  explicit Judge(const ValidationFindings& findings) : f_(findings) {}

  ValidateVerdict judge() {
    const GeometryFit& fit = f_.geometry;
    verdict_.edge_limit_px = std::max(
        f_.limits.edge_px, kBudgetSigmas * std::hypot(fit.pose_budget_px, fit.lens_budget_px));
    judge_edges();
    judge_grey();
    judge_blur();
    note_not_judged();
    std::ranges::stable_sort(verdict_.faults, {}, &ToldFault::is_within);
    decide();
    advise();
    tell();
    return std::move(verdict_);
  }

 private:
  static FaultValue norm_of(const char* name,
                            const Eigen::Vector3d& value,
                            const Eigen::Vector3d& sigma,
                            double per) {
    return {.name = name, .value = per * value.norm(), .sigma = per * sigma.norm()};
  }

  ToldFault motion(const std::string& name,
                   const Eigen::Matrix<double, 6, 1>& motion,
                   Eigen::Index first) const {
    const auto& sigma = f_.geometry.sigma;
    return {.name = name,
            .of = "",
            .values = {norm_of("turned_deg", motion.head<3>(), sigma.segment<3>(first), degrees(1)),
                       norm_of("moved_mm", motion.tail<3>(), sigma.segment<3>(first + 3), 1.0)}};
  }

  ToldFault edge_fault(GeometryFault fault) const {
    const GeometryFit& fit = f_.geometry;
    if (fault == GeometryFault::kPartPose) {
      ToldFault told = motion("part_pose", fit.part, 15);
      told.is_within = fit.part.head<3>().norm() <= f_.limits.pose_rad &&
                       fit.part.tail<3>().norm() <= f_.limits.pose_mm &&
                       fit.after_px <= verdict_.edge_limit_px;
      return told;
    }
    if (fault == GeometryFault::kHandEye) {
      return motion("hand_eye", fit.hand_eye, 9);
    }
    ToldFault told = {.name = "lens", .of = name_of(fault), .values = {}};
    constexpr std::array<const char*, 9> kNames = {
        "fx_px", "fy_px", "cx_px", "cy_px", "k1", "k2", "k3", "p1", "p2"};
    const auto first = fault == GeometryFault::kFocalLength ? 0
                       : fault == GeometryFault::kCentre    ? 2
                                                            : 4;
    const auto last = fault == GeometryFault::kDistortion ? 9 : first + 2;
    for (int i = first; i < last; ++i) {
      told.values.push_back({.name = kNames[static_cast<std::size_t>(i)],
                             .value = fit.lens[i],
                             .sigma = fit.sigma[i]});
    }
    return told;
  }

  bool are_edges_apart() const {
    return f_.distance_px && *f_.distance_px > verdict_.edge_limit_px;
  }

  /// Beyond what a refit sets right, and beyond noise. A flat part that is tilted hardly moves its
  /// edges, and shines differently.
  bool is_part_moved() const {
    const GeometryFit& fit = f_.geometry;
    const auto is_beyond = [&](Eigen::Index first, double limit) {
      return fit.part.segment<3>(first).norm() - kSigmas * fit.sigma.segment<3>(15 + first).norm() >
             limit;
    };
    return is_beyond(0, f_.limits.pose_rad) || is_beyond(3, f_.limits.pose_mm);
  }

  void judge_edges() {
    const GeometryFit& fit = f_.geometry;
    for (const GeometryFault fault : fit.faults) {
      if (!are_edges_apart() && !(fault == GeometryFault::kPartPose && is_part_moved())) {
        continue;
      }
      ToldFault told = edge_fault(fault);
      for (const GeometryFault other : fit.or_these) {
        told.or_these.push_back(name_of(other));
      }
      verdict_.faults.push_back(std::move(told));
    }
    if (fit.faults.empty() && are_edges_apart()) {
      verdict_.faults.push_back({.name = "edges",
                                 .of = "",
                                 .values = {{.name = "distance_px", .value = *f_.distance_px}}});
    }
  }

  /// Of each design what its pictures ask for.
  void judge_grey() {
    for (const DesignGrey& grey : f_.grey) {
      if (grey.fit.is_known) {
        judge_design(grey);
      }
    }
    judge_exposure();
  }

  void judge_design(const DesignGrey& grey) {
    if (grey.fit.exposed <= f_.limits.grey_share) {
      return;
    }
    std::map<std::string, Eigen::Vector3d> places;
    std::map<std::string, Eigen::Vector3d> sigmas;
    for (const GreyValue& value : grey.fit.values) {
      if (value.fault == GreyFault::kSegments) {
        add_segment(value);
      } else if (value.fault == GreyFault::kRoughness) {
        add_roughness(value);
      } else if (value.fault == GreyFault::kLightPlace) {
        places.try_emplace(value.light, Eigen::Vector3d::Zero()).first->second[value.index] =
            value.value;
        sigmas.try_emplace(value.light, Eigen::Vector3d::Zero()).first->second[value.index] =
            value.sigma;
      }
    }
    for (const auto& [light, place] : places) {
      add_place(light, place, sigmas.at(light));
    }
    if (grey.fit.after > f_.limits.grey_share) {
      verdict_.faults.push_back({.name = "grey",
                                 .of = grey.design,
                                 .values = {{.name = "rest_share", .value = grey.fit.after}}});
    }
  }

  /// Of the same light in several designs once.
  void add(ToldFault fault) {
    const auto same = std::ranges::find_if(verdict_.faults, [&](const ToldFault& other) {
      return other.name == fault.name && other.of == fault.of;
    });
    if (same == verdict_.faults.end()) {
      verdict_.faults.push_back(std::move(fault));
    } else {
      same->is_within = same->is_within && fault.is_within;
    }
  }

  void add_segment(const GreyValue& value) {
    const double change = std::abs(value.value - 1.0);
    if (change < std::max(kMinPower, kSigmas * value.sigma)) {
      return;
    }
    add({.name = value.value < kDeadPower ? "dead_segment" : "segment_power",
         .of = fmt::format("{}, segment {}", value.light, value.index + 1),
         .values = {{.name = "factor", .value = value.value, .sigma = value.sigma}},
         .is_within = change <= f_.limits.power_share});
  }

  void add_roughness(const GreyValue& value) {
    const double change = std::abs(value.value - 1.0);
    if (change >= std::max(kMinRoughness, kSigmas * value.sigma)) {
      add({.name = "roughness",
           .of = "",
           .values = {{.name = "factor", .value = value.value, .sigma = value.sigma}},
           .is_within = change <= f_.limits.roughness_share});
    }
  }

  void add_place(const std::string& light,
                 const Eigen::Vector3d& place,
                 const Eigen::Vector3d& sigma) {
    if (place.norm() < std::max(kMinLightMm, kSigmas * sigma.norm())) {
      return;
    }
    ToldFault fault = {.name = "light_place",
                       .of = light,
                       .values = {norm_of("moved_mm", place, sigma, 1.0)},
                       .is_within = place.norm() <= f_.limits.light_mm};
    constexpr std::array<const char*, 3> kAxes = {"x_mm", "y_mm", "z_mm"};
    for (Eigen::Index i = 0; i < 3; ++i) {
      fault.values.push_back(
          {.name = kAxes[static_cast<std::size_t>(i)], .value = place[i], .sigma = sigma[i]});
    }
    add(std::move(fault));
  }

  /// What all designs share is the exposure; a design that has another gain has another power.
  void judge_exposure() {
    const GreyFit* cell = validate_detail::common_fit(f_.grey);
    if (cell == nullptr) {
      return;
    }
    const double common = cell->change.exposure;
    const double sigma = sigma_of_exposure(*cell);
    if (std::abs(common - 1.0) > std::max(kMinExposure + cell->rounding, kSigmas * sigma)) {
      add({.name = "exposure",
           .of = "",
           .values = {{.name = "factor", .value = common, .sigma = sigma}},
           .is_within = std::abs(common - 1.0) <= f_.limits.exposure_share});
    }
    for (const DesignGrey& grey : f_.grey) {
      if (grey.fit.is_known && validate_detail::has_other_power(grey.fit, *cell)) {
        const double ratio = grey.fit.change.exposure / common;
        add({.name = "light_power",
             .of = grey.design,
             .values = {{.name = "factor",
                         .value = ratio,
                         .sigma = validate_detail::sigma_of_power(grey.fit, *cell)}},
             .is_within = std::abs(ratio - 1.0) <= f_.limits.exposure_share});
      }
    }
  }

  void note_not_judged() {
    for (const DesignGrey& grey : f_.grey) {
      if (!grey.fit.is_known) {
        unknown_.push_back(grey.design);
      } else if (grey.fit.is_thin) {
        thin_.push_back(grey.design);
        verdict_.notes.push_back(fmt::format(
            "{}: most of its part is thinner than three pixels of the pictures that grey values "
            "are compared in: powers of segments and where its light stands are {} there",
            grey.design,
            grey.fit.is_exposure_only ? "not looked at" : "hardly seen"));
      } else if (grey.fit.is_exposure_only) {
        verdict_.notes.push_back(fmt::format(
            "{}: its light is not path traced: of its grey values one exposure alone is fitted, "
            "powers of its segments and where it stands are not looked at",
            grey.design));
      }
      if (validate_detail::is_rounded_away(grey.fit)) {
        rounded_.push_back(grey.design);
        verdict_.notes.push_back(fmt::format(
            "{}: its grey values cannot be judged: as designed it is so dark that rounding to the "
            "camera's steps may change its exposure by more than {:.0f} %; whether its lights have "
            "the right power is not known",
            grey.design,
            100.0 * kMaxRounding));
      }
    }
  }

  void judge_blur() {
    if (!f_.blur_px2) {
      return;
    }
    const double blur = std::sqrt(std::abs(*f_.blur_px2));
    if (blur > kMinBlurPx) {
      add({.name = "blur",
           .of = "",
           .values = {{.name = *f_.blur_px2 > 0.0 ? "added_px" : "removed_px", .value = blur}},
           .is_within = blur <= f_.limits.blur_px});
    }
  }

  bool is_grey_apart() const {
    return std::ranges::any_of(f_.grey, [&](const DesignGrey& grey) {
      return grey.fit.is_known && grey.fit.before > f_.limits.grey_share;
    });
  }

  void decide() {
    const bool has_fault =
        std::ranges::any_of(verdict_.faults, [](const ToldFault& f) { return !f.is_within; });
    const bool is_order_wrong = std::ranges::any_of(
        f_.rankings, [](const auto& by) { return by.ranking && !by.ranking->agrees; });
    const bool is_blur_apart = f_.blur_px2 && std::sqrt(std::abs(*f_.blur_px2)) > f_.limits.blur_px;
    const bool is_apart = is_grey_apart() || is_blur_apart || are_edges_apart();
    verdict_.agreement = has_fault || is_order_wrong ? SidesAgreement::kDisagrees
                         : is_apart                  ? SidesAgreement::kAfterRefit
                                                     : SidesAgreement::kAgrees;
  }

  void advise() {
    std::set<std::string> names;
    for (const ToldFault& fault : verdict_.faults) {
      if (fault.is_within || !names.insert(fault.name).second) {
        continue;
      }
      if (fault.name == "lens" || fault.name == "hand_eye") {
        verdict_.advice.emplace_back(
            "Calibrate the camera again (glint calibrate); look whether the lens, its focus or its "
            "aperture have been touched.");
      } else if (fault.name == "part_pose") {
        verdict_.advice.emplace_back("Measure the part's place again, or look how it is clamped.");
      } else if (fault.name == "light_place") {
        verdict_.advice.push_back(
            fmt::format("Put the light {} where the design has it, or its measured place into the "
                        "design.",
                        fault.of));
      } else if (fault.name == "dead_segment" || fault.name == "segment_power") {
        verdict_.advice.push_back(fmt::format("Look at the light {}.", fault.of));
      } else if (fault.name == "exposure") {
        verdict_.advice.emplace_back("Set the exposure again, or calibrate the sensor.");
      } else {
        verdict_.advice.push_back(fmt::format("Look into {}.", fault.name));
      }
    }
    if (verdict_.advice.empty() && verdict_.agreement == SidesAgreement::kAfterRefit) {
      verdict_.advice.emplace_back(
          "Nothing needs to be recalibrated: take the refit scene, or write the measured values "
          "into the study.");
    }
  }

  static std::string values_text(const ToldFault& fault) {
    std::string text;
    for (std::size_t i = 0; i < std::min<std::size_t>(2, fault.values.size()); ++i) {
      const FaultValue& value = fault.values[i];
      text += fmt::format("{}{} {:.3g}", i == 0 ? " (" : ", ", value.name, value.value);
    }
    return text.empty() ? text : text + ")";
  }

  std::string faults_text(bool is_within) const {
    std::vector<std::string> list;
    for (const ToldFault& fault : verdict_.faults) {
      if (fault.is_within == is_within) {
        std::string name = fault.name;
        std::ranges::replace(name, '_', ' ');
        list.push_back(name + (fault.of.empty() ? "" : " of " + fault.of) + values_text(fault));
      }
    }
    return join(list, "; ");
  }

  void tell() {
    std::string& text = verdict_.sentence;
    switch (verdict_.agreement) {
      case SidesAgreement::kAgrees:
        text = "Simulation and reality agree";
        text += f_.distance_px ? fmt::format(": edges lie {:.2f} px apart.", *f_.distance_px) : ".";
        break;
      case SidesAgreement::kAfterRefit:
        text = "Simulation and reality agree after a refit";
        text += faults_text(true).empty() ? "." : " of " + faults_text(true) + ".";
        break;
      case SidesAgreement::kDisagrees:
        text = "Simulation and reality do not agree";
        text += faults_text(false).empty() ? "." : ": " + faults_text(false) + ".";
        break;
    }
    if (!rounded_.empty()) {
      text += fmt::format(" Grey values of {} are too dark to be judged.", join(rounded_, ", "));
    }
    if (!unknown_.empty()) {
      text += fmt::format(" Grey values of {} could not be compared.", join(unknown_, ", "));
    }
    if (!thin_.empty()) {
      text += fmt::format(" Grey values of {} tell little but the exposure: the part is thin.",
                          join(thin_, ", "));
    }
    text += rankings_text(f_.rankings, verdict_.agreement != SidesAgreement::kDisagrees);
    if (f_.contrasts_apart > 0) {
      text += fmt::format(" Contrasts of {} of {} defects differ by more than {:.0f} %.",
                          f_.contrasts_apart,
                          f_.contrasts,
                          100.0 * f_.limits.contrast_share);
    }
  }

  const ValidationFindings& f_;
  ValidateVerdict verdict_;
  std::vector<std::string> rounded_;  ///< designs whose grey values cannot be judged
  std::vector<std::string> thin_;     ///< designs whose part is too thin for even differences
  std::vector<std::string> unknown_;  ///< designs that have none to compare
};

}  // namespace

std::string name_of(SidesAgreement agreement) {
  switch (agreement) {
    case SidesAgreement::kAgrees:
      return "agrees";
    case SidesAgreement::kAfterRefit:
      return "agrees_after_refit";
    case SidesAgreement::kDisagrees:
      break;
  }
  return "does_not_agree";
}

ValidateVerdict judge(const ValidationFindings& findings) {
  return Judge(findings).judge();
}

Json verdict_json(const ValidateVerdict& verdict) {
  Json faults = Json::array();
  for (const ToldFault& fault : verdict.faults) {
    Json values = Json::object();
    for (const FaultValue& value : fault.values) {
      values[value.name] = {{"value", value.value}, {"sigma", value.sigma}};
    }
    Json row = {{"name", fault.name}};
    row["of"] = fault.of.empty() ? Json(nullptr) : Json(fault.of);
    row["values"] = values;
    row["within_tolerance"] = fault.is_within;
    row["or"] = fault.or_these;
    faults.push_back(std::move(row));
  }
  return {{"agreement", name_of(verdict.agreement)},
          {"sentence", verdict.sentence},
          {"causes", faults},
          {"advice", verdict.advice},
          {"edge_limit_px", verdict.edge_limit_px}};
}

}  // namespace glint

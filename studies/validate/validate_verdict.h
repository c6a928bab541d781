// SPDX-License-Identifier: GPL-3.0-or-later
//
// Whether simulation and reality agree, and what to do about it. The rules: docs/validate.md.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "studies/definition/cell_settings.h"
#include "studies/validate/geometry_fit.h"
#include "studies/validate/grey_fit.h"
#include "studies/validate/ranking.h"

namespace glint {

/// A number of a cause.
struct FaultValue {
  std::string name;  ///< "moved_mm", "turned_deg", "factor"
  double value = 0.0;
  double sigma = 0.0;
};

/// What differs between simulation and reality.
struct ToldFault {
  std::string name;  ///< "part_pose", "lens", "hand_eye", "light_place", "dead_segment",
                     ///< "segment_power", "exposure", "light_power", "roughness", "blur", "edges",
                     ///< "grey"
  std::string of;    ///< the light or the numbers of the lens; empty: of the whole cell
  std::vector<FaultValue> values;
  bool is_within = false;                  ///< a refit may set it right
  std::vector<std::string> or_these = {};  ///< would explain the edges nearly as well
};

/// Grey values of one design.
struct DesignGrey {
  std::string design;
  GreyFit fit;
};

/// All that was measured.
struct ValidationFindings {
  ValidateSettings limits;
  std::optional<double> distance_px;  ///< of edges, mean over the pictures; empty: none were found
  GeometryFit geometry;
  /// Of the part before its edges are looked at: GeometryBudget::part_sigma.
  Eigen::Matrix<double, 6, 1> part_sigma = Eigen::Matrix<double, 6, 1>::Zero();
  std::vector<DesignGrey> grey;
  std::optional<double> texture;   ///< log10 of the ratio of spectra, median over the pictures
  std::optional<double> blur_px2;  ///< real minus simulated square of the edges' blur, median
  int contrasts = 0;               ///< defects seen on both sides
  int contrasts_apart = 0;         ///< of these beyond the limit and their intervals
  std::vector<ObjectiveRanking> rankings;
};

enum class SidesAgreement { kAgrees, kAfterRefit, kDisagrees };

/// "agrees", "agrees_after_refit", "does_not_agree".
std::string name_of(SidesAgreement agreement);

struct ValidateVerdict {
  SidesAgreement agreement = SidesAgreement::kAgrees;
  std::string sentence;
  std::vector<ToldFault> faults;    ///< those that no refit sets right first
  std::vector<std::string> advice;  ///< what to recalibrate
  std::vector<std::string> notes;   ///< designs that cannot be judged, and why
  double edge_limit_px = 0.0;       ///< up to which edges agree
};

ValidateVerdict judge(const ValidationFindings& findings);

nlohmann::ordered_json verdict_json(const ValidateVerdict& verdict);

}  // namespace glint

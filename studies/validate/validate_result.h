// SPDX-License-Identifier: GPL-3.0-or-later
//
// Parts of a validation as JSON (docs/validate.md). Private to the room.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "studies/compare/compared_pair.h"
#include "studies/validate/both_scores.h"
#include "studies/validate/compared_view.h"
#include "studies/validate/validate_verdict.h"

namespace glint {

nlohmann::ordered_json estimated_json(const Estimate& estimate);

/// Defects of a design: how many each side found and told the right class of, with Wilson's 95 %.
nlohmann::ordered_json seen_json(const validate_detail::SeenContrasts& seen);

/// How far silhouettes and edges of a pair are apart.
nlohmann::ordered_json overlap_json(const std::string& design,
                                    const std::string& view,
                                    const ComparedPair& pair);

/// @param before  a list of overlap_json()
nlohmann::ordered_json edges_json(const ValidationFindings& findings,
                                  double limit_px,
                                  const nlohmann::ordered_json& before);
nlohmann::ordered_json geometry_json(const GeometryFit& fit);
nlohmann::ordered_json grey_json(const ValidationFindings& findings);
nlohmann::ordered_json texture_json(const ValidationFindings& findings);
nlohmann::ordered_json rankings_json(const std::vector<ObjectiveRanking>& rankings);
nlohmann::ordered_json change_json(const SceneChange& change);

/// Means over the views of scores that both sides have: { name: { simulated, real } }. Each has
/// value, low, high and what the interval is of: "views", of one view "rendering", or none.
nlohmann::ordered_json both_scores_json(const std::vector<BothScores>& views);

/// What holds for all designs: the median exposure and roughness, each light as its own design
/// found it, the blur.
SceneChange common_change(const ValidationFindings& findings);

/// A number of a refit that the pictures do not tell well enough: what they do not show may still
/// be wrong.
struct Undetermined {
  std::string name;             ///< as causes are named
  std::string of;               ///< the light or design; empty: of the whole cell
  std::string value;            ///< "x_mm", "factor", "moved_mm" ...
  std::optional<double> sigma;  ///< none: the pictures tell nothing of it
  double matters = 0.0;         ///< the smallest change that is told as a cause
};

/// Those whose standard deviation is larger than what matters; of the part the one that is known
/// beforehand, where its edges tell nothing.
std::vector<Undetermined> undetermined_of(const ValidationFindings& findings);

/// With a "text" for people.
nlohmann::ordered_json undetermined_json(const std::vector<Undetermined>& numbers);

}  // namespace glint

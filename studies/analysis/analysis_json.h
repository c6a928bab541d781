// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "studies/analysis/score_model.h"

namespace glint {

/// One entry of the `scores` of analyse_run(). @param space  that was analysed
nlohmann::ordered_json analysis_json(const SearchSpace& space, const ScoreAnalysis& analysis);

}  // namespace glint

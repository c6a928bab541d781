// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a run says of its many parts.
#pragma once

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// The verdict of a report with what is said of the parts before it: they make the headline, what
/// is said of the designs follows. Bad where that is bad, else neutral.
/// @param verdict  of the designs; comes back as it is without a population
/// @param result   result.json of the run
nlohmann::ordered_json with_population_verdict(const nlohmann::ordered_json& verdict,
                                               const nlohmann::ordered_json& result);

}  // namespace glint

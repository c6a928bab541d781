// SPDX-License-Identifier: GPL-3.0-or-later
//
// Designs in the order of the objective, with what noise makes of that order. Private to the
// module.
#pragma once

#include <nlohmann/json.hpp>

namespace glint::report_detail {

/// The designs of the data that have a value of the objective, the best first and those that miss a
/// limit last.
///
/// Where all were scored repeatedly with the same noise (common random numbers), `value` is the
/// mean of these scans with Student's 95 % interval `low` to `high`, and `probability_best` the
/// share of samples of the means in which the design is the best of those that meet every limit, or
/// of all where none does; designs that are level share it. Samples: a bootstrap of the scans, the
/// same for all designs, its deviations widened to Student's distribution. Else `value` is one
/// scan's.
///
/// @return [ { key, title, value, low?, high?, probability_best?, missed: [ texts ] } ]; empty
///         without an objective
nlohmann::ordered_json ranking_of(const nlohmann::ordered_json& data);

}  // namespace glint::report_detail

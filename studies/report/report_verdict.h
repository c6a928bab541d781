// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// The verdict of a report, `{ sentence, tone, details, findings: [ { code, text } ] }`, from data
/// as described in studies/report/report.h with its `score_info`. Fresh-seed numbers count where
/// there are any, and an outcome that is worse than the baseline is said to be worse. `findings`
/// holds every sentence with its code: those of `sentence` first, then those of `details`.
///
///   winner_better, winner_level, winner_worse   a search's outcome against the baseline
///   winner_alone        the same without a baseline
///   lead_sure, lead_open                        whether its lead over the baseline and over the
///                       best prototype is larger than the noise
///   prototype_better    a prototype that meets the limits is ahead of the outcome
///   compromise          several objectives: what the chosen design reaches, and why it was chosen
///   limits_met          of the design the verdict is about
///   limit_failed        one for each limit that a design misses
///   limits_unlikely     under noise: that design keeps the limits with a probability below a half
///   no_feasible         a search without a design that meets every limit
///   all_failed          no evaluation succeeded
///   ranked              designs without a search, in the order of the objective
///   ranking_sure, ranking_open                  whether that order is larger than the noise
///   one_design, rendered, nothing_yet
///   runs_ranked, runs_infeasible, runs_apart, runs_differ   a comparison of runs
///   rescored, interrupted, budget, limit_rate   how the search went
///
/// and those of report_findings.h, report_front.h and report_kinds.h in studies/report.
nlohmann::ordered_json report_verdict(const nlohmann::ordered_json& data);

/// Reading of report data, in which any field may be absent or null.
namespace report_detail {

/// The named member; null when there is none or this is no object.
const nlohmann::ordered_json& member(const nlohmann::ordered_json& object, const char* name);

/// The named text, empty when there is none.
std::string text_of(const nlohmann::ordered_json& object, const char* name);

/// The named number when it is there and finite.
std::optional<double> number_of(const nlohmann::ordered_json& object, const std::string& name);

}  // namespace report_detail
}  // namespace glint

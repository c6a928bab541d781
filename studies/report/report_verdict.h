// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace glint {

/// The verdict of a report, `{ sentence, tone, details }`, from data as described in
/// studies/report/report.h with its `score_info`. Fresh-seed numbers count where there are any, and
/// an outcome that is worse than the baseline is said to be worse.
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

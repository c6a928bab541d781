// SPDX-License-Identifier: GPL-3.0-or-later
//
// The verdict on designs of which none was searched for. Private to the module.
#pragma once

#include <nlohmann/json.hpp>

#include "studies/report/verdict_parts.h"

namespace glint::report_detail {

/// A render, or designs beside each other without a search.
Verdict verdict_of_designs(const nlohmann::ordered_json& data, const Wording& wording);

}  // namespace glint::report_detail

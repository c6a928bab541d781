// SPDX-License-Identifier: GPL-3.0-or-later
//
// Figures of populations as texts. Private to the module.
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace glint::population_detail {

/// "90.0 % (60.0 to 98.0 %)". @param estimate  value, low, high
std::string share_text(const nlohmann::ordered_json& estimate);

/// "0.0200 (0 to 0.0500)": of false alarms a part.
std::string rate_text(const nlohmann::ordered_json& alarms);

/// Of those that were tried under a lighting.
double largest_size(const nlohmann::ordered_json& design);

/// "-" for no size, "> 30.0" for one beyond the largest that was tried: a curve says little there.
std::string size_text(const nlohmann::ordered_json& size, double largest);

/// a90 with its interval, "-" for what has none.
std::string a90_text(const nlohmann::ordered_json& fit, double largest);

}  // namespace glint::population_detail

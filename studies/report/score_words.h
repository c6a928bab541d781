// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

namespace glint::report_detail {

/// What a page calls a score: "homogeneity.h_rms" -> "h (rms)", "defects.min_dprime" ->
/// "smallest d'", "defects.dent.weber" -> "dent: Weber contrast", "view.slot_margin_mm" ->
/// "slot margin (mm)".
std::string score_label(const std::string& score);

/// Its entry of `score_info`: label, format ("percent" for shares, contrasts and h, else "number")
/// and, for a score that `glint explain` knows, its meaning.
nlohmann::ordered_json score_words(const std::string& score);

}  // namespace glint::report_detail

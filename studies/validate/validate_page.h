// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page of a validation: verdict, overlap before and after calibration, where the misfit comes
// from, scores and ranking of both sides, and what `glint compare` shows of each pair.
#pragma once

#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "studies/compare/compare_page.h"

namespace glint {

/// One HTML file that needs no network.
/// @param result  what result.json holds
/// @param pairs   pictures of result["pairs"], in their order
/// @param before  pictures of result["before"]
std::string validate_page(const nlohmann::ordered_json& result,
                          std::span<const PagePair> pairs,
                          std::span<const PagePair> before);

}  // namespace glint

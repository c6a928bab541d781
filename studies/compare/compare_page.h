// SPDX-License-Identifier: GPL-3.0-or-later
//
// The page of a comparison: verdict, overlays, differences, rings, spectra.
#pragma once

#include <span>
#include <string>

#include <nlohmann/json.hpp>

#include "core/image/image_io.h"
#include "studies/compare/compared_pair.h"

namespace glint {

/// What the page shows of one pair beside its numbers: base64 PNGs and the scale of the difference.
struct PagePair {
  nlohmann::ordered_json pictures;
};

/// The photograph in grey with the simulated part laid over it in red; where there is no
/// silhouette, the simulated edges. Edges of the photograph are drawn in blue.
ImageRgb overlay_of(const ComparedPair& pair);

PagePair page_pair(const ComparedPair& pair);

/// One HTML file that needs no network. @param result  what result.json holds
std::string compare_page(const nlohmann::ordered_json& result, std::span<const PagePair> pairs);

}  // namespace glint

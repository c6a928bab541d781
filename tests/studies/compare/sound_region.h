// SPDX-License-Identifier: GPL-3.0-or-later
//
// Photographs of surfaces with what people marked as pitted.
#pragma once

#include <algorithm>
#include <filesystem>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/file.h"
#include "core/image/spans.h"
#include "metrics/overlap/outline.h"

namespace glint {

/// 1 beside what was marked, with a margin.
inline Mask sound_region(const std::filesystem::path& labels, int width_px, int height_px) {
  const nlohmann::json json = nlohmann::json::parse(read_file(labels));
  std::vector<Boundary> marked;
  for (const auto& shape : json["shapes"]) {
    Boundary outline = {.points = {}, .is_closed = true};
    for (const auto& point : shape["points"]) {
      outline.points.push_back({.at_px = {point[0].get<double>(), point[1].get<double>()}});
    }
    marked.push_back(outline);
  }
  const ImageF coverage = filled(marked, width_px, height_px);
  Mask pitted(width_px, height_px);
  std::ranges::transform(coverage.values(), pitted.values().begin(), [](float share) {
    return static_cast<unsigned char>(share > 0.0F ? 1 : 0);
  });
  Mask region = dilated(pitted, 5);
  for (unsigned char& pixel : region.values()) {
    pixel = pixel == 0 ? 1 : 0;
  }
  return region;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What another set of defects changes is found by comparing kept rays bit for bit, not by where
// defects lie: so reflections of a defect elsewhere on the part count, too. A corner that differs
// marks the four pixels around it; refined pixels are looked up by number. Cost: linear in the
// rays, far below tracing them. docs/theory/tunnel.md, "What is kept".
#include "simulator/render/corner_rays/changed_pixels.h"

#include <algorithm>
#include <array>
#include <unordered_map>
#include <vector>

#include "core/error.h"
#include "core/image/mask_kernels.h"

namespace glint {
namespace {

std::array<const float*, 7> arrays_of(const RayCache& rays) {
  return {rays.origin_x.data(),
          rays.origin_y.data(),
          rays.origin_z.data(),
          rays.direction_x.data(),
          rays.direction_y.data(),
          rays.direction_z.data(),
          rays.weight.data()};
}

/// Marks the pixels around each corner whose ray differs.
void mark_corners(const CornerRays& before, const CornerRays& after, Mask& changed) {
  const auto a = arrays_of(before.corners);
  const auto b = arrays_of(after.corners);
  const int columns = after.width_px + 1;
  std::vector<unsigned char> differs(static_cast<std::size_t>(columns));
  for (int y = 0; y <= after.height_px; ++y) {
    const std::size_t at = static_cast<std::size_t>(y) * differs.size();
    std::ranges::fill(differs, static_cast<unsigned char>(0));
    for (std::size_t k = 0; k < a.size(); ++k) {
      mask_kernels::mark_different(a[k] + at, b[k] + at, columns, differs.data());
    }
    for (int v = std::max(0, y - 1); v <= std::min(y, after.height_px - 1); ++v) {
      unsigned char* row = changed.row(v);
      for (int x = 0; x < after.width_px; ++x) {
        const auto left = static_cast<std::size_t>(x);
        row[x] = static_cast<unsigned char>(row[x] | differs[left] | differs[left + 1]);
      }
    }
  }
}

/// Where a refined pixel's cells are.
struct Place {
  const RefinedGroup* group = nullptr;
  std::size_t index = 0;
};

std::unordered_map<std::int32_t, Place> refined_pixels(const CornerRays& rays) {
  std::unordered_map<std::int32_t, Place> places;
  for (const RefinedGroup& group : rays.refined) {
    for (std::size_t i = 0; i < group.pixels.size(); ++i) {
      places[group.pixels[i]] = {.group = &group, .index = i};
    }
  }
  return places;
}

bool has_same_cells(const Place& a, const Place& b) {
  const int n = a.group->cells_per_axis;
  if (b.group->cells_per_axis != n) {
    return false;
  }
  const auto rays = static_cast<std::size_t>(n + 1) * static_cast<std::size_t>(n + 1);
  const auto cells = static_cast<std::size_t>(n) * static_cast<std::size_t>(n);
  const auto a_rays = arrays_of(a.group->rays);
  const auto b_rays = arrays_of(b.group->rays);
  for (std::size_t k = 0; k < a_rays.size(); ++k) {
    const float* first = a_rays[k] + a.index * rays;
    if (!std::equal(first, first + rays, b_rays[k] + b.index * rays)) {
      return false;
    }
  }
  const auto smooth = a.group->is_smooth.begin() + static_cast<std::ptrdiff_t>(a.index * cells);
  return std::equal(smooth,
                    smooth + static_cast<std::ptrdiff_t>(cells),
                    b.group->is_smooth.begin() + static_cast<std::ptrdiff_t>(b.index * cells));
}

}  // namespace

Mask changed_pixels(const CornerRays& before, const CornerRays& after) {
  GLINT_CHECK(before.width_px == after.width_px && before.height_px == after.height_px,
              "pictures differ in size");
  Mask changed(after.width_px, after.height_px);
  mark_corners(before, after, changed);
  for (std::size_t i = 0; i < changed.size(); ++i) {
    if (before.kind.values()[i] != after.kind.values()[i] ||
        before.coverage.values()[i] != after.coverage.values()[i]) {
      changed.values()[i] = 1;
    }
  }
  const auto known = refined_pixels(before);
  for (const auto& [pixel, place] : refined_pixels(after)) {
    const auto found = known.find(pixel);
    if (found == known.end() || !has_same_cells(found->second, place)) {
      changed.values()[static_cast<std::size_t>(pixel)] = 1;
    }
  }
  return changed;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Storage of refined pixels. Those cut into the same number of cells form a group, with their rays
// one pixel after the other, so that later loops run over arrays of known shape. Each row collects
// its own groups, in parallel, and the groups are joined in the order of the rows: the same bytes
// for any number of threads. Cost: each refined ray is copied once more. Memory: 28 bytes per ray;
// rows are freed as they are joined, and given back to the system at times: a process that keeps
// what it frees (cli/main.cpp) would hold all rays twice.
#include "simulator/render/corner_rays/refined_groups.h"

#include <malloc.h>

#include <algorithm>
#include <numeric>

#include "simulator/render/ray_cache/packet_tracer.h"

namespace glint {
namespace {

/// What may be freed before it is given back: 112 MB.
constexpr std::size_t kKeptRays = 4'000'000;

/// Not insert(), which takes one number after the other into an array with unset numbers.
template <class Array>
void append(const Array& from, std::size_t first, std::size_t count, Array& to) {
  const std::size_t size = to.size();
  to.resize(size + count);
  std::copy_n(from.data() + first, count, to.data() + size);
}

void append_components(const RayCache& from, std::size_t first, std::size_t count, RayCache& to) {
  append(from.origin_x, first, count, to.origin_x);
  append(from.origin_y, first, count, to.origin_y);
  append(from.origin_z, first, count, to.origin_z);
  append(from.direction_x, first, count, to.direction_x);
  append(from.direction_y, first, count, to.direction_y);
  append(from.direction_z, first, count, to.direction_z);
  append(from.weight, first, count, to.weight);
}

std::array<RayCache::Floats*, 7> components_of(RayCache& rays) {
  return {&rays.origin_x,
          &rays.origin_y,
          &rays.origin_z,
          &rays.direction_x,
          &rays.direction_y,
          &rays.direction_z,
          &rays.weight};
}

void reserve_rays(const std::vector<RowGroups>& rows, std::size_t k, RayCache& rays) {
  std::size_t count = 0;
  for (const RowGroups& row : rows) {
    count += row[k].group.rays.weight.size();
  }
  for (RayCache::Floats* component : components_of(rays)) {
    component->reserve(count);
  }
}

/// All rows' pixels of one number of cells, which the rows lose.
RefinedGroup join(std::vector<RowGroups>& rows, std::size_t k) {
  RefinedGroup joined;
  joined.cells_per_axis = kCellCounts[k];
  reserve_rays(rows, k, joined.rays);
  std::size_t freed_rays = 0;
  for (RowGroups& row : rows) {
    const RefinedGroup& part = row[k].group;
    const auto num_rays = static_cast<std::int64_t>(joined.rays.weight.size());
    for (std::size_t i = 0; i < row[k].is_special.size(); ++i) {
      if (row[k].is_special[i] != 0) {
        joined.special.push_back(num_rays + static_cast<std::int64_t>(i));
      }
    }
    append(part.pixels, 0, part.pixels.size(), joined.pixels);
    append(part.is_smooth, 0, part.is_smooth.size(), joined.is_smooth);
    append_components(part.rays, 0, part.rays.weight.size(), joined.rays);
    joined.rays.counts += part.rays.counts;
    freed_rays += part.rays.weight.size();
    row[k] = {};
    if (freed_rays > kKeptRays) {
      malloc_trim(0);
      freed_rays = 0;
    }
  }
  joined.rays.samples = 1;
  joined.rays.width_px = static_cast<int>(corners_of(kCellCounts[k]));
  joined.rays.height_px = static_cast<int>(joined.pixels.size());
  return joined;
}

}  // namespace

void append_rays(const RayCache& rays,
                 const std::uint8_t* is_special,
                 std::size_t first,
                 std::size_t count,
                 RowGroup& to) {
  append_components(rays, first, count, to.group.rays);
  to.is_special.insert(to.is_special.end(), is_special, is_special + count);
}

RowGroup& group_of(RowGroups& row, int cells) {
  return row[static_cast<std::size_t>(std::ranges::find(kCellCounts, cells) - kCellCounts.begin())];
}

void sort_by_pixel(RowGroup& row) {
  const RefinedGroup& group = row.group;
  if (std::ranges::is_sorted(group.pixels)) {
    return;
  }
  const std::size_t count = group.pixels.size();
  const std::size_t rays_each = group.rays.weight.size() / count;
  const std::size_t cells_each = group.is_smooth.size() / count;
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return group.pixels[i]; });
  RowGroup sorted;
  sorted.group.rays.counts = group.rays.counts;
  for (const std::size_t i : order) {
    sorted.group.pixels.push_back(group.pixels[i]);
    append(group.is_smooth, i * cells_each, cells_each, sorted.group.is_smooth);
    append_rays(
        group.rays, row.is_special.data() + i * rays_each, i * rays_each, rays_each, sorted);
  }
  row = std::move(sorted);
}

void shrink(RowGroup& row) {
  for (RayCache::Floats* component : components_of(row.group.rays)) {
    component->shrink_to_fit();
  }
  row.group.pixels.shrink_to_fit();
  row.group.is_smooth.shrink_to_fit();
  row.is_special.shrink_to_fit();
}

void join_groups(std::vector<RowGroups> rows, CornerRays& result) {
  for (std::size_t k = 0; k < kCellCounts.size(); ++k) {
    RefinedGroup group = join(rows, k);
    if (!group.pixels.empty()) {
      result.counts += group.rays.counts;
      result.refined.push_back(std::move(group));
    }
  }
}

}  // namespace glint

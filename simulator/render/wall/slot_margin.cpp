// SPDX-License-Identifier: GPL-3.0-or-later
//
// A sight line from each seen point to the camera is intersected with the wall as if it were a ray
// of the picture, a row at a time by the same kernels (tunnel.h); the distance to the slot's edge
// is read off where it meets the wall. Rows that cannot lower the margin are skipped by their
// farthest pixel. docs/theory/tunnel.md, "The slot".
#include "simulator/render/wall/slot_margin.h"

#include <cmath>
#include <vector>

#include "core/image/mask_kernels.h"

namespace glint {

namespace {

/// From what is seen in a row of the picture to the camera, and where that meets the wall.
struct SightRow {
  explicit SightRow(std::size_t width)
      : to_x(width), to_y(width), to_z(width), x_mm(width), y_mm(width), margin_mm(width) {}

  void intersect(const VisibilityBuffer& seen,
                 int row,
                 const Tunnel& tunnel,
                 const Eigen::Vector3d& camera_in_world_mm) {
    rays = seen.seen_points(static_cast<std::int64_t>(row) * seen.width_px, seen.width_px);
    aim_at(rays,
           static_cast<float>(camera_in_world_mm.x()),
           static_cast<float>(camera_in_world_mm.y()),
           static_cast<float>(camera_in_world_mm.z()),
           to_x.data(),
           to_y.data(),
           to_z.data());
    rays.direction_x = to_x.data();
    rays.direction_y = to_y.data();
    rays.direction_z = to_z.data();
    tunnel.intersect_block(rays, x_mm.data(), y_mm.data(), margin_mm.data());
  }

  /// That of a pixel, which is the nearest to the slot's edge so far.
  void put_into(SlotMargin& result, std::size_t i, double left_mm) const {
    result.margin_mm = left_mm;
    result.has_sight = true;
    result.sight = {.origin_mm = vector_of(rays.origin_x[i], rays.origin_y[i], rays.origin_z[i]),
                    .direction = vector_of(to_x[i], to_y[i], to_z[i])};
    result.x_mm = static_cast<double>(x_mm[i]);
    result.y_mm = static_cast<double>(y_mm[i]);
    result.wall_margin_mm = static_cast<double>(margin_mm[i]);
  }

  RayBlock rays;
  std::vector<float> to_x, to_y, to_z, x_mm, y_mm, margin_mm;
};

}  // namespace

SlotMargin slot_margin(const VisibilityBuffer& seen,
                       const Mask& region,
                       const Tunnel& tunnel,
                       const Eigen::Vector3d& camera_in_world_mm) {
  const double half_slot_mm = 0.5 * tunnel.settings().slot_mm;
  const double half_length_mm = 0.5 * tunnel.settings().length_mm;
  SlotMargin result = {.margin_mm = half_slot_mm};
  if (!tunnel.settings().blocks_view) {
    return result;
  }
  const auto width = static_cast<std::size_t>(seen.width_px);
  SightRow sights(width);
  for (int row = 0; row < seen.height_px; ++row) {
    sights.intersect(seen, row, tunnel, camera_in_world_mm);
    const auto farthest_mm = static_cast<double>(mask_kernels::largest_size(
        region.row(row), sights.y_mm.data(), sights.margin_mm.data(), seen.width_px));
    if (result.has_sight && half_slot_mm - farthest_mm >= result.margin_mm) {
      continue;
    }
    for (std::size_t i = 0; i < width; ++i) {
      const double left_mm = half_slot_mm - std::abs(static_cast<double>(sights.y_mm[i]));
      const auto z_mm = tunnel.settings().base_mm + static_cast<double>(sights.margin_mm[i]);
      const bool is_hit = sights.margin_mm[i] >= 0.0F && z_mm < camera_in_world_mm.z() &&
                          std::abs(static_cast<double>(sights.x_mm[i])) < half_length_mm;
      const bool is_farther = result.has_sight && left_mm >= result.margin_mm;
      if (region(static_cast<int>(i), row) != 0 && is_hit && !is_farther) {
        sights.put_into(result, i, left_mm);
      }
    }
  }
  return result;
}

}  // namespace glint

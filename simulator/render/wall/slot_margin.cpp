// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/wall/slot_margin.h"

#include <cmath>
#include <vector>

#include "core/image/mask_kernels.h"

namespace glint {

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
  std::vector<float> to_x(width), to_y(width), to_z(width), x(width), y(width), margin(width);
  for (int row = 0; row < seen.height_px; ++row) {
    RayBlock sight =
        seen.seen_points(static_cast<std::int64_t>(row) * seen.width_px, seen.width_px);
    aim_at(sight,
           static_cast<float>(camera_in_world_mm.x()),
           static_cast<float>(camera_in_world_mm.y()),
           static_cast<float>(camera_in_world_mm.z()),
           to_x.data(),
           to_y.data(),
           to_z.data());
    sight.direction_x = to_x.data();
    sight.direction_y = to_y.data();
    sight.direction_z = to_z.data();
    tunnel.intersect_block(sight, x.data(), y.data(), margin.data());
    const auto farthest_mm = static_cast<double>(
        mask_kernels::largest_size(region.row(row), y.data(), margin.data(), seen.width_px));
    if (result.has_sight && half_slot_mm - farthest_mm >= result.margin_mm) {
      continue;
    }
    for (std::size_t i = 0; i < width; ++i) {
      const auto column = static_cast<int>(i);
      const double y_mm = static_cast<double>(y[i]);
      const double left_mm = half_slot_mm - std::abs(y_mm);
      const auto z_mm = tunnel.settings().base_mm + static_cast<double>(margin[i]);
      const bool is_hit = margin[i] >= 0.0F && z_mm < camera_in_world_mm.z() &&
                          std::abs(static_cast<double>(x[i])) < half_length_mm;
      if (region(column, row) == 0 || !is_hit ||
          (result.has_sight && left_mm >= result.margin_mm)) {
        continue;
      }
      result.margin_mm = left_mm;
      result.has_sight = true;
      result.sight = {
          .origin_mm = vector_of(sight.origin_x[i], sight.origin_y[i], sight.origin_z[i]),
          .direction = vector_of(to_x[i], to_y[i], to_z[i])};
      result.x_mm = static_cast<double>(x[i]);
      result.y_mm = y_mm;
      result.wall_margin_mm = static_cast<double>(margin[i]);
    }
  }
  return result;
}

}  // namespace glint

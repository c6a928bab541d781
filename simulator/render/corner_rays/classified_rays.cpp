// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/corner_rays/classified_rays.h"

namespace glint {

void Classified::make_room(std::size_t count) {
  resize_rays(rays, count);
  path.resize(count);
  piece.resize(count);
  is_special.resize(count);
}

void Classified::take(const EscapePacket& escapes, int count, std::size_t first) {
  store_rays(escapes, count, rays, first);
  for (std::size_t lane = 0; lane < static_cast<std::size_t>(count); ++lane) {
    const RayPath of_lane = escapes.path[lane];
    path[first + lane] = of_lane;
    piece[first + lane] = escapes.piece[lane];
    is_special[first + lane] =
        of_lane == RayPath::kFollowed || of_lane == RayPath::kBlocked || escapes.is_grazing[lane]
            ? 1
            : 0;
  }
}

void SubCorners::make_room(std::size_t count) {
  Classified::make_room(count);
  for (auto* seen : {&seen_x, &seen_y, &seen_z}) {
    seen->resize(count);
  }
  is_grazing.resize(count);
}

void SubCorners::take(const EscapePacket& escapes, int count, std::size_t first) {
  Classified::take(escapes, count, first);
  for (std::size_t lane = 0; lane < static_cast<std::size_t>(count); ++lane) {
    seen_x[first + lane] = static_cast<float>(escapes.seen_x[lane]);
    seen_y[first + lane] = static_cast<float>(escapes.seen_y[lane]);
    seen_z[first + lane] = static_cast<float>(escapes.seen_z[lane]);
    is_grazing[first + lane] = escapes.is_grazing[lane] ? 1 : 0;
  }
}

}  // namespace glint

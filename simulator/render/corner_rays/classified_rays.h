// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "simulator/render/ray_cache/packet_tracer.h"

namespace glint {

/// Traced rays with what is needed only until pixels are classified.
struct Classified {
  RayCache rays;
  std::vector<RayPath> path;
  std::vector<std::int32_t> piece;
  std::vector<std::uint8_t> is_special;  ///< met the part more than once, or grazes it

  void make_room(std::size_t count);

  /// Writes lanes [0, count) to rays first, first + 1, ...
  void take(const EscapePacket& escapes, int count, std::size_t first);
};

/// Sub-corner rays of pixels of a row that are cut into the same number of cells.
struct SubCorners : Classified {
  std::vector<float> seen_x, seen_y, seen_z;
  std::vector<std::uint8_t> is_grazing;

  void make_room(std::size_t count);
  void take(const EscapePacket& escapes, int count, std::size_t first);
};

}  // namespace glint

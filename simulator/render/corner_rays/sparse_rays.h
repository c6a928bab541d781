// SPDX-License-Identifier: GPL-3.0-or-later
//
// Every eighth corner ray, and where the others lie between them. Where a smooth part sends
// neighbouring rays, a smooth wall is met at places that are smooth, too: a quintic through every
// eighth one gives the others, to a small share of a pixel's footprint
// (docs/theory/footprints.md). Tiles where rays or wall do not allow that are intersected ray by
// ray.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "simulator/light/tunnel/tunnel.h"

namespace glint {

struct RayCache;

/// A row of rays one after the other in a cache.
struct RayStretch {
  std::int32_t first = 0;
  std::int32_t count = 0;
};

/// Picked rays, one array per component.
struct PickedRays {
  std::vector<float> origin_x, origin_y, origin_z;
  std::vector<float> direction_x, direction_y, direction_z;

  int count() const { return static_cast<int>(origin_x.size()); }

  RayBlock block() const;

  void add(const RayCache& rays, std::size_t index);

  /// These rays and no others.
  void take(const RayCache& rays, const std::vector<RayStretch>& stretches);
};

/// What the rays of a tile allow: kStep x kStep of them, fewer where the picture ends, of which the
/// first one is a node.
enum class TileKind : std::uint8_t {
  kNone,    ///< no ray has met the part
  kSmooth,  ///< those that have are the quintic through the nodes around
  kBent     ///< they are not
};

/// About 1.5 bytes for each ray of the cache, and 24 for each that is left over.
struct SparseRays {
  /// In a tile.
  struct Place {
    int column, row;
  };

  /// To either side of the middle, where a quintic is wrong most.
  static constexpr std::array<Place, 2> kCheckPlaces = {{{6, 2}, {2, 5}}};
  static constexpr std::size_t kChecks = kCheckPlaces.size();

  /// In the last tiles of the picture, which no node follows, at their end.
  Place check_place(std::size_t check, int column, int row, const RayCache& corners) const;

  /// A node beyond the part's outline or the picture, where the quintic (or cubic) of others in a
  /// row goes on: index `to` and steps of `step` in a plane with three nodes more on each side.
  struct Beyond {
    std::int32_t to = 0;
    std::int32_t step = 0;
    bool is_cubic = false;
  };

  int columns = 0;  ///< of nodes, at 0, kStep, 2 kStep ..., and of tiles; 0: not worth it
  int rows = 0;
  PickedRays nodes;                        ///< row by row
  std::array<PickedRays, kChecks> checks;  ///< one in each tile, row by row; dark ones extrapolated
  std::vector<Beyond> beyond;              ///< one after the other
  std::vector<TileKind> kind;              ///< row by row
  std::vector<RayStretch> dark_stretches;  ///< rays that have not met the part or are given up
  std::vector<RayStretch> rest_stretches;  ///< other rays of bent tiles
  PickedRays rest;

  bool is_empty() const { return columns == 0; }
};

/// @param corners                  a picture of rays, one sample
/// @param max_direction_error_rad  by which the rays of smooth tiles may differ from the quintic
/// @return empty for pictures that are small or bent in more than a quarter of their tiles
SparseRays sparse_rays(const RayCache& corners, double max_direction_error_rad);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// The corner after and the corner before, of corners counted 3 * face + k.
inline std::int32_t next_corner(std::int32_t corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

inline std::int32_t previous_corner(std::int32_t corner) {
  return corner % 3 == 0 ? corner + 2 : corner - 1;
}

inline std::int32_t vertex_at(std::span<const Triangle> faces, std::int32_t corner) {
  return faces[static_cast<std::size_t>(corner / 3)][static_cast<std::size_t>(corner % 3)];
}

/// Directed edge as one number.
inline std::uint64_t edge_key(std::int32_t from, std::int32_t to) {
  return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(from)) << 32U) |
         static_cast<std::uint32_t>(to);
}

/// Hash table of 64-bit keys, of a size known beforehand; linear probing in one array.
class KeyTable {
 public:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};  ///< not allowed as a key

  explicit KeyTable(std::size_t num_keys) : slots_(std::bit_ceil(2 * num_keys + 2)) {
    shift_ = 64U - static_cast<unsigned>(std::countr_zero(slots_.size()));
  }

  /// The value of a key, made as `fresh` when it was not there.
  std::int32_t& at(std::uint64_t key, std::int32_t fresh) {
    Slot& slot = slots_[place_of(key)];
    if (slot.key == kNone) {
      slot = {key, fresh};
    }
    return slot.value;
  }

  /// The value of a key, `none` when it is not there.
  std::int32_t find(std::uint64_t key, std::int32_t none) const {
    const Slot& slot = slots_[place_of(key)];
    return slot.key == kNone ? none : slot.value;
  }

 private:
  struct Slot {
    std::uint64_t key = kNone;
    std::int32_t value = 0;
  };

  std::size_t place_of(std::uint64_t key) const {
    std::size_t place = (key * 0x9E3779B97F4A7C15ULL) >> shift_;
    while (slots_[place].key != key && slots_[place].key != kNone) {
      place = (place + 1) & (slots_.size() - 1);
    }
    return place;
  }

  std::vector<Slot> slots_;
  unsigned shift_ = 0;
};

/// Which faces lie on the other side of each edge.
struct EdgeMatches {
  /// Per corner 3 * face + k, for the edge from corner k to the next: the corner in which the
  /// opposite edge starts; -1 where there is none or more than one.
  std::vector<std::int32_t> opposite;
  std::int64_t open = 0;      ///< edges without an opposite
  std::int64_t repeated = 0;  ///< faces too many at a directed edge

  bool is_closed() const { return open == 0 && repeated == 0; }
};

EdgeMatches match_edges(std::span<const Triangle> faces);

}  // namespace glint

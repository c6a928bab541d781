// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/boolean/patch_edges.h"

namespace glint {
namespace {

constexpr std::int32_t kMissing = -1;
constexpr std::int32_t kAmbiguous = -2;

std::uint64_t key_at(std::span<const Triangle> faces, std::int32_t corner) {
  return edge_key(vertex_at(faces, corner), vertex_at(faces, next_corner(corner)));
}

std::uint64_t opposite_key_at(std::span<const Triangle> faces, std::int32_t corner) {
  return edge_key(vertex_at(faces, next_corner(corner)), vertex_at(faces, corner));
}

}  // namespace

EdgeMatches match_edges(std::span<const Triangle> faces) {
  const auto num_corners = static_cast<std::int32_t>(3 * faces.size());
  EdgeMatches matches;
  matches.opposite.assign(3 * faces.size(), -1);
  KeyTable table(3 * faces.size());
  for (std::int32_t corner = 0; corner < num_corners; ++corner) {
    std::int32_t& first = table.at(key_at(faces, corner), corner);
    if (first != corner) {
      first = kAmbiguous;
      ++matches.repeated;
    }
  }
  for (std::int32_t corner = 0; corner < num_corners; ++corner) {
    const std::int32_t other = table.find(opposite_key_at(faces, corner), kMissing);
    matches.open += other == kMissing ? 1 : 0;
    if (other >= 0 && table.find(key_at(faces, corner), kMissing) == corner) {
      matches.opposite[static_cast<std::size_t>(corner)] = other;
    }
  }
  return matches;
}

}  // namespace glint

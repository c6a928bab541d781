// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/wall_motion_kernels.h"

#include <bit>
#include <cmath>
#include <cstdint>

#define GLINT_WIDE __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))

namespace glint {
namespace {

/// Rays that are looked at together: neighbours mostly share one or two pieces of the wall.
constexpr int kChunk = 32;
constexpr int kDoubleLanes = 8;

/// Where the rays of a chunk meet the wall.
struct Chunk {
  std::int32_t node[kChunk];
  float part[kChunk];  ///< of the way to the next node
  std::int32_t lowest = 0;
  std::int32_t highest = 0;
};

/// Of one ray, by the wall's normal where it is met.
__attribute__((always_inline)) inline float by_shift_of(
    float by_x, float by_y, float by_margin, float dx, float dy, float dz, float ny, float nz) {
  const float along_ray = by_x * dx + by_y * dy + by_margin * dz;
  const float through = ny * dy + nz * dz;
  const bool has_slope = (by_x != 0.0F) | (by_y != 0.0F) | (by_margin != 0.0F);
  return has_slope ? along_ray / through : 0.0F;
}

/// In pairs, the same on any machine.
__attribute__((always_inline)) inline double total_of(float* values) {
  for (int i = 0; i < 16; ++i) {
    values[i] += values[i + 16];
  }
  for (int i = 0; i < 8; ++i) {
    values[i] += values[i + 8];
  }
  for (int i = 0; i < 4; ++i) {
    values[i] += values[i + 4];
  }
  return static_cast<double>((values[0] + values[1]) + (values[2] + values[3]));
}

}  // namespace

/// Restricted pointers must be parameters: the compiler believes them only there.
GLINT_WIDE static bool has_slopes(const float* __restrict x,
                                  const float* __restrict y,
                                  const float* __restrict margin,
                                  int count) {
  std::uint32_t bits = 0;
  for (int i = 0; i < count; ++i) {
    bits |= std::bit_cast<std::uint32_t>(x[i]) | std::bit_cast<std::uint32_t>(y[i]) |
            std::bit_cast<std::uint32_t>(margin[i]);
  }
  return (bits & 0x7FFFFFFFU) != 0;
}

GLINT_WIDE static void find_nodes(const float* __restrict y_mm,
                                  const float* __restrict margin_mm,
                                  int count,
                                  int pieces,
                                  Chunk& chunk) {
  std::int32_t lowest = pieces;
  std::int32_t highest = 0;
  for (int i = 0; i < count; ++i) {
    const float y = y_mm[i];
    const float beside = y < 0.0F ? -y : y;
    const float height = margin_mm[i] > 0.0F ? margin_mm[i] : 0.0F;
    const float span = beside + height;
    const float least = beside < height ? beside : height;
    const float root = std::sqrt(0.5F * least / (span > 1e-9F ? span : 1e-9F));
    const float from_top = beside < height ? root : 1.0F - root;
    const float side = y < 0.0F ? -from_top : from_top;
    const float at = 0.5F * (side + 1.0F) * static_cast<float>(pieces);
    const auto whole = static_cast<std::int32_t>(at);
    const std::int32_t below = whole < pieces ? whole : pieces - 1;
    const std::int32_t node = below > 0 ? below : 0;
    chunk.node[i] = node;
    chunk.part[i] = at - static_cast<float>(node);
    lowest = node < lowest ? node : lowest;
    highest = node > highest ? node : highest;
  }
  chunk.lowest = lowest;
  chunk.highest = highest;
}

/// Of a whole chunk between three nodes: no normal is looked up, and the sums run over lanes.
GLINT_WIDE static void add_near_nodes(const float* __restrict by_x,
                                      const float* __restrict by_y,
                                      const float* __restrict by_margin,
                                      const float* __restrict dx,
                                      const float* __restrict dy,
                                      const float* __restrict dz,
                                      const WallNormals& normals,
                                      const Chunk& chunk,
                                      double* __restrict by_node) {
  const std::int32_t lowest = chunk.lowest;
  const float* normal_y = normals.y + lowest;
  const float* normal_z = normals.z + lowest;
  const std::int32_t last = chunk.highest + 1 - lowest;
  const float y0 = normal_y[0], y1 = normal_y[1], y2 = normal_y[last];
  const float z0 = normal_z[0], z1 = normal_z[1], z2 = normal_z[last];
  float first[kChunk], third[kChunk], all[kChunk];
  for (int i = 0; i < kChunk; ++i) {
    const bool is_low = chunk.node[i] == lowest;
    const float part = chunk.part[i];
    const float ny = (is_low ? y0 : y1) + part * (is_low ? y1 - y0 : y2 - y1);
    const float nz = (is_low ? z0 : z1) + part * (is_low ? z1 - z0 : z2 - z1);
    const float slope = by_shift_of(by_x[i], by_y[i], by_margin[i], dx[i], dy[i], dz[i], ny, nz);
    first[i] = is_low ? slope * (1.0F - part) : 0.0F;
    third[i] = is_low ? 0.0F : slope * part;
    all[i] = slope;
  }
  static_assert(kChunk == 32);
  const double at_first = total_of(first);
  const double at_third = total_of(third);
  by_node[lowest] += at_first;
  by_node[lowest + 1] += total_of(all) - at_first - at_third;
  by_node[lowest + last] += at_third;
}

/// Of any rays.
static void add_one_by_one(const RayBlock& rays,
                           int begin,
                           int count,
                           const HitSlopes& slopes,
                           const WallNormals& normals,
                           const Chunk& chunk,
                           double* by_node) {
  for (int i = 0; i < count; ++i) {
    const std::int32_t node = chunk.node[i];
    const float part = chunk.part[i];
    const float ny = normals.y[node] + part * (normals.y[node + 1] - normals.y[node]);
    const float nz = normals.z[node] + part * (normals.z[node + 1] - normals.z[node]);
    const int j = begin + i;
    const auto slope = static_cast<double>(by_shift_of(slopes.x[j],
                                                       slopes.y[j],
                                                       slopes.margin[j],
                                                       rays.direction_x[j],
                                                       rays.direction_y[j],
                                                       rays.direction_z[j],
                                                       ny,
                                                       nz));
    by_node[node] += slope * (1.0 - static_cast<double>(part));
    by_node[node + 1] += slope * static_cast<double>(part);
  }
}

void add_shift_slopes(const RayBlock& rays,
                      const float* y_mm,
                      const float* margin_mm,
                      const HitSlopes& slopes,
                      const WallNormals& normals,
                      double* by_node) {
  Chunk chunk;
  for (int begin = 0; begin < rays.count; begin += kChunk) {
    const int count = rays.count - begin < kChunk ? rays.count - begin : kChunk;
    const float* x = slopes.x + begin;
    const float* y = slopes.y + begin;
    const float* margin = slopes.margin + begin;
    if (!has_slopes(x, y, margin, count)) {
      continue;
    }
    find_nodes(y_mm + begin, margin_mm + begin, count, normals.pieces, chunk);
    if (count == kChunk && chunk.highest - chunk.lowest <= 1) {
      add_near_nodes(x,
                     y,
                     margin,
                     rays.direction_x + begin,
                     rays.direction_y + begin,
                     rays.direction_z + begin,
                     normals,
                     chunk,
                     by_node);
    } else {
      add_one_by_one(rays, begin, count, slopes, normals, chunk, by_node);
    }
  }
}

GLINT_WIDE double sum_in_lanes(const float* values, int count) {
  double lanes[kDoubleLanes] = {};
  int i = 0;
  for (; i + kDoubleLanes <= count; i += kDoubleLanes) {
    for (int lane = 0; lane < kDoubleLanes; ++lane) {
      lanes[lane] += static_cast<double>(values[i + lane]);
    }
  }
  double sum = 0.0;
  for (; i < count; ++i) {
    sum += static_cast<double>(values[i]);
  }
  for (const double lane : lanes) {
    sum += lane;
  }
  return sum;
}

}  // namespace glint

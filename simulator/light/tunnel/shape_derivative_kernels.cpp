// SPDX-License-Identifier: GPL-3.0-or-later
//
// Adds what each ray contributes to the two nodes of the wall between which it hits. Neighbouring
// rays hit neighbouring nodes, so a chunk of 32 rays adds to a window of 16 nodes, each in eight
// lanes of double, which is added to the whole only when a chunk lies outside it. The order of
// additions is fixed: the same bits on any machine. docs/theory/derivatives.md, "Wall". Cost: some
// dozen operations per ray; 1 kB for the window.
#include "simulator/light/tunnel/shape_derivative_kernels.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "core/simd.h"

namespace glint {
namespace {

/// Rays that are looked at together: neighbours meet neighbouring pieces of the wall.
constexpr int kChunk = 32;

constexpr int kDoubleLanes = 8;
using Doubles = double __attribute__((vector_size(kDoubleLanes * sizeof(double))));
using Floats = float __attribute__((vector_size(kDoubleLanes * sizeof(float))));

/// Some nodes that chunk after chunk lies between, and what is yet to be added to them, in lanes.
struct Window {
  static constexpr int kNodes = 16;
  static constexpr int kBefore = 4;  ///< the first chunk: of the next ones some lie lower
  int first = 0;
  bool is_used = false;
  Doubles sums[kNodes];
};

/// Where the rays of a chunk meet the wall.
struct Chunk {
  std::int32_t node[kChunk];
  float part[kChunk];  ///< of the way to the next node
  std::int32_t lowest = 0;
  std::int32_t highest = 0;
};

/// Of one ray, by the wall's normal where it is met.
GLINT_INLINE float by_shift_of(
    float by_x, float by_y, float by_margin, float dx, float dy, float dz, float ny, float nz) {
  const float along_ray = by_x * dx + by_y * dy + by_margin * dz;
  const float through = ny * dy + nz * dz;
  const bool has_derivative = (by_x != 0.0F) | (by_y != 0.0F) | (by_margin != 0.0F);
  return has_derivative ? along_ray / through : 0.0F;
}

/// Adds the lanes in pairs, the same on any machine, and empties the window.
void flush(Window& window, double* by_node) {
  for (int node = 0; window.is_used && node < Window::kNodes; ++node) {
    const Doubles& v = window.sums[node];
    by_node[window.first + node] +=
        ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7]));
  }
  window.is_used = false;
}

/// Whether a chunk lies in the window, which is moved there if it can be.
bool fit(const Chunk& chunk, int pieces, Window& window, double* by_node) {
  const auto is_inside = [&] {
    return chunk.lowest >= window.first && chunk.highest + 1 < window.first + Window::kNodes;
  };
  if (window.is_used && is_inside()) {
    return true;
  }
  if (chunk.highest - chunk.lowest > Window::kNodes - Window::kBefore - 2) {
    return false;
  }
  flush(window, by_node);
  const int highest = pieces + 1 - Window::kNodes;
  const int wanted = chunk.lowest - Window::kBefore;
  window.first = wanted < 0 ? 0 : (wanted > highest ? highest : wanted);
  for (Doubles& sum : window.sums) {
    sum = Doubles{};
  }
  window.is_used = true;
  return true;
}

}  // namespace

/// Restricted pointers must be parameters: the compiler believes them only there.
GLINT_WIDE static bool has_gradient(const float* __restrict x,
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

/// Where all rays are, and between which nodes those that have a derivative.
GLINT_WIDE static void find_nodes(const float* __restrict y_mm,
                                  const float* __restrict margin_mm,
                                  const float* __restrict by_x,
                                  const float* __restrict by_y,
                                  const float* __restrict by_margin,
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
    const float minimum = beside < height ? beside : height;
    const float root = std::sqrt(0.5F * minimum / (span > 1e-9F ? span : 1e-9F));
    const float from_top = beside < height ? root : 1.0F - root;
    const float side = y < 0.0F ? -from_top : from_top;
    const float at = 0.5F * (side + 1.0F) * static_cast<float>(pieces);
    const auto whole = static_cast<std::int32_t>(at);
    const std::int32_t below = whole < pieces ? whole : pieces - 1;
    const std::int32_t node = below > 0 ? below : 0;
    chunk.node[i] = node;
    chunk.part[i] = at - static_cast<float>(node);
    const bool counts = (by_x[i] != 0.0F) | (by_y[i] != 0.0F) | (by_margin[i] != 0.0F);
    lowest = (counts & (node < lowest)) ? node : lowest;
    highest = (counts & (node > highest)) ? node : highest;
  }
  chunk.lowest = lowest;
  chunk.highest = highest;
}

/// Of a whole chunk in the window: each node has its share of all rays, mostly none, so that no
/// normal is looked up and the sums run over lanes.
GLINT_WIDE static void add_near_nodes(const float* __restrict by_x,
                                      const float* __restrict by_y,
                                      const float* __restrict by_margin,
                                      const float* __restrict dx,
                                      const float* __restrict dy,
                                      const float* __restrict dz,
                                      const WallNormals& normals,
                                      const Chunk& chunk,
                                      Window& window) {
  const std::int32_t lowest = chunk.lowest;
  const int nodes = chunk.highest - lowest + 2;
  float shares[Window::kNodes][kChunk];
  float ny[kChunk] = {}, nz[kChunk] = {};
  for (int node = 0; node < nodes; ++node) {
    const float normal_y = normals.y[lowest + node];
    const float normal_z = normals.z[lowest + node];
    for (int i = 0; i < kChunk; ++i) {
      const float from_node = static_cast<float>(chunk.node[i] - lowest - node) + chunk.part[i];
      const float away = from_node < 0.0F ? -from_node : from_node;
      const float share = away < 1.0F ? 1.0F - away : 0.0F;
      shares[node][i] = share;
      ny[i] += share * normal_y;
      nz[i] += share * normal_z;
    }
  }
  float derivatives[kChunk];
  for (int i = 0; i < kChunk; ++i) {
    derivatives[i] = by_shift_of(by_x[i], by_y[i], by_margin[i], dx[i], dy[i], dz[i], ny[i], nz[i]);
  }
  for (int node = 0; node < nodes; ++node) {
    Doubles sum = window.sums[lowest - window.first + node];
    for (int i = 0; i < kChunk; i += kDoubleLanes) {
      Floats derivative, share;
      std::memcpy(&derivative, derivatives + i, sizeof(derivative));
      std::memcpy(&share, shares[node] + i, sizeof(share));
      sum += __builtin_convertvector(derivative * share, Doubles);
    }
    window.sums[lowest - window.first + node] = sum;
  }
}

/// Of any rays.
static void add_one_by_one(const RayBlock& rays,
                           const HitGradient& derivatives,
                           const WallNormals& normals,
                           const Chunk& chunk,
                           double* by_node) {
  for (int i = 0; i < rays.count; ++i) {
    const std::int32_t node = chunk.node[i];
    const float part = chunk.part[i];
    const float ny = normals.y[node] + part * (normals.y[node + 1] - normals.y[node]);
    const float nz = normals.z[node] + part * (normals.z[node + 1] - normals.z[node]);
    const auto derivative = static_cast<double>(by_shift_of(derivatives.x[i],
                                                            derivatives.y[i],
                                                            derivatives.margin[i],
                                                            rays.direction_x[i],
                                                            rays.direction_y[i],
                                                            rays.direction_z[i],
                                                            ny,
                                                            nz));
    by_node[node] += derivative * (1.0 - static_cast<double>(part));
    by_node[node + 1] += derivative * static_cast<double>(part);
  }
}

void add_shift_derivatives(const RayBlock& rays,
                           const float* y_mm,
                           const float* margin_mm,
                           const HitGradient& derivatives,
                           const WallNormals& normals,
                           double* by_node) {
  constexpr float kNone[kChunk] = {};
  Chunk chunk;
  Window window;
  for (int begin = 0; begin < rays.count; begin += kChunk) {
    const RayBlock some = {.direction_x = rays.direction_x + begin,
                           .direction_y = rays.direction_y + begin,
                           .direction_z = rays.direction_z + begin,
                           .count = rays.count - begin < kChunk ? rays.count - begin : kChunk};
    const HitGradient by = {
        .x = derivatives.x + begin,
        .y = derivatives.y != nullptr ? derivatives.y + begin : kNone,
        .margin = derivatives.margin != nullptr ? derivatives.margin + begin : kNone};
    if (!has_gradient(by.x, by.y, by.margin, some.count)) {
      continue;
    }
    find_nodes(
        y_mm + begin, margin_mm + begin, by.x, by.y, by.margin, some.count, normals.pieces, chunk);
    if (some.count == kChunk && fit(chunk, normals.pieces, window, by_node)) {
      add_near_nodes(by.x,
                     by.y,
                     by.margin,
                     some.direction_x,
                     some.direction_y,
                     some.direction_z,
                     normals,
                     chunk,
                     window);
    } else {
      add_one_by_one(some, by, normals, chunk, by_node);
    }
  }
  flush(window, by_node);
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

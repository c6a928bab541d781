// SPDX-License-Identifier: GPL-3.0-or-later
//
// Inner loops of sparse_rays.h, free of Eigen so that they can be compiled for wide instruction
// sets. Between numbers known at every eighth place runs the quintic through six of them.
#pragma once

#include <array>

namespace glint::sparse_kernels {

/// Places from one node to the next.
inline constexpr int kStep = 8;

/// Places of a tile along a side of a picture: fewer in the last one, where the picture ends.
inline int places_of(int tile, int places) {
  const int left = places - tile * kStep;
  return left < kStep ? left : kStep;
}

/// Nodes of a quintic, and those of them before the place.
inline constexpr int kNodes = 6;
inline constexpr int kBefore = 2;

/// Weights of the nodes at -2, -1, 0, 1, 2 and 3 steps, for a place between the two in the middle.
using NodeWeights = std::array<float, kNodes>;

/// Lagrange's. @param place  in [0, kStep)
constexpr NodeWeights node_weights(int place) {
  const double u = static_cast<double>(place) / kStep;
  NodeWeights weights = {};
  for (int i = 0; i < kNodes; ++i) {
    double weight = 1.0;
    for (int k = 0; k < kNodes; ++k) {
      weight *= k == i ? 1.0 : (u - (k - kBefore)) / (i - k);
    }
    weights[static_cast<unsigned>(i)] = static_cast<float>(weight);
  }
  return weights;
}

/// node_weights() of each place.
inline constexpr std::array<NodeWeights, kStep> kNodeWeights = [] {
  std::array<NodeWeights, kStep> weights = {};
  for (int place = 0; place < kStep; ++place) {
    weights[static_cast<unsigned>(place)] = node_weights(place);
  }
  return weights;
}();

/// Rows of nodes, one below the other.
using NodeRows = std::array<const float*, kNodes>;

/// out = the rows' sum by these weights.
void blend_rows(const NodeRows& rows, const NodeWeights& weights, int count, float* out);

/// The places of `tiles` stretches of kStep: stretch i runs from nodes[i + kBefore] to before the
/// next.
void spread(const float* nodes, int tiles, float* out);

/// For each stretch the larger of what it was and |value - the quintic at a place of it|; not a
/// number: infinity.
void find_errors(
    const float* nodes, const float* values, const NodeWeights& weights, int tiles, float* errors);

/// The same for all places of stretches.
/// @param values  kStep a stretch
void find_errors_of_all(const float* spread_values, const float* values, int tiles, float* errors);

/// allowed[i] = the larger of `minimum` and `share` times the range of the four nodes around tile
/// i.
/// @param top, bottom  first node of the first tile in two rows
void allow_errors(const float* top, const float* bottom, int tiles, float share, float* allowed);

/// Limits of hits across a tunnel, tile by tile.
struct AcrossLimits {
  const float* y_low = nullptr;
  const float* y_high = nullptr;
  const float* margin_low = nullptr;
  const float* margin_high = nullptr;
};

/// Makes allowed[i] so many times what it was where neither slot edge nor rim is near the tile.
void allow_more(
    const AcrossLimits& limits, int tiles, float half_slot_mm, float times, float* allowed);

/// Allows a tile's distances to a boundary, where it crosses none, to err by a share of the least
/// of them: only their sign matters.
void allow_share(const float* low, const float* high, int tiles, float share, float* allowed);

/// Clears flags of tiles with errors that are not allowed.
void keep_allowed(const float* errors, const float* allowed, int tiles, unsigned char* flags);

/// Limits of the quintics over whole tiles, the first nodes of the next ones included: those of the
/// four nodes around, and a share of the second differences that bend them.
/// @param rows     the first node of the first tile's stencil, as blend_rows() takes them
/// @param scratch  tiles + kNodes - 1
void find_limits(const NodeRows& rows, int tiles, float* low, float* high, float* scratch);

}  // namespace glint::sparse_kernels

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The light of one row of directions, those in a plane along the tunnel, in float and free of
// Eigen.
#pragma once

#include "simulator/render/path_tracing/conductor_kernels.h"

namespace glint {

/// Directions in a row.
inline constexpr int kLobeColumns = 2 * kPacketSize;

/// Harmonics of the stripes that are followed at most.
inline constexpr int kMaxHarmonics = 96;

/// Which harmonics of the stripes are summed: first, first + step, ...
struct HarmonicList {
  int count = 0;
  int step = 1;  ///< 2: the odd ones, where bright and dark stripes are equally wide

  int number(int index) const { return 1 + index * step; }
};

/// Nodes in (-1, 1) and weights (sum 2).
struct alignas(64) ColumnRule {
  float node[kLobeColumns];
  float weight[kLobeColumns];
};

/// The metal at a point, and how directions stand to it.
struct alignas(64) LobeFrame {
  VectorLanes viewer;  ///< local, the same in all lanes
  LobeLanes lobes;     ///< choose_lobes16() of it
  float tangent[3] = {};
  float bitangent[3] = {};
  float normal[3] = {};
};

/// Directions (t, sine, cosine) / sqrt(1 + t^2) with t = middle + width tan(psi), psi at the nodes
/// of the rule in [psi - half_psi, psi + half_psi].
struct LobeRow {
  float sine = 0.0F;
  float cosine = 1.0F;
  float middle = 0.0F;
  float width = 1.0F;
  float psi = 0.0F;
  float half_psi = 0.0F;
  float weight = 1.0F;       ///< angle that the row stands for [rad]
  float turns = 0.0F;        ///< phase of the stripes at t = 0, from that of the mirrored ray
  float turns_per_t = 0.0F;  ///< periods
  float row_turns = 0.0F;    ///< periods from the row's beginning to its end, at its middle
  float dark = 0.0F;         ///< radiance of dark stripes
  float even = 1.0F;         ///< the wall's radiance is even + law / sqrt(1 + t^2)
  float law = 0.0F;
};

/// Sums over directions, lane by lane.
struct alignas(64) LobeSums {
  float dark[kPacketSize] = {};  ///< light of a wall of dark stripes alone
  float even[kPacketSize] = {};  ///< what bright ones add if they are everywhere
  float real[kMaxHarmonics][kPacketSize] = {};
  float imaginary[kMaxHarmonics][kPacketSize] = {};
};

void add_lobe_row(const ConductorNumbers& metal,
                  const LobeFrame& frame,
                  const ColumnRule& rule,
                  const LobeRow& row,
                  const HarmonicList& harmonics,
                  LobeSums& sums);

/// How much of a wave survives when the place it is taken at stands for `turns` periods around it:
/// sinc^3 (1 + z^2 / 2), z = pi turns: 1 but for the fourth order, and 0 from one period on, where
/// the sum over places does not know it any more.
float kept_of_wave(float turns);

/// value[i] += by_real * real[i] - by_imaginary * imaginary[i]
void add_wave(const float* real,
              const float* imaginary,
              float by_real,
              float by_imaginary,
              int count,
              float* value);

}  // namespace glint

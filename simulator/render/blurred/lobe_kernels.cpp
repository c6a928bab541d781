// SPDX-License-Identifier: GPL-3.0-or-later
//
// A row of 32 directions: reflectance by the path tracer's kernel for metal, times the wall's light
// as a Fourier series of its stripes. Waves are turned on from harmonic to harmonic by a complex
// product. In the lobe's long tails neighbouring directions meet the wall whole periods apart; what
// a sum over them would say of the stripes there is noise, and the true share is almost nothing, so
// waves fade out by the distance of neighbours (kept_of_wave()). Own derivation:
// docs/theory/blurred.md, "What is summed" and "Directions". Cost: some 0.4 us for 32 directions
// and 6 harmonics.
#include "simulator/render/blurred/lobe_kernels.h"

#include <cmath>

#include "core/simd.h"
#include "simulator/render/path_tracing/lane_math.h"

namespace glint {
namespace {

struct alignas(64) RowLanes {
  VectorLanes to_light;
  float weight[kPacketSize];  ///< solid angle times the wall's radiance
  float turns[kPacketSize];   ///< in [0, 1)
  float cell[kPacketSize];    ///< periods that a direction stands for
};

GLINT_INLINE float fraction_of(float turns) {
  const float rest = turns - std::floor(turns);
  return rest < 1.0F ? rest : 0.0F;
}

GLINT_INLINE void place_directions(const LobeFrame& frame,
                                   const ColumnRule& rule,
                                   const LobeRow& row,
                                   int first,
                                   RowLanes* __restrict lanes) {
  constexpr float kPerTurn = 0.5F / kPiF;
  for (int i = 0; i < kPacketSize; ++i) {
    const float psi = row.psi + row.half_psi * rule.node[first + i];
    const SineCosine at = sine_cosine_of_turns(psi * kPerTurn + 1.0F);
    const float cosine = maximum(at.cosine, 1e-6F);
    const float t = row.middle + row.width * at.sine / cosine;
    const float step = row.half_psi * rule.weight[first + i] * row.width / (cosine * cosine);
    const float scale = 1.0F / std::sqrt(1.0F + t * t);
    const float x = t * scale;
    const float y = row.sine * scale;
    const float z = row.cosine * scale;
    lanes->to_light.x[i] = frame.tangent[0] * x + frame.tangent[1] * y + frame.tangent[2] * z;
    lanes->to_light.y[i] = frame.bitangent[0] * x + frame.bitangent[1] * y + frame.bitangent[2] * z;
    lanes->to_light.z[i] = frame.normal[0] * x + frame.normal[1] * y + frame.normal[2] * z;
    const float solid_angle = row.weight * step * scale * scale * scale;
    lanes->weight[i] = solid_angle * (row.even + row.law * scale);
    lanes->turns[i] = fraction_of(row.turns + row.turns_per_t * t);
    lanes->cell[i] = std::fabs(row.turns_per_t * step);
  }
}

/// A complex number in each lane.
struct alignas(64) WaveLanes {
  float real[kPacketSize];
  float imaginary[kPacketSize];
};

GLINT_INLINE void turn(const WaveLanes* __restrict by, WaveLanes* __restrict wave) {
  for (int i = 0; i < kPacketSize; ++i) {
    const float real = wave->real[i] * by->real[i] - wave->imaginary[i] * by->imaginary[i];
    wave->imaginary[i] = wave->real[i] * by->imaginary[i] + wave->imaginary[i] * by->real[i];
    wave->real[i] = real;
  }
}

/// Waves of the first harmonic and, to turn them on, of the step between two.
GLINT_INLINE void start_waves(const float* __restrict turns,
                              int step,
                              WaveLanes* __restrict wave,
                              WaveLanes* __restrict by) {
  for (int i = 0; i < kPacketSize; ++i) {
    const SineCosine at = sine_cosine_of_turns(turns[i]);
    wave->real[i] = at.cosine;
    wave->imaginary[i] = at.sine;
  }
  *by = *wave;
  for (int k = 1; k < step; ++k) {
    turn(wave, by);
  }
}

/// As kept_of_wave(), of the sine of z.
GLINT_INLINE float kept(float z, float sine) {
  const float in = maximum(z, 1e-2F);
  const float sinc = sine / in;
  const float share = sinc * sinc * sinc * (1.0F + 0.5F * in * in);
  return z < 1e-2F ? 1.0F : (z < kPiF ? share : 0.0F);
}

GLINT_INLINE void add_harmonics(const RowLanes& lanes,
                                const float* __restrict light,
                                const HarmonicList& harmonics,
                                float row_turns,
                                LobeSums* __restrict sums) {
  WaveLanes wave, by, cell, cell_by;
  start_waves(lanes.turns, harmonics.step, &wave, &by);
  alignas(64) float half_turns[kPacketSize];
  for (int i = 0; i < kPacketSize; ++i) {
    half_turns[i] = fraction_of(0.5F * lanes.cell[i]);
  }
  start_waves(half_turns, harmonics.step, &cell, &cell_by);
  for (int j = 0; j < harmonics.count; ++j) {
    const auto number = static_cast<float>(harmonics.number(j));
    const float of_row = kept_of_wave(number * row_turns);
    float* __restrict const real = sums->real[j];
    float* __restrict const imaginary = sums->imaginary[j];
    for (int i = 0; i < kPacketSize; ++i) {
      const float share =
          light[i] * of_row * kept(number * kPiF * lanes.cell[i], cell.imaginary[i]);
      real[i] += share * wave.real[i];
      imaginary[i] += share * wave.imaginary[i];
    }
    turn(&by, &wave);
    turn(&cell_by, &cell);
  }
}

}  // namespace

GLINT_WIDE void add_lobe_row(const ConductorNumbers& metal,
                             const LobeFrame& frame,
                             const ColumnRule& rule,
                             const LobeRow& row,
                             const HarmonicList& harmonics,
                             LobeSums& sums) {
  RowLanes lanes;
  ReflectionLanes reflection;
  alignas(64) float light[kPacketSize];
  for (int first = 0; first < kLobeColumns; first += kPacketSize) {
    place_directions(frame, rule, row, first, &lanes);
    evaluate16(metal, frame.lobes, frame.viewer, lanes.to_light, reflection);
    for (int i = 0; i < kPacketSize; ++i) {
      const float arriving = reflection.value.c[0][i] * lanes.weight[i];
      sums.dark[i] += row.dark * arriving;
      light[i] = (1.0F - row.dark) * arriving;
      sums.even[i] += light[i];
    }
    add_harmonics(lanes, light, harmonics, row.row_turns, &sums);
  }
}

float kept_of_wave(float turns) {
  const float z = kPiF * turns;
  return kept(z, z < kPiF ? std::sin(z) : 0.0F);
}

GLINT_WIDE void add_wave(const float* __restrict real,
                         const float* __restrict imaginary,
                         float by_real,
                         float by_imaginary,
                         int count,
                         float* __restrict value) {
  for (int i = 0; i < count; ++i) {
    value[i] += by_real * real[i] - by_imaginary * imaginary[i];
  }
}

}  // namespace glint

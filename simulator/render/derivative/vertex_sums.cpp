// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sums over frames, at the vertices of a polygon, of the square wave, its integrals and their
// derivatives by the duty. On either side of the falling edge these are polynomials of degree two
// at most in the place within the period, so the weighted sums of its powers, over all frames and
// over the bright ones, give all of them. docs/theory/derivatives.md, "Boundaries of the light".
// Cost: one pass over the frames per vertex, eight at a time; no memory.
#include "simulator/render/derivative/vertex_sums.h"

#include <cstring>

#include "core/simd.h"

namespace glint::gradient_kernels {
namespace {

/// Frames that are added side by side: a vector of the widest machines, several of others.
constexpr int kLanes = 8;
using Lanes = double __attribute__((vector_size(kLanes * sizeof(double))));

/// Sums of weights and of weights times powers of the place in the period: all that the integrals,
/// polynomials on each side of the falling edge, are made of.
struct Powers {
  Lanes place = {};
  Lanes square = {};
  Lanes bright = {};  ///< of the frames in which the vertex is bright, alone
  Lanes bright_place = {};
  Lanes bright_square = {};
};

GLINT_INLINE void load(const double* from, Lanes& to) {
  std::memcpy(&to, from, sizeof(to));
}

/// Some frames.
GLINT_INLINE void add(
    double phase, const double* shift, const double* weight, double duty, Powers& sums) {
  // What is added and taken off again leaves the nearest whole number.
  constexpr double kWholes = 6755399441055744.0;  // 1.5 * 2^52
  Lanes shifts, weights;
  load(shift, shifts);
  load(weight, weights);
  const Lanes moved = phase - shifts;
  const Lanes beside = moved - ((moved + kWholes) - kWholes);
  const Lanes f = beside < 0.0 ? beside + 1.0 : beside;
  const Lanes place = weights * f;
  const Lanes square = place * f;
  const Lanes none = {};
  sums.place += place;
  sums.square += square;
  sums.bright += f < duty ? weights : none;
  sums.bright_place += f < duty ? place : none;
  sums.bright_square += f < duty ? square : none;
}

GLINT_INLINE double total_of(const Lanes& lanes) {
  return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) +
         ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
}

/// With f the place in the period: bright, the integrals of the wave less its mean are
/// (1 - duty) f - mean and ((1 - duty) f / 2 - mean) f; dark, with e = 1 - f to the period's end,
/// duty e - mean and -(duty e / 2 - mean) e.
GLINT_INLINE VertexSums sums_of(const Powers& powers, double weight, double duty) {
  const double rest = 1.0 - duty;
  const double mean = 0.5 * duty * rest;
  const double mean_by_duty = 0.5 - duty;
  const double bright = total_of(powers.bright);
  const double f = total_of(powers.bright_place);
  const double f2 = total_of(powers.bright_square);
  const double dark = weight - bright;
  const double dark_f = total_of(powers.place) - f;
  const double e = dark - dark_f;
  const double e2 = (dark - 2.0 * dark_f) + (total_of(powers.square) - f2);
  return {.wave = rest * bright - duty * dark,
          .first = rest * f + duty * e - mean * weight,
          .second = 0.5 * (rest * f2 - duty * e2) - mean * (f - e),
          .first_by_duty = (e - f) - mean_by_duty * weight,
          .second_by_duty = -0.5 * (f2 + e2) - mean_by_duty * (f - e)};
}

/// The frames that fill no vector, and others of weight 0.
struct LastFrames {
  double shift[kLanes] = {};
  double weight[kLanes] = {};
};

}  // namespace

GLINT_WIDE double weigh_vertices(const double* __restrict phases,
                                 int vertices,
                                 const double* __restrict shift,
                                 const double* __restrict weight,
                                 int frames,
                                 double duty,
                                 VertexSums* __restrict sums) {
  const int whole = frames - frames % kLanes;
  LastFrames last;
  for (int k = whole; k < frames; ++k) {
    last.shift[k - whole] = shift[k];
    last.weight[k - whole] = weight[k];
  }
  Lanes weights, more;
  load(last.weight, weights);
  for (int k = 0; k < whole; k += kLanes) {
    load(weight + k, more);
    weights += more;
  }
  const double all = total_of(weights);
  for (int i = 0; i < vertices; ++i) {
    Powers powers;
    for (int k = 0; k < whole; k += kLanes) {
      add(phases[i], shift + k, weight + k, duty, powers);
    }
    if (whole < frames) {
      add(phases[i], last.shift, last.weight, duty, powers);
    }
    sums[i] = sums_of(powers, all, duty);
  }
  return all;
}

}  // namespace glint::gradient_kernels

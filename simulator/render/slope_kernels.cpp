// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/slope_kernels.h"

#include <cmath>

#define GLINT_WIDE __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))

namespace glint::slope_kernels {
namespace {

constexpr float kNarrow = 1e-6F;

/// The share beyond an edge at distance d and its slopes by d, the larger and the smaller width.
struct Edge {
  float share;
  float by_d;
  float by_major;
  float by_minor;
};

inline __attribute__((always_inline)) Edge edge_at(
    float d, float outer, float inner, float per_major, float per_minor) {
  const float size = d < 0.0F ? -d : d;
  const bool is_beyond = size >= outer;
  const float t = is_beyond ? outer : size;
  const float over = t > inner ? t - inner : 0.0F;
  const float ratio = over * per_minor;
  const float half = 0.5F * over * ratio * per_major;  // over^2 / (2 major minor)
  const float share = t * per_major - half;
  const float by_d = is_beyond ? 0.0F : per_major * (1.0F - ratio);
  const float by_major = is_beyond ? 0.0F : per_major * (half - t * per_major + 0.5F * ratio);
  const float by_minor = is_beyond ? 0.0F : per_minor * half - 0.5F * ratio * per_major;
  const float sign = d < 0.0F ? -1.0F : 1.0F;
  return {sign * share, by_d, sign * by_major, sign * by_minor};
}

}  // namespace

GLINT_WIDE void add_box_slopes(const float* __restrict v,
                               const float* __restrict gx,
                               const float* __restrict gy,
                               const float* __restrict weight,
                               int count,
                               float shift,
                               float duty,
                               const BoxSlopes& out) {
  float* __restrict by_v = out.v;
  float* __restrict by_gx = out.gx;
  float* __restrict by_gy = out.gy;
  float* __restrict by_duty = out.duty;
  float* __restrict share = out.share;
  float* __restrict weights = out.weight;
  for (int i = 0; i < count; ++i) {
    const float a = gx[i] < 0.0F ? -gx[i] : gx[i];
    const float b = gy[i] < 0.0F ? -gy[i] : gy[i];
    const bool x_is_major = a >= b;
    const float large = x_is_major ? a : b;
    const float small = x_is_major ? b : a;
    const float major = large > kNarrow ? large : kNarrow;
    const float minor = small > kNarrow ? small : kNarrow;
    const float outer = 0.5F * (major + minor);
    const float inner = 0.5F * (major - minor);
    const float per_major = 1.0F / major;
    const float per_minor = 1.0F / minor;
    const float moved = v[i] - shift;
    const float f = moved - std::floor(moved);
    const Edge rise = edge_at(f, outer, inner, per_major, per_minor);
    const Edge fall = edge_at(f - duty, outer, inner, per_major, per_minor);
    const Edge next = edge_at(f - 1.0F, outer, inner, per_major, per_minor);
    const float by_major = rise.by_major - fall.by_major + next.by_major;
    const float by_minor = rise.by_minor - fall.by_minor + next.by_minor;
    const float x_sign = gx[i] < 0.0F ? -1.0F : 1.0F;
    const float y_sign = gy[i] < 0.0F ? -1.0F : 1.0F;
    by_v[i] += weight[i] * (rise.by_d - fall.by_d + next.by_d);
    by_gx[i] += weight[i] * x_sign * (x_is_major ? by_major : by_minor);
    by_gy[i] += weight[i] * y_sign * (x_is_major ? by_minor : by_major);
    by_duty[i] += weight[i] * fall.by_d;
    share[i] += weight[i] * (0.5F + rise.share - fall.share + next.share);
    weights[i] += weight[i];
  }
}

VertexSums weigh_vertex(
    double phase, const double* shift, const double* weight, int frames, double duty) {
  VertexSums sums;
  const double rest = 1.0 - duty;
  const double mean = 0.5 * duty * rest;
  const double mean_by_duty = 0.5 - duty;
  for (int k = 0; k < frames; ++k) {
    const double moved = phase - shift[k];
    const double f = moved - std::floor(moved);
    const double to_end = 1.0 - f;
    const bool is_bright = f < duty;
    sums.wave += weight[k] * (is_bright ? rest : -duty);
    sums.first += weight[k] * ((is_bright ? rest * f : duty * to_end) - mean);
    sums.second += weight[k] * (is_bright ? (0.5 * rest * f - mean) * f
                                          : -(0.5 * duty * to_end - mean) * to_end);
    sums.first_by_duty += weight[k] * ((is_bright ? -f : to_end) - mean_by_duty);
    sums.second_by_duty += weight[k] * (is_bright ? (-0.5 * f - mean_by_duty) * f
                                                  : -(0.5 * to_end - mean_by_duty) * to_end);
  }
  return sums;
}

}  // namespace glint::slope_kernels

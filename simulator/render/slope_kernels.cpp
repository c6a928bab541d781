// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/slope_kernels.h"

#include <cmath>

#include "simulator/render/footprint_kernels.h"

#define GLINT_WIDE __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))

namespace glint::slope_kernels {
namespace {

constexpr float kNarrow = 1e-6F;

inline __attribute__((always_inline)) float absolute(float x) {
  return x < 0.0F ? -x : x;
}

}  // namespace

/// Restricted pointers must be parameters: the compiler believes them only there.
GLINT_WIDE static void add_slopes(const float* __restrict v,
                                  const float* __restrict gx,
                                  const float* __restrict gy,
                                  const float* __restrict weight,
                                  int count,
                                  float shift,
                                  float duty,
                                  float* __restrict by_v,
                                  float* __restrict by_gx,
                                  float* __restrict by_gy,
                                  float* __restrict by_duty,
                                  float* __restrict share,
                                  float* __restrict weights) {
  // Everything is spelt out three times, for the rising, the falling and the next edge: the share
  // beyond an edge at distance d and its slopes by d, the larger and the smaller width.
  for (int i = 0; i < count; ++i) {
    const float a = absolute(gx[i]);
    const float b = absolute(gy[i]);
    const float large = a < b ? b : a;
    const float small = a < b ? a : b;
    const float major = large > kNarrow ? large : kNarrow;
    const float minor = small > kNarrow ? small : kNarrow;
    const float outer = 0.5F * (major + minor);
    const float inner = 0.5F * (major - minor);
    const float per_major = 1.0F / major;
    const float per_minor = 1.0F / minor;
    const float moved = v[i] - shift;
    const float rise = moved - std::floor(moved);
    const float fall = rise - duty;
    const float next = 1.0F - rise;  // the next rising edge, seen from its other side

    const float rise_in = rise < outer ? 1.0F : 0.0F;
    const float rise_t = rise < outer ? rise : outer;
    const float rise_over = (rise_t > inner ? rise_t - inner : 0.0F) * per_minor;
    const float rise_half = 0.5F * rise_over * rise_over * minor * per_major;
    const float fall_size = absolute(fall);
    const float fall_sign = fall < 0.0F ? -1.0F : 1.0F;
    const float fall_in = fall_size < outer ? 1.0F : 0.0F;
    const float fall_t = fall_size < outer ? fall_size : outer;
    const float fall_over = (fall_t > inner ? fall_t - inner : 0.0F) * per_minor;
    const float fall_half = 0.5F * fall_over * fall_over * minor * per_major;
    const float next_in = next < outer ? 1.0F : 0.0F;
    const float next_t = next < outer ? next : outer;
    const float next_over = (next_t > inner ? next_t - inner : 0.0F) * per_minor;
    const float next_half = 0.5F * next_over * next_over * minor * per_major;

    const float rise_by_d = rise_in * (1.0F - rise_over);
    const float fall_by_d = fall_in * (1.0F - fall_over);
    const float next_by_d = next_in * (1.0F - next_over);
    const float rise_by_major = rise_in * (rise_half - rise_t * per_major + 0.5F * rise_over);
    const float fall_by_major = fall_in * (fall_half - fall_t * per_major + 0.5F * fall_over);
    const float next_by_major = next_in * (next_half - next_t * per_major + 0.5F * next_over);
    const float rise_by_minor = rise_in * (per_minor * rise_half - 0.5F * rise_over * per_major);
    const float fall_by_minor = fall_in * (per_minor * fall_half - 0.5F * fall_over * per_major);
    const float next_by_minor = next_in * (per_minor * next_half - 0.5F * next_over * per_major);

    const float by_major = per_major * (rise_by_major - fall_sign * fall_by_major - next_by_major);
    const float by_minor = rise_by_minor - fall_sign * fall_by_minor - next_by_minor;
    const float bright = 0.5F + (rise_t * per_major - rise_half) -
                         fall_sign * (fall_t * per_major - fall_half) -
                         (next_t * per_major - next_half);
    const float x_sign = gx[i] < 0.0F ? -1.0F : 1.0F;
    const float y_sign = gy[i] < 0.0F ? -1.0F : 1.0F;
    const float by_x = a < b ? by_minor : by_major;
    const float by_y = a < b ? by_major : by_minor;
    by_v[i] += weight[i] * per_major * (rise_by_d - fall_by_d + next_by_d);
    by_gx[i] += weight[i] * x_sign * by_x;
    by_gy[i] += weight[i] * y_sign * by_y;
    by_duty[i] += weight[i] * per_major * fall_by_d;
    share[i] += weight[i] * bright;
    weights[i] += weight[i];
  }
}

namespace {

constexpr int kLanes = 16;

GLINT_WIDE void multiply_by(const float* __restrict weight, int count, float* __restrict values) {
  for (int i = 0; i < count; ++i) {
    values[i] = weight[i] * values[i];
  }
}

/// Values of a table, weighted.
void multiply_look_up(
    const float* w, const float* weight, int count, const Pieces& table, float* products) {
  footprint_kernels::look_up(w, count, table.coefficients, table.count, table.per_unit, products);
  multiply_by(weight, count, products);
}

GLINT_WIDE void slopes_of_widths(const float* __restrict w,
                                 const float* __restrict gx,
                                 const float* __restrict gy,
                                 float variance_px2,
                                 int count,
                                 float* __restrict by_gx,
                                 float* __restrict by_gy) {
  for (int i = 0; i < count; ++i) {
    const float by_width = by_gx[i];
    const float factor = w[i] > 0.0F ? by_width * variance_px2 / w[i] : 0.0F;
    by_gx[i] = factor * gx[i];
    by_gy[i] = factor * gy[i];
  }
}

/// Over lanes that are added at the end: the same bits for any instruction set.
GLINT_WIDE double sum_of(const float* __restrict values, int count) {
  float lanes[kLanes] = {};
  int i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) {
      lanes[lane] += values[i + lane];
    }
  }
  double sum = 0.0;
  for (; i < count; ++i) {
    sum += static_cast<double>(values[i]);
  }
  for (const float lane : lanes) {
    sum += static_cast<double>(lane);
  }
  return sum;
}

GLINT_WIDE double sum_of_products(const float* __restrict a, const float* __restrict b, int count) {
  float lanes[kLanes] = {};
  int i = 0;
  for (; i + kLanes <= count; i += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) {
      lanes[lane] += a[i + lane] * b[i + lane];
    }
  }
  double sum = 0.0;
  for (; i < count; ++i) {
    sum += static_cast<double>(a[i] * b[i]);
  }
  for (const float lane : lanes) {
    sum += static_cast<double>(lane);
  }
  return sum;
}

GLINT_WIDE void add_left_corners(const float* __restrict by_gx,
                                 const float* __restrict by_gy,
                                 int count,
                                 float half,
                                 float* __restrict top,
                                 float* __restrict bottom) {
  for (int i = 0; i < count; ++i) {
    top[i] -= half * (by_gx[i] + by_gy[i]);
    bottom[i] += half * (by_gy[i] - by_gx[i]);
  }
}

GLINT_WIDE void add_right_corners(const float* __restrict by_gx,
                                  const float* __restrict by_gy,
                                  int count,
                                  float half,
                                  float* __restrict top,
                                  float* __restrict bottom) {
  for (int i = 0; i < count; ++i) {
    top[i] += half * (by_gx[i] - by_gy[i]);
    bottom[i] += half * (by_gx[i] + by_gy[i]);
  }
}

constexpr int kTile = 1024;

}  // namespace

double weighted_look_up(const float* w, const float* weight, int count, const Pieces& table) {
  float products[kTile];
  double sum = 0.0;
  for (int begin = 0; begin < count; begin += kTile) {
    const int size = count - begin < kTile ? count - begin : kTile;
    multiply_look_up(w + begin, weight + begin, size, table, products);
    sum += sum_of(products, size);
  }
  return sum;
}

double width_slopes(const float* w,
                    const float* gx,
                    const float* gy,
                    const float* weight,
                    int count,
                    const Pieces& slope,
                    float variance_px2,
                    float* by_gx,
                    float* by_gy) {
  multiply_look_up(w, weight, count, slope, by_gx);
  slopes_of_widths(w, gx, gy, variance_px2, count, by_gx, by_gy);
  return sum_of_products(by_gx, gx, count) + sum_of_products(by_gy, gy, count);
}

void add_to_corners(
    const float* by_gx, const float* by_gy, int count, float half, float* top, float* bottom) {
  add_left_corners(by_gx, by_gy, count, half, top, bottom);
  add_right_corners(by_gx, by_gy, count, half, top + 1, bottom + 1);
}

void add_box_slopes(const float* v,
                    const float* gx,
                    const float* gy,
                    const float* weight,
                    int count,
                    float shift,
                    float duty,
                    const BoxSlopes& out) {
  add_slopes(v,
             gx,
             gy,
             weight,
             count,
             shift,
             duty,
             out.v,
             out.gx,
             out.gy,
             out.duty,
             out.share,
             out.weight);
}

/// As add_slopes(), folded around the middle of the bright stripe.
GLINT_WIDE static void add_folded_slopes(const float* __restrict v,
                                         const float* __restrict gx,
                                         const float* __restrict gy,
                                         const float* __restrict weight,
                                         int count,
                                         float shift,
                                         float duty,
                                         float* __restrict by_v,
                                         float* __restrict by_gx,
                                         float* __restrict by_gy,
                                         float* __restrict by_duty,
                                         float* __restrict share,
                                         float* __restrict weights) {
  const float half_duty = 0.5F * duty;
  const float to_middle = shift + half_duty;
  for (int i = 0; i < count; ++i) {
    const float a = absolute(gx[i]);
    const float b = absolute(gy[i]);
    const float large = a < b ? b : a;
    const float small = a < b ? a : b;
    const float major = large > kNarrow ? large : kNarrow;
    const float minor = small > kNarrow ? small : kNarrow;
    const float outer = 0.5F * (major + minor);
    const float inner = 0.5F * (major - minor);
    const float per_major = 1.0F / major;
    const float per_minor = 1.0F / minor;
    const float moved = v[i] - to_middle;
    const float turn = moved - std::floor(moved + 0.5F);
    const float inside = half_duty - absolute(turn);  // how far in the bright stripe
    const float size = absolute(inside);
    const float sign = inside < 0.0F ? -1.0F : 1.0F;
    const float is_near = size < outer ? 1.0F : 0.0F;
    const float t = size < outer ? size : outer;
    const float over = (t > inner ? t - inner : 0.0F) * per_minor;
    const float half = 0.5F * over * over * minor * per_major;
    const float near_weight = weight[i] * is_near;
    const float by_inside = near_weight * per_major * (1.0F - over);
    const float by_major = sign * near_weight * per_major * (half - t * per_major + 0.5F * over);
    const float by_minor = sign * near_weight * (per_minor * half - 0.5F * over * per_major);
    const float x_sign = gx[i] < 0.0F ? -1.0F : 1.0F;
    const float y_sign = gy[i] < 0.0F ? -1.0F : 1.0F;
    by_v[i] += turn > 0.0F ? -by_inside : by_inside;
    by_gx[i] += x_sign * (a < b ? by_minor : by_major);
    by_gy[i] += y_sign * (a < b ? by_major : by_minor);
    by_duty[i] += turn > 0.0F ? by_inside : 0.0F;
    share[i] += weight[i] * (0.5F + sign * (t * per_major - half));
    weights[i] += weight[i];
  }
}

void add_narrow_slopes(const float* v,
                       const float* gx,
                       const float* gy,
                       const float* weight,
                       int count,
                       float shift,
                       float duty,
                       const BoxSlopes& out) {
  add_folded_slopes(v,
                    gx,
                    gy,
                    weight,
                    count,
                    shift,
                    duty,
                    out.v,
                    out.gx,
                    out.gy,
                    out.duty,
                    out.share,
                    out.weight);
}

GLINT_WIDE void multiply(const float* __restrict a,
                         const float* __restrict b,
                         int count,
                         float* __restrict out) {
  for (int i = 0; i < count; ++i) {
    out[i] = a[i] * b[i];
  }
}

GLINT_WIDE void add_scaled(const float* __restrict from,
                           int count,
                           float factor,
                           float* __restrict to) {
  for (int i = 0; i < count; ++i) {
    to[i] += factor * from[i];
  }
}

GLINT_WIDE void unclipped_slopes(const float* __restrict radiance,
                                 int count,
                                 float linear,
                                 float* __restrict slopes) {
  for (int i = 0; i < count; ++i) {
    slopes[i] = linear * radiance[i] < 1.0F ? linear : 0.0F;
  }
}

GLINT_WIDE static void weigh(const float* __restrict by_aspect,
                             int count,
                             float factor,
                             float* __restrict by) {
  for (int i = 0; i < count; ++i) {
    by[i] *= by_aspect[i] * factor;
  }
}

GLINT_WIDE double exact_sum(const float* values, std::size_t count) {
  constexpr std::size_t kSums = 8;
  double sums[kSums] = {};
  std::size_t i = 0;
  for (; i + kSums <= count; i += kSums) {
    for (std::size_t lane = 0; lane < kSums; ++lane) {
      sums[lane] += static_cast<double>(values[i + lane]);
    }
  }
  double sum = 0.0;
  for (; i < count; ++i) {
    sum += static_cast<double>(values[i]);
  }
  for (const double lane : sums) {
    sum += lane;
  }
  return sum;
}

double weigh_slopes(const float* by_aspect, const float* grey, int count, float factor, float* by) {
  weigh(by_aspect, count, factor, by);
  return sum_of_products(by, grey, count);
}

namespace {

/// Frames that are added side by side.
constexpr int kFrameLanes = 8;

struct VertexLanes {
  double wave[kFrameLanes] = {};
  double first[kFrameLanes] = {};
  double second[kFrameLanes] = {};
  double first_by_duty[kFrameLanes] = {};
  double second_by_duty[kFrameLanes] = {};
};

__attribute__((always_inline)) inline void add_to_lane(
    double moved, double weight, double duty, int lane, VertexLanes& lanes) {
  const double rest = 1.0 - duty;
  const double mean = 0.5 * duty * rest;
  const double mean_by_duty = 0.5 - duty;
  const double f = moved - std::floor(moved);
  const double to_end = 1.0 - f;
  const bool is_bright = f < duty;
  lanes.wave[lane] += weight * (is_bright ? rest : -duty);
  lanes.first[lane] += weight * ((is_bright ? rest * f : duty * to_end) - mean);
  lanes.second[lane] +=
      weight * (is_bright ? (0.5 * rest * f - mean) * f : -(0.5 * duty * to_end - mean) * to_end);
  lanes.first_by_duty[lane] += weight * ((is_bright ? -f : to_end) - mean_by_duty);
  lanes.second_by_duty[lane] += weight * (is_bright ? (-0.5 * f - mean_by_duty) * f
                                                    : -(0.5 * to_end - mean_by_duty) * to_end);
}

GLINT_WIDE void add_to_lanes(double phase,
                             const double* __restrict shift,
                             const double* __restrict weight,
                             int frames,
                             double duty,
                             VertexLanes& lanes) {
  VertexLanes sums;
  int k = 0;
  for (; k + kFrameLanes <= frames; k += kFrameLanes) {
    for (int lane = 0; lane < kFrameLanes; ++lane) {
      add_to_lane(phase - shift[k + lane], weight[k + lane], duty, lane, sums);
    }
  }
  for (int lane = 0; k + lane < frames; ++lane) {
    add_to_lane(phase - shift[k + lane], weight[k + lane], duty, lane, sums);
  }
  lanes = sums;
}

double total_of(const double* lanes) {
  return ((lanes[0] + lanes[1]) + (lanes[2] + lanes[3])) +
         ((lanes[4] + lanes[5]) + (lanes[6] + lanes[7]));
}

}  // namespace

VertexSums weigh_vertex(
    double phase, const double* shift, const double* weight, int frames, double duty) {
  VertexLanes lanes;
  add_to_lanes(phase, shift, weight, frames, duty, lanes);
  return {.wave = total_of(lanes.wave),
          .first = total_of(lanes.first),
          .second = total_of(lanes.second),
          .first_by_duty = total_of(lanes.first_by_duty),
          .second_by_duty = total_of(lanes.second_by_duty)};
}

}  // namespace glint::slope_kernels

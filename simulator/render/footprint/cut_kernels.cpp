// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pixels that one straight boundary of the light crosses (an edge of the slot, or the rim), up to
// 64 at a time. The part of the pixel on the lit side is a convex polygon; the divergence theorem
// turns the integral of the stripes over it into a sum, over at most six vertices, of the second
// integral J of the square wave. So the polygon is cut once, and each frame costs six evaluations
// of J per pixel. Instead of branching, each edge of the pixel's square contributes with weights 0
// or 1. PixelPolygon and StripeSum (stripe_integral.h) do the same for any polygon and are the
// reference of the tests. Own derivation: docs/theory/footprints.md, "Polygons". Memory: about 16
// kB for a batch.
#include "simulator/render/footprint/cut_kernels.h"

#include <bit>
#include <cstddef>

#include "core/simd.h"
#include "simulator/render/footprint/footprint_lane.h"
#include "simulator/render/footprint/stripe_integral.h"

namespace glint::cut_kernels {
namespace {

using footprint_lane::absolute;
using footprint_lane::first_integral;
using footprint_lane::second_integral;

/// Least squares through four corners.
struct Linear {
  double value, dx, dy;
};

GLINT_INLINE Linear linear_at(const Corners& corners, int i) {
  const auto a = static_cast<double>(corners.at[0][i]);
  const auto b = static_cast<double>(corners.at[1][i]);
  const auto c = static_cast<double>(corners.at[2][i]);
  const auto d = static_cast<double>(corners.at[3][i]);
  return {0.25 * (a + b + c + d), 0.5 * (b + d - a - c), 0.5 * (c + d - a - b)};
}

struct Range {
  float low, high;
};

GLINT_INLINE float smaller(float a, float b) {
  return a < b ? a : b;
}

GLINT_INLINE float larger(float a, float b) {
  return a < b ? b : a;
}

GLINT_INLINE Range range_at(const Corners& corners, int i) {
  const float* a = corners.at[0];
  const float* b = corners.at[1];
  const float* c = corners.at[2];
  const float* d = corners.at[3];
  return {smaller(smaller(a[i], b[i]), smaller(c[i], d[i])),
          larger(larger(a[i], b[i]), larger(c[i], d[i]))};
}

/// How far a linear function goes from its middle; rounding errors allowed for.
GLINT_INLINE double reach_of(const Linear& f) {
  constexpr double kRounding = 1e-12;
  const double reach = 0.5 * (absolute(f.dx) + absolute(f.dy));
  return reach + kRounding * (absolute(f.value) + reach);
}

}  // namespace

GLINT_WIDE void gather(const float* __restrict values,
                       const std::int32_t* __restrict first,
                       std::int32_t below,
                       int count,
                       Corners& corners) {
  float* __restrict a = corners.at[0];
  float* __restrict b = corners.at[1];
  float* __restrict c = corners.at[2];
  float* __restrict d = corners.at[3];
  for (int i = 0; i < count; ++i) {
    a[i] = values[first[i]];
    b[i] = values[first[i] + 1];
    c[i] = values[first[i] + below];
    d[i] = values[first[i] + below + 1];
  }
}

GLINT_WIDE void scale(const Corners& factors, int count, Corners& values) {
  for (int k = 0; k < 4; ++k) {
    const float* __restrict factor = factors.at[k];
    float* __restrict value = values.at[k];
    for (int i = 0; i < count; ++i) {
      value[i] *= factor[i];
    }
  }
}

GLINT_WIDE void find_cuts(const CornerBatch& pixels,
                          const CutLimits& limits,
                          LinearBatch& inside,
                          unsigned char* __restrict is_simple) {
  const CutLimits l = limits;
  const int count = pixels.count;
  double* __restrict value = inside.value;
  double* __restrict dx = inside.dx;
  double* __restrict dy = inside.dy;
  int simple[kBatch];
  for (int i = 0; i < count; ++i) {
    const Linear margin = linear_at(pixels.margin_mm, i);
    const Linear y = linear_at(pixels.y_mm, i);
    const Range y_mm = range_at(pixels.y_mm, i);
    const double margin_reach = reach_of(margin);
    const bool is_at_rim = margin.value - margin_reach < 0.0;
    const bool is_beside = (static_cast<double>(y_mm.low) >= l.half_slot_mm) |
                           (static_cast<double>(y_mm.high) <= -l.half_slot_mm);
    const double to_right = y.value - l.half_slot_mm;
    const double to_left = -l.half_slot_mm - y.value;
    const bool is_right = to_right + reach_of({to_right, y.dx, y.dy}) >= 0.0;
    const bool is_left = to_left + reach_of({to_left, y.dx, y.dy}) >= 0.0;
    const double beside_value = is_at_rim ? margin.value : 1.0;
    const double beside_dx = is_at_rim ? margin.dx : 0.0;
    const double beside_dy = is_at_rim ? margin.dy : 0.0;
    value[i] = is_beside ? beside_value : (is_left ? to_left : to_right);
    dx[i] = is_beside ? beside_dx : (is_left ? -y.dx : y.dx);
    dy[i] = is_beside ? beside_dy : (is_left ? -y.dy : y.dy);
    const bool is_one_line = is_beside | (!is_at_rim & !(is_left & is_right));
    simple[i] = is_one_line ? 1 : 0;
  }
  for (int i = 0; i < count; ++i) {
    const Range x_mm = range_at(pixels.x_mm, i);
    const Range margin_mm = range_at(pixels.margin_mm, i);
    const bool is_on_wall = margin_mm.low >= l.nowhere_mm;
    const bool is_inside_ends = (x_mm.low > l.x_low_mm) & (x_mm.high < l.x_high_mm);
    is_simple[i] = ((simple[i] != 0) & is_on_wall & is_inside_ends) ? 1 : 0;
  }
}

namespace {

/// A corner of the pixel's square.
struct Corner {
  double x, y;
  double phase;
  double inside;   ///< of the boundary's function
  double is_kept;  ///< 1 or 0
};

GLINT_INLINE Corner corner_at(double x, double y, const Linear& phase, const Linear& inside) {
  const double value = inside.value + x * inside.dx + y * inside.dy;
  return {x, y, phase.value + x * phase.dx + y * phase.dy, value, value >= 0.0 ? 1.0 : 0.0};
}

/// What an edge adds: `second` to its end and takes from its beginning, `first` to both.
struct EdgeTerms {
  double second, first;
};

/// Where the boundary crosses the square's border; x and y are sums, as only one edge leaves and
/// only one enters the part that is kept.
struct Crossing {
  double x = 0.0, y = 0.0, second = 0.0, first = 0.0;
};

/// What is summed up along the border.
struct Border {
  Crossing leaving, entering;
  double twice_area = 0.0;
};

struct VertexTerms {
  double second = 0.0, first = 0.0;
};

/// One edge of the square, from a to b: what of it is kept, as far as it is. Zeros and ones instead
/// of branches.
/// @param per_edge   (g x e) / |g|^2 of the whole edge e
/// @param per_phase  the same over the phase's difference along it
GLINT_INLINE void add_edge(const Corner& a,
                           const Corner& b,
                           double per_edge,
                           double per_phase,
                           VertexTerms& at_a,
                           VertexTerms& at_b,
                           Border& border) {
  const double any = a.is_kept + b.is_kept - a.is_kept * b.is_kept;
  const double leaves = a.is_kept * (1.0 - b.is_kept);
  const double enters = b.is_kept * (1.0 - a.is_kept);
  const double s = a.inside / (leaves + enters > 0.5 ? a.inside - b.inside : 1.0);
  const double from = (1.0 - a.is_kept) * s;
  const double to = b.is_kept + (1.0 - b.is_kept) * s;
  const double length = to - from;
  const bool is_level = absolute((b.phase - a.phase) * length) <= kLevelEdge;
  const double second = is_level ? 0.0 : any * per_phase;
  const double first = is_level ? 0.5 * any * length * per_edge : 0.0;
  const double x = a.x + s * (b.x - a.x);
  const double y = a.y + s * (b.y - a.y);
  border.twice_area += any * length * (a.x * b.y - b.x * a.y);
  border.leaving.x += leaves * x;
  border.leaving.y += leaves * y;
  border.leaving.second += leaves * second;
  border.leaving.first += leaves * first;
  border.entering.x += enters * x;
  border.entering.y += enters * y;
  border.entering.second -= enters * second;
  border.entering.first += enters * first;
  at_a.second -= a.is_kept * second;
  at_a.first += a.is_kept * first;
  at_b.second += b.is_kept * second;
  at_b.first += b.is_kept * first;
}

}  // namespace

GLINT_WIDE void cut(const CornerBatch& __restrict pixels,
                    const LinearBatch& __restrict inside,
                    double offset_mm,
                    double per_mm,
                    CutSums& __restrict sums) {
  const int count = pixels.count;
  double level = 0.0;
  for (int i = 0; i < count; ++i) {
    Linear v = linear_at(pixels.stripes_mm, i);
    v.value = (v.value - offset_mm) * per_mm;
    const double dx = v.dx * per_mm;
    const double dy = v.dy * per_mm;
    const bool is_flat = dx * dx + dy * dy < kFlatPhase * kFlatPhase;
    v.dx = is_flat ? kFlatPhase : dx;
    v.dy = is_flat ? 0.0 : dy;
    const Linear f = {inside.value[i], inside.dx[i], inside.dy[i]};
    const double per_squared = 1.0 / (v.dx * v.dx + v.dy * v.dy);
    const double across = v.dx * per_squared;
    const double along = v.dy * per_squared;
    const double per_x = -along / v.dx;
    const double per_y = across / v.dy;
    const Corner a = corner_at(-0.5, -0.5, v, f);
    const Corner b = corner_at(0.5, -0.5, v, f);
    const Corner c = corner_at(0.5, 0.5, v, f);
    const Corner d = corner_at(-0.5, 0.5, v, f);
    VertexTerms at_a, at_b, at_c, at_d;
    Border border;
    add_edge(a, b, -along, per_x, at_a, at_b, border);
    add_edge(b, c, across, per_y, at_b, at_c, border);
    add_edge(c, d, along, per_x, at_c, at_d, border);
    add_edge(d, a, -across, per_y, at_d, at_a, border);
    const Crossing& from = border.leaving;
    const Crossing& to = border.entering;
    const double weight = across * (to.y - from.y) - along * (to.x - from.x);
    const double from_phase = v.value + from.x * v.dx + from.y * v.dy;
    const double to_phase = v.value + to.x * v.dx + to.y * v.dy;
    const double difference = to_phase - from_phase;
    const bool is_level = absolute(difference) <= kLevelEdge;
    const double second = is_level ? 0.0 : weight / difference;
    const double first = is_level ? 0.5 * weight : 0.0;
    sums.area[i] = 0.5 * (border.twice_area + from.x * to.y - to.x * from.y);
    sums.phase[0][i] = a.phase;
    sums.phase[1][i] = b.phase;
    sums.phase[2][i] = c.phase;
    sums.phase[3][i] = d.phase;
    sums.phase[4][i] = from_phase;
    sums.phase[5][i] = to_phase;
    sums.second[0][i] = at_a.second;
    sums.second[1][i] = at_b.second;
    sums.second[2][i] = at_c.second;
    sums.second[3][i] = at_d.second;
    sums.second[4][i] = from.second - second;
    sums.second[5][i] = to.second + second;
    sums.first[0][i] = at_a.first;
    sums.first[1][i] = at_b.first;
    sums.first[2][i] = at_c.first;
    sums.first[3][i] = at_d.first;
    sums.first[4][i] = from.first + first;
    sums.first[5][i] = to.first + first;
  }
  sums.has_first = false;
  for (const auto& first : sums.first) {
    for (int i = 0; i < count; ++i) {
      level = absolute(first[i]) > level ? absolute(first[i]) : level;
    }
  }
  sums.has_first = level > 0.0;
}

namespace {

/// share += second * J of one vertex.
GLINT_WIDE void add_second(const double* __restrict phase,
                           const double* __restrict second,
                           int count,
                           double shift,
                           double duty,
                           double* __restrict share) {
  for (int i = 0; i < count; ++i) {
    share[i] += second[i] * second_integral(phase[i] - shift, duty);
  }
}

/// The same with I.
GLINT_WIDE void add_first(const double* __restrict phase,
                          const double* __restrict first,
                          int count,
                          double shift,
                          double duty,
                          double* __restrict share) {
  for (int i = 0; i < count; ++i) {
    share[i] += first[i] * first_integral(phase[i] - shift, duty);
  }
}

GLINT_WIDE void finish(const Corners& gain,
                       const double* __restrict area,
                       const double* __restrict share,
                       int count,
                       double dark,
                       double bright,
                       float* __restrict out) {
  const float* __restrict a = gain.at[0];
  const float* __restrict b = gain.at[1];
  const float* __restrict c = gain.at[2];
  const float* __restrict d = gain.at[3];
  for (int i = 0; i < count; ++i) {
    const double mean = 0.25 * (static_cast<double>(a[i]) + static_cast<double>(b[i]) +
                                static_cast<double>(c[i]) + static_cast<double>(d[i]));
    out[i] = static_cast<float>(mean * (dark * area[i] + bright * share[i]));
  }
}

}  // namespace

void integrate(const CornerBatch& pixels, const CutSums& sums, const CutFrame& frame, float* out) {
  alignas(64) double share[kBatch];
  for (int i = 0; i < pixels.count; ++i) {
    share[i] = frame.duty * sums.area[i];
  }
  for (int k = 0; k < kVertices; ++k) {
    add_second(sums.phase[k], sums.second[k], pixels.count, frame.shift, frame.duty, share);
    if (sums.has_first) {
      add_first(sums.phase[k], sums.first[k], pixels.count, frame.shift, frame.duty, share);
    }
  }
  finish(pixels.gain, sums.area, share, pixels.count, frame.dark, frame.bright, out);
}

GLINT_WIDE void mean_gains(const CornerBatch& __restrict pixels,
                           const CutLimits& limits,
                           float* __restrict gain,
                           unsigned char* __restrict is_clear) {
  constexpr float kFar = 1e30F;
  const auto half_slot_mm = static_cast<float>(limits.half_slot_mm);
  const float x_low_mm = limits.x_low_mm;
  const float x_high_mm = limits.x_high_mm;
  const int count = pixels.count;
  std::int32_t clear[kBatch];
  for (int i = 0; i < count; ++i) {
    float seen = 0.0F;
    float sum = 0.0F;
    Range x = {kFar, -kFar};
    Range y = {kFar, -kFar};
    Range margin = {kFar, -kFar};
    for (int k = 0; k < 4; ++k) {
      const float at = pixels.gain.at[k][i];
      const float at_x = pixels.x_mm.at[k][i];
      const float at_y = pixels.y_mm.at[k][i];
      const float at_margin = pixels.margin_mm.at[k][i];
      const bool is_seen = at > 0.0F;
      seen += is_seen ? 1.0F : 0.0F;
      sum += is_seen ? at : 0.0F;
      x.low = (is_seen & (at_x < x.low)) ? at_x : x.low;
      x.high = (is_seen & (at_x > x.high)) ? at_x : x.high;
      y.low = (is_seen & (at_y < y.low)) ? at_y : y.low;
      y.high = (is_seen & (at_y > y.high)) ? at_y : y.high;
      margin.low = (is_seen & (at_margin < margin.low)) ? at_margin : margin.low;
      margin.high = (is_seen & (at_margin > margin.high)) ? at_margin : margin.high;
    }
    const float x_size = x.high - x.low;
    const float y_size = y.high - y.low;
    const bool is_beside = (y.low - y_size >= half_slot_mm) | (y.high + y_size <= -half_slot_mm);
    const bool is_on_wall = margin.low >= margin.high - margin.low;
    const bool is_inside = (x.low - x_size > x_low_mm) & (x.high + x_size < x_high_mm);
    gain[i] = sum / (seen > 1.0F ? seen : 1.0F);
    clear[i] = ((seen > 1.5F) & is_beside & is_on_wall & is_inside) ? 1 : 0;
  }
  for (int i = 0; i < count; ++i) {
    is_clear[i] = static_cast<unsigned char>(clear[i]);
  }
}

namespace {

constexpr int kLanes = 16;

/// In pairs, so that additions do not wait for each other.
GLINT_INLINE float sum_of(const float* lanes) {
  float eight[8];
  for (int i = 0; i < 8; ++i) {
    eight[i] = lanes[i] + lanes[i + 8];
  }
  float four[4];
  for (int i = 0; i < 4; ++i) {
    four[i] = eight[i] + eight[i + 4];
  }
  return (four[0] + four[2]) + (four[1] + four[3]);
}

}  // namespace

GLINT_WIDE float sum_simple(const float* __restrict values,
                            const unsigned char* __restrict is_simple) {
  float lanes[kLanes] = {};
  for (int i = 0; i < kBatch; i += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) {
      lanes[lane] += is_simple[i + lane] != 0 ? values[i + lane] : 0.0F;
    }
  }
  return sum_of(lanes);
}

namespace {

/// The smallest of values, lane by lane, where there is weight.
struct Lowest {
  float lanes[kLanes];

  GLINT_INLINE void add(int lane, float value, float weight) {
    const bool is_lower = (weight > 0.0F) & (value < lanes[lane]);
    lanes[lane] = is_lower ? value : lanes[lane];
  }

  GLINT_INLINE float value() const {
    float low = lanes[0];
    for (const float lane : lanes) {
      low = lane < low ? lane : low;
    }
    return low;
  }
};

}  // namespace

GLINT_WIDE PlaceLimits find_limits(const float* __restrict x_mm,
                                   const float* __restrict y_mm,
                                   const float* __restrict margin_mm,
                                   const float* __restrict weight,
                                   int count) {
  constexpr float kHuge = 3e38F;
  Lowest x, to_x, y, to_y, margin;
  for (int lane = 0; lane < kLanes; ++lane) {
    x.lanes[lane] = to_x.lanes[lane] = y.lanes[lane] = to_y.lanes[lane] = kHuge;
    margin.lanes[lane] = kHuge;
  }
  const int whole = count < kLanes ? 0 : count;
  for (int at = 0; at < count - whole; ++at) {
    x.add(at, x_mm[at], weight[at]);
    to_x.add(at, -x_mm[at], weight[at]);
    y.add(at, y_mm[at], weight[at]);
    to_y.add(at, -y_mm[at], weight[at]);
    margin.add(at, margin_mm[at], weight[at]);
  }
  for (int i = 0; i < whole; i += kLanes) {
    const int first = i < count - kLanes ? i : count - kLanes;  // the last ones may count twice
    for (int lane = 0; lane < kLanes; ++lane) {
      const int at = first + lane;
      x.add(lane, x_mm[at], weight[at]);
      to_x.add(lane, -x_mm[at], weight[at]);
      y.add(lane, y_mm[at], weight[at]);
      to_y.add(lane, -y_mm[at], weight[at]);
      margin.add(lane, margin_mm[at], weight[at]);
    }
  }
  return {.x_low_mm = x.value(),
          .x_high_mm = -to_x.value(),
          .y_low_mm = y.value(),
          .y_high_mm = -to_y.value(),
          .margin_low_mm = margin.value()};
}

namespace {

/// The value, or 0 for a mask of 0: without a branch.
GLINT_INLINE float kept(float value, std::int32_t mask) {
  return std::bit_cast<float>(std::bit_cast<std::int32_t>(value) & mask);
}

/// A row of cells. @tparam kCells  per axis; known to the compiler, a row is a vector or less
template <int kCells>
GLINT_INLINE void sample_row(const float* __restrict top,
                             const float* __restrict gain_top,
                             const std::int32_t* __restrict used,
                             float offset_mm,
                             float per_mm,
                             float* __restrict v,
                             float* __restrict gx,
                             float* __restrict gy,
                             float* __restrict gain,
                             float* __restrict widest) {
  constexpr float kQuarterShare = 0.25F / static_cast<float>(kCells * kCells);
  const float* __restrict bottom = top + kCells + 1;
  const float* __restrict gain_bottom = gain_top + kCells + 1;
  for (int i = 0; i < kCells; ++i) {
    const float a = top[i];
    const float b = top[i + 1];
    const float c = bottom[i];
    const float d = bottom[i + 1];
    const float width = larger(larger(a, b), larger(c, d)) - smaller(smaller(a, b), smaller(c, d));
    const float sum = gain_top[i] + gain_top[i + 1] + gain_bottom[i] + gain_bottom[i + 1];
    v[i] = kept((0.25F * (a + b + c + d) - offset_mm) * per_mm, used[i]);
    gx[i] = kept(0.5F * (b + d - a - c) * per_mm, used[i]);
    gy[i] = kept(0.5F * (c + d - a - b) * per_mm, used[i]);
    gain[i] = kept(kQuarterShare * sum, used[i]);
    widest[i] = larger(widest[i], kept(width, used[i]));
  }
}

template <int kCells>
GLINT_INLINE float sample_rows(const CellGrid& cells,
                               float offset_mm,
                               float per_mm,
                               const CellSamples& out) {
  std::int32_t used[static_cast<std::size_t>(kCells * kCells)];
  for (int i = 0; i < kCells * kCells; ++i) {
    used[i] = -static_cast<std::int32_t>(cells.is_smooth[i]);
  }
  float widths[static_cast<std::size_t>(kCells)] = {};
  for (int row = 0; row < kCells; ++row) {
    const std::ptrdiff_t first = row * kCells;
    sample_row<kCells>(cells.stripes_mm + first + row,
                       cells.gain + first + row,
                       used + first,
                       offset_mm,
                       per_mm,
                       out.v + first,
                       out.gx + first,
                       out.gy + first,
                       out.gain + first,
                       widths);
  }
  float widest = 0.0F;
  for (const float width : widths) {
    widest = larger(widest, width);
  }
  return widest;
}

}  // namespace

GLINT_WIDE float sample_cells(const CellGrid& cells,
                              float offset_mm,
                              float per_mm,
                              const CellSamples& out) {
  switch (cells.cells_per_axis) {
    case 2:
      return sample_rows<2>(cells, offset_mm, per_mm, out);
    case 4:
      return sample_rows<4>(cells, offset_mm, per_mm, out);
    case 8:
      return sample_rows<8>(cells, offset_mm, per_mm, out);
    case 16:
      return sample_rows<16>(cells, offset_mm, per_mm, out);
    default:
      return __builtin_inff();
  }
}

GLINT_WIDE void corner_weights(const unsigned char* __restrict is_smooth,
                               int cells_per_axis,
                               float* __restrict weight) {
  const int n = cells_per_axis;
  const float quarter = 0.25F / static_cast<float>(n * n);
  // Quarters of the cells in a row of them, with nothing on both sides.
  float above[kMostCells + 2] = {};
  float below[kMostCells + 2] = {};
  for (int row = 0; row <= n; ++row) {
    const bool is_last = row == n;
    const float full = is_last ? 0.0F : quarter;
    const unsigned char* __restrict cells = is_smooth + (is_last ? 0 : row) * n;
    for (int i = 0; i < n; ++i) {
      below[i + 1] = full * static_cast<float>(1 - static_cast<std::int32_t>(cells[i]));
    }
    float* __restrict out = weight + row * (n + 1);
    for (int i = 0; i <= n; ++i) {
      out[i] = (above[i] + above[i + 1]) + (below[i] + below[i + 1]);
    }
    for (int i = 1; i <= n; ++i) {
      above[i] = below[i];
    }
  }
}

}  // namespace glint::cut_kernels

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

#include "core/simd.h"
#include "simulator/render/footprint/corner_lane.h"
#include "simulator/render/footprint/footprint_lane.h"
#include "simulator/render/footprint/stripe_integral.h"

namespace glint::cut_kernels {
namespace {

using corner_lane::Linear;
using corner_lane::linear_at;
using footprint_lane::absolute;
using footprint_lane::first_integral;
using footprint_lane::second_integral;

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
  double phase = 0.0;
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

/// The phase of the stripes; where there are none it rises a little all the same (kFlatPhase).
GLINT_INLINE Linear phase_at(const Corners& stripes_mm, int i, double offset_mm, double per_mm) {
  Linear v = linear_at(stripes_mm, i);
  v.value = (v.value - offset_mm) * per_mm;
  const double dx = v.dx * per_mm;
  const double dy = v.dy * per_mm;
  const bool is_flat = dx * dx + dy * dy < kFlatPhase * kFlatPhase;
  v.dx = is_flat ? kFlatPhase : dx;
  v.dy = is_flat ? 0.0 : dy;
  return v;
}

/// The boundary itself, the edge that closes what is kept.
/// @param across, along  the phase's gradient over its square
GLINT_INLINE void add_boundary(const Linear& v, double across, double along, Border& border) {
  Crossing& from = border.leaving;
  Crossing& to = border.entering;
  const double weight = across * (to.y - from.y) - along * (to.x - from.x);
  from.phase = v.value + from.x * v.dx + from.y * v.dy;
  to.phase = v.value + to.x * v.dx + to.y * v.dy;
  const double difference = to.phase - from.phase;
  const bool is_level = absolute(difference) <= kLevelEdge;
  const double second = is_level ? 0.0 : weight / difference;
  const double first = is_level ? 0.5 * weight : 0.0;
  from.second -= second;
  to.second += second;
  from.first += first;
  to.first += first;
  border.twice_area = border.twice_area + from.x * to.y - to.x * from.y;
}

GLINT_INLINE void set_vertex(
    int k, int i, double phase, double second, double first, CutSums& __restrict sums) {
  sums.phase[k][i] = phase;
  sums.second[k][i] = second;
  sums.first[k][i] = first;
}

GLINT_INLINE void cut_pixel(const Linear& v, const Linear& f, int i, CutSums& __restrict sums) {
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
  add_boundary(v, across, along, border);
  sums.area[i] = 0.5 * border.twice_area;
  set_vertex(0, i, a.phase, at_a.second, at_a.first, sums);
  set_vertex(1, i, b.phase, at_b.second, at_b.first, sums);
  set_vertex(2, i, c.phase, at_c.second, at_c.first, sums);
  set_vertex(3, i, d.phase, at_d.second, at_d.first, sums);
  set_vertex(4, i, border.leaving.phase, border.leaving.second, border.leaving.first, sums);
  set_vertex(5, i, border.entering.phase, border.entering.second, border.entering.first, sums);
}

}  // namespace

GLINT_WIDE void cut(const CornerBatch& __restrict pixels,
                    const LinearBatch& __restrict inside,
                    double offset_mm,
                    double per_mm,
                    CutSums& __restrict sums) {
  const int count = pixels.count;
  for (int i = 0; i < count; ++i) {
    const Linear v = phase_at(pixels.stripes_mm, i, offset_mm, per_mm);
    cut_pixel(v, {inside.value[i], inside.dx[i], inside.dy[i]}, i, sums);
  }
  double level = 0.0;
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
  // In a loop of its own: chosen while they are added, GCC 12 forgets lanes 4 to 15 on AVX2 where
  // not all of them are simple.
  float kept[kBatch];
  for (int i = 0; i < kBatch; ++i) {
    kept[i] = is_simple[i] != 0 ? values[i] : 0.0F;
  }
  float lanes[kLanes] = {};
  for (int i = 0; i < kBatch; i += kLanes) {
    for (int lane = 0; lane < kLanes; ++lane) {
      lanes[lane] += kept[i + lane];
    }
  }
  return sum_of(lanes);
}

}  // namespace glint::cut_kernels

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The integral of stripes over a convex polygon inside a pixel, for any number of positions of the
// stripes. The pixel's square is clipped by one boundary of the light after the other (I.
// Sutherland and G. Hodgman, "Reentrant polygon clipping", CACM 17, 1974); the divergence theorem
// then leaves a sum over the vertices (own derivation, docs/theory/footprints.md, "Polygons").
// Along edges of constant phase a quotient of differences would lose all digits, so these take the
// mean of the first integral at both ends. Cost: one pass over the vertices, then vertices times
// positions; memory for the vertices only. Reference for cut_kernels.h.
#include "simulator/render/footprint/stripe_integral.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "simulator/render/footprint/footprint_kernels.h"

namespace glint {
LinearFunction linear_through(const std::array<double, 4>& c) {
  return {.value = 0.25 * (c[0] + c[1] + c[2] + c[3]),
          .dx = 0.5 * (c[1] + c[3] - c[0] - c[2]),
          .dy = 0.5 * (c[2] + c[3] - c[0] - c[1])};
}

PixelPolygon::PixelPolygon() : size_(4) {
  vertices_[0] = {.x = -0.5, .y = -0.5};
  vertices_[1] = {.x = 0.5, .y = -0.5};
  vertices_[2] = {.x = 0.5, .y = 0.5};
  vertices_[3] = {.x = -0.5, .y = 0.5};
}

/// Sutherland and Hodgman's rule for one half-plane.
void PixelPolygon::clip(const LinearFunction& inside, int boundary) {
  std::array<Vertex, kMaxVertices> kept;
  int count = 0;
  const auto keep = [&](const Vertex& vertex) {
    GLINT_CHECK(count < kMaxVertices, "a square cut by a few lines");
    kept[static_cast<std::size_t>(count++)] = vertex;
  };
  for (int i = 0; i < size_; ++i) {
    const Vertex& a = vertex(i);
    const Vertex& b = vertex((i + 1) % size_);
    const double at_a = inside.at(a.x, a.y);
    const double at_b = inside.at(b.x, b.y);
    if (at_a >= 0.0) {
      keep(a);
    }
    if ((at_a >= 0.0) != (at_b >= 0.0)) {
      const double s = at_a / (at_a - at_b);
      keep({.x = a.x + s * (b.x - a.x),
            .y = a.y + s * (b.y - a.y),
            .boundary = at_a >= 0.0 ? boundary : a.boundary});
    }
  }
  vertices_ = kept;
  size_ = count;
}

double PixelPolygon::area() const {
  double twice = 0.0;
  for (int i = 0; i < size_; ++i) {
    const Vertex& a = vertex(i);
    const Vertex& b = vertex((i + 1) % size_);
    twice += a.x * b.y - b.x * a.y;
  }
  return 0.5 * twice;
}

void StripeSum::clear() {
  area = 0.0;
  phase.clear();
  second.clear();
  first.clear();
}

void StripeSum::add(const PixelPolygon& polygon, const LinearFunction& phase_of_pixel) {
  if (polygon.size() < 3) {
    return;
  }
  LinearFunction v = phase_of_pixel;
  double squared = v.dx * v.dx + v.dy * v.dy;
  if (squared < kFlatPhase * kFlatPhase) {
    v.dx = kFlatPhase;
    v.dy = 0.0;
    squared = kFlatPhase * kFlatPhase;
  }
  area += polygon.area();
  const std::size_t begin = phase.size();
  const auto count = static_cast<std::size_t>(polygon.size());
  for (int i = 0; i < polygon.size(); ++i) {
    phase.push_back(v.at(polygon.vertex(i).x, polygon.vertex(i).y));
  }
  second.resize(begin + count, 0.0);
  first.resize(begin + count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t from = begin + i;
    const std::size_t to = begin + (i + 1) % count;
    const PixelPolygon::Vertex& a = polygon.vertex(static_cast<int>(i));
    const PixelPolygon::Vertex& b = polygon.vertex(static_cast<int>((i + 1) % count));
    const double weight = (v.dx * (b.y - a.y) - v.dy * (b.x - a.x)) / squared;
    const double difference = phase[to] - phase[from];
    if (std::abs(difference) > kLevelEdge) {
      second[to] += weight / difference;
      second[from] -= weight / difference;
    } else {
      first[to] += 0.5 * weight;
      first[from] += 0.5 * weight;
    }
  }
}

void StripeSum::evaluate(const std::vector<double>& shifts, double duty, double* shares) const {
  std::fill_n(shares, shifts.size(), area * duty);
  footprint_kernels::sum_vertices(phase.data(),
                                  second.data(),
                                  first.data(),
                                  static_cast<int>(phase.size()),
                                  shifts.data(),
                                  static_cast<int>(shifts.size()),
                                  duty,
                                  shares);
}

}  // namespace glint

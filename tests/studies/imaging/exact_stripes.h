// SPDX-License-Identifier: GPL-3.0-or-later
//
// Stripes over a polygon as simulator/render/footprint/stripe_integral.h has them, but to the last
// digits of a double: along an edge their first integral is summed piece by piece, where the fast
// form divides the difference of two second integrals by the difference of two phases, which may be
// next to nothing.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "simulator/render/footprint/stripe_integral.h"

namespace glint {

class ExactStripes {
 public:
  explicit ExactStripes(double duty) : duty_(duty) {}

  double area() const { return area_; }

  void clear() {
    area_ = 0.0;
    edges_.clear();
  }

  void add(const PixelPolygon& polygon, const LinearFunction& phase_of_pixel) {
    if (polygon.size() < 3) {
      return;
    }
    LinearFunction v = phase_of_pixel;
    v.value -= std::floor(v.value);
    if (std::hypot(v.dx, v.dy) < kFlatPhase) {
      v.dx = kFlatPhase;
      v.dy = 0.0;
    }
    const double squared = v.dx * v.dx + v.dy * v.dy;
    area_ += polygon.area();
    for (int i = 0; i < polygon.size(); ++i) {
      const PixelPolygon::Vertex& a = polygon.vertex(i);
      const PixelPolygon::Vertex& b = polygon.vertex((i + 1) % polygon.size());
      edges_.push_back({.from = v.at(a.x, a.y),
                        .to = v.at(b.x, b.y),
                        .weight = (v.dx * (b.y - a.y) - v.dy * (b.x - a.x)) / squared});
    }
  }

  /// The lit share of the pixel, stripes 1 on `duty` of a period and 0 elsewhere.
  double share(double shift) const {
    double sum = area_ * duty_;
    for (const Edge& edge : edges_) {
      sum += edge.weight * mean_between(edge.from - shift, edge.to - shift);
    }
    return sum;
  }

 private:
  struct Edge {
    double from, to, weight;
  };

  /// Of the first integral of the stripes less their mean: straight between the stripes' edges.
  double mean_between(double a, double b) const {
    const double low = std::min(a, b);
    const double high = std::max(a, b);
    const double whole = std::floor(low);
    const double bend = whole + (low - whole < duty_ ? duty_ : 1.0);
    if (high <= bend || high == low) {
      return 0.5 * (integral_at(low, whole) + integral_at(high, whole));
    }
    double sum = 0.0;
    double at = low;
    double period = whole;
    bool is_bright = low - whole < duty_;
    while (at < high) {
      const double end = std::min(high, period + (is_bright ? duty_ : 1.0));
      sum += 0.5 * (end - at) * (integral_at(at, period) + integral_at(end, period));
      at = end;
      period += is_bright ? 0.0 : 1.0;
      is_bright = !is_bright;
    }
    return sum / (high - low);
  }

  /// @param period  that the phase lies in, or at the end of
  double integral_at(double phase, double period) const {
    const double f = phase - period;
    return std::min((1.0 - duty_) * f, duty_ * (1.0 - f)) - 0.5 * duty_ * (1.0 - duty_);
  }

  double duty_;
  double area_ = 0.0;
  std::vector<Edge> edges_;
};

}  // namespace glint

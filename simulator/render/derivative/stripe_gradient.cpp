// SPDX-License-Identifier: GPL-3.0-or-later
//
// The derivative of the stripes' integral over a polygon (stripe_integral.h). By the phase it is
// the same sum over edges with one integration less; by a boundary it is the integral of the
// radiance along the edge that the boundary makes, over the length of its function's gradient. Own
// derivation: docs/theory/derivatives.md, "Boundaries of the light". Cost: per vertex one sum over
// the frames (vertex_sums.h), then constant work per edge.
#include "simulator/render/derivative/stripe_gradient.h"

#include <cmath>

#include "simulator/render/derivative/vertex_sums.h"

namespace glint {
namespace {

using gradient_kernels::VertexSums;

/// Integrals along an edge, from its first to its last point at s in [0, 1], of the stripes and of
/// s times the stripes.
struct EdgeIntegrals {
  double stripes = 0.0;
  double stripes_s = 0.0;
};

EdgeIntegrals along_edge(
    const VertexSums& a, const VertexSums& b, double difference, double duty, double weight) {
  EdgeIntegrals edge = {.stripes = duty * weight, .stripes_s = 0.5 * duty * weight};
  if (std::abs(difference) > kLevelEdge) {
    edge.stripes += (b.first - a.first) / difference;
    edge.stripes_s += b.first / difference - (b.second - a.second) / (difference * difference);
  } else {
    edge.stripes += 0.5 * (a.wave + b.wave);
    edge.stripes_s += 0.25 * (a.wave + b.wave);
  }
  return edge;
}

/// Where the phase is level it rises a little all the same (kFlatPhase).
LinearFunction tilted(LinearFunction g) {
  if (g.dx * g.dx + g.dy * g.dy < kFlatPhase * kFlatPhase) {
    g.dx = kFlatPhase;
    g.dy = 0.0;
  }
  return g;
}

/// An edge of the polygon from vertex a on, with what is integrated along it.
struct Edge {
  const PixelPolygon::Vertex& a;
  double dx = 0.0, dy = 0.0;
  double stripes = 0.0;                 ///< integral of the stripes
  double x_times = 0.0, y_times = 0.0;  ///< of x and of y times the stripes
};

Edge edge_between(const PixelPolygon::Vertex& a,
                  const PixelPolygon::Vertex& b,
                  const EdgeIntegrals& along) {
  const double dx = b.x - a.x;
  const double dy = b.y - a.y;
  return {.a = a,
          .dx = dx,
          .dy = dy,
          .stripes = along.stripes,
          .x_times = a.x * along.stripes + dx * along.stripes_s,
          .y_times = a.y * along.stripes + dy * along.stripes_s};
}

/// What moving the boundary that made this edge changes.
/// @param everywhere  radiance that does not depend on the stripes
void add_boundary(const Edge& edge,
                  const LinearFunction& clip,
                  double bright,
                  double everywhere,
                  LinearGradient& boundary) {
  const double per_slope = std::hypot(edge.dx, edge.dy) / std::hypot(clip.dx, clip.dy);
  boundary.value += per_slope * (bright * edge.stripes + everywhere);
  boundary.dx += per_slope * (bright * edge.x_times + everywhere * (edge.a.x + 0.5 * edge.dx));
  boundary.dy += per_slope * (bright * edge.y_times + everywhere * (edge.a.y + 0.5 * edge.dy));
}

/// The bright share of the polygon and its derivative by the duty.
struct Share {
  double value = 0.0, by_duty = 0.0;

  /// @param through  what of the phase's gradient goes out through the edge
  void add_edge(const VertexSums& a, const VertexSums& b, double difference, double through) {
    if (std::abs(difference) > kLevelEdge) {
      value += through * (b.second - a.second) / difference;
      by_duty += through * (b.second_by_duty - a.second_by_duty) / difference;
    } else {
      value += 0.5 * through * (a.first + b.first);
      by_duty += 0.5 * through * (a.first_by_duty + b.first_by_duty);
    }
  }
};

}  // namespace

std::array<double, 4> LinearGradient::by_corners() const {
  const double mean = 0.25 * value;
  return {mean - 0.5 * dx - 0.5 * dy,
          mean + 0.5 * dx - 0.5 * dy,
          mean - 0.5 * dx + 0.5 * dy,
          mean + 0.5 * dx + 0.5 * dy};
}

/// With n the outward normal of length one and g the phase's gradient:
///   d share / d phase  = edges' sum of (g . n) / |g|^2 * integral of stripes,
///   d share / d g_x    = the same with x times the stripes, less g_x / |g|^2 * share,
///   d share / d clip c = integral of stripes along the edge / |gradient of c|.
void StripeGradient::add(const PixelPolygon& polygon,
                         const LinearFunction& phase_of_pixel,
                         std::span<const LinearFunction> boundaries,
                         const std::vector<double>& shifts,
                         const std::vector<double>& weights,
                         const StripeLevels& levels) {
  if (polygon.size() < 3) {
    return;
  }
  const auto [stripe_duty, dark, bright] = levels;
  const LinearFunction g = tilted(phase_of_pixel);
  const double squared = g.dx * g.dx + g.dy * g.dy;
  std::array<VertexSums, PixelPolygon::kMaxVertices> sums;
  std::array<double, PixelPolygon::kMaxVertices> phases = {};
  for (int i = 0; i < polygon.size(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    phases[at] = g.at(polygon.vertex(i).x, polygon.vertex(i).y);
  }
  const double weight = gradient_kernels::weigh_vertices(phases.data(),
                                                         polygon.size(),
                                                         shifts.data(),
                                                         weights.data(),
                                                         static_cast<int>(shifts.size()),
                                                         stripe_duty,
                                                         sums.data());
  const double lit = polygon.area() * weight;
  Share polygon_share = {.value = stripe_duty * lit, .by_duty = lit};
  LinearGradient gradient;
  for (int i = 0; i < polygon.size(); ++i) {
    const int next = (i + 1) % polygon.size();
    const VertexSums& at_a = sums[static_cast<std::size_t>(i)];
    const VertexSums& at_b = sums[static_cast<std::size_t>(next)];
    const double difference =
        phases[static_cast<std::size_t>(next)] - phases[static_cast<std::size_t>(i)];
    const Edge edge = edge_between(polygon.vertex(i),
                                   polygon.vertex(next),
                                   along_edge(at_a, at_b, difference, stripe_duty, weight));
    const double through = (g.dx * edge.dy - g.dy * edge.dx) / squared;
    gradient.value += through * edge.stripes;
    gradient.dx += through * edge.x_times;
    gradient.dy += through * edge.y_times;
    polygon_share.add_edge(at_a, at_b, difference, through);
    if (edge.a.boundary >= 0) {
      const auto label = static_cast<std::size_t>(edge.a.boundary);
      add_boundary(edge, boundaries[label], bright, dark * weight, boundary[label]);
    }
  }
  phase.value += bright * gradient.value;
  phase.dx += bright * (gradient.dx - g.dx / squared * polygon_share.value);
  phase.dy += bright * (gradient.dy - g.dy / squared * polygon_share.value);
  duty += bright * polygon_share.by_duty;
  share += polygon_share.value;
  area += lit;
}

}  // namespace glint

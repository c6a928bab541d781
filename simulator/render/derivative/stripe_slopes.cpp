// SPDX-License-Identifier: GPL-3.0-or-later
//
// The derivative of the stripes' integral over a polygon (stripe_integral.h). By the phase it is
// the same sum over edges with one integration less; by a boundary it is the integral of the
// radiance along the edge that the boundary makes, over the length of its function's gradient. Own
// derivation: docs/theory/derivatives.md, "Boundaries of the light". Cost: per vertex one sum over
// the frames (vertex_sums.h), then constant work per edge.
#include "simulator/render/derivative/stripe_slopes.h"

#include <cmath>

#include "simulator/render/derivative/vertex_sums.h"

namespace glint {
namespace {

using slope_kernels::VertexSums;

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

}  // namespace

std::array<double, 4> LinearSlopes::by_corners() const {
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
void StripeSlopes::add(const PixelPolygon& polygon,
                       const LinearFunction& phase_of_pixel,
                       const std::array<LinearFunction, 5>& boundaries,
                       const std::vector<double>& shifts,
                       const std::vector<double>& weights,
                       double stripe_duty,
                       double dark,
                       double bright) {
  if (polygon.size() < 3) {
    return;
  }
  LinearFunction g = phase_of_pixel;
  double squared = g.dx * g.dx + g.dy * g.dy;
  if (squared < kFlatPhase * kFlatPhase) {
    g.dx = kFlatPhase;
    g.dy = 0.0;
    squared = kFlatPhase * kFlatPhase;
  }
  std::array<VertexSums, PixelPolygon::kMaxVertices> sums;
  std::array<double, PixelPolygon::kMaxVertices> phases = {};
  for (int i = 0; i < polygon.size(); ++i) {
    const auto at = static_cast<std::size_t>(i);
    phases[at] = g.at(polygon.vertex(i).x, polygon.vertex(i).y);
  }
  const double weight = slope_kernels::weigh_vertices(phases.data(),
                                                      polygon.size(),
                                                      shifts.data(),
                                                      weights.data(),
                                                      static_cast<int>(shifts.size()),
                                                      stripe_duty,
                                                      sums.data());
  const double lit = polygon.area() * weight;
  double polygon_share = stripe_duty * lit;
  double by_duty = lit;
  LinearSlopes slopes;
  for (int i = 0; i < polygon.size(); ++i) {
    const int next = (i + 1) % polygon.size();
    const PixelPolygon::Vertex& a = polygon.vertex(i);
    const PixelPolygon::Vertex& b = polygon.vertex(next);
    const VertexSums& at_a = sums[static_cast<std::size_t>(i)];
    const VertexSums& at_b = sums[static_cast<std::size_t>(next)];
    const double dx = b.x - a.x;
    const double dy = b.y - a.y;
    const double difference =
        phases[static_cast<std::size_t>(next)] - phases[static_cast<std::size_t>(i)];
    const EdgeIntegrals edge = along_edge(at_a, at_b, difference, stripe_duty, weight);
    const double through = (g.dx * dy - g.dy * dx) / squared;
    const double x_times = a.x * edge.stripes + dx * edge.stripes_s;
    const double y_times = a.y * edge.stripes + dy * edge.stripes_s;
    slopes.value += through * edge.stripes;
    slopes.dx += through * x_times;
    slopes.dy += through * y_times;
    if (std::abs(difference) > kLevelEdge) {
      polygon_share += through * (at_b.second - at_a.second) / difference;
      by_duty += through * (at_b.second_by_duty - at_a.second_by_duty) / difference;
    } else {
      polygon_share += 0.5 * through * (at_a.first + at_b.first);
      by_duty += 0.5 * through * (at_a.first_by_duty + at_b.first_by_duty);
    }
    if (a.boundary >= 0) {
      const auto label = static_cast<std::size_t>(a.boundary);
      const LinearFunction& clip = boundaries[label];
      const double per_slope = std::hypot(dx, dy) / std::hypot(clip.dx, clip.dy);
      const double area_edge = dark * weight;
      boundary[label].value += per_slope * (bright * edge.stripes + area_edge);
      boundary[label].dx += per_slope * (bright * x_times + area_edge * (a.x + 0.5 * dx));
      boundary[label].dy += per_slope * (bright * y_times + area_edge * (a.y + 0.5 * dy));
    }
  }
  phase.value += bright * slopes.value;
  phase.dx += bright * (slopes.dx - g.dx / squared * polygon_share);
  phase.dy += bright * (slopes.dy - g.dy / squared * polygon_share);
  duty += bright * by_duty;
  share += polygon_share;
  area += lit;
}

}  // namespace glint

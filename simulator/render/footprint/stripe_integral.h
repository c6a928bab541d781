// SPDX-License-Identifier: GPL-3.0-or-later
//
// Stripes integrated over a part of a pixel in closed form: over the polygon that is left of the
// unit square when the light's boundaries (slot, rim, ends) are cut away, with the phase of the
// stripes linear over the pixel.
//
// With I and J the first and second integral of the square wave less its mean, both periodic with
// mean zero, the divergence theorem turns the area integral into one over the polygon's edges and
// that into differences of J between its vertices. So every frame of a scan is a sum of J over the
// same few vertices, shifted (docs/theory/footprints.md).
#pragma once

#include <array>
#include <vector>

namespace glint {

/// Phase differences along an edge below this are taken as none: J's differences would cancel.
inline constexpr double kLevelEdge = 1e-6;
/// Phase gradients below this are replaced by one of this size.
inline constexpr double kFlatPhase = 1e-5;

/// value + x dx + y dy for x, y in [-1/2, 1/2] of a pixel.
struct LinearFunction {
  double value = 0.0;
  double dx = 0.0;
  double dy = 0.0;

  double at(double x, double y) const { return value + x * dx + y * dy; }
};

/// Least squares through the corners (x0 y0, x1 y0, x0 y1, x1 y1).
LinearFunction linear_through(const std::array<double, 4>& corners);

/// A convex polygon inside the unit square, counter-clockwise.
class PixelPolygon {
 public:
  static constexpr int kMaxVertices = 16;

  struct Vertex {
    double x = 0.0;
    double y = 0.0;
    int boundary = -1;  ///< what cut the edge that begins here; -1: the pixel's own border
  };

  PixelPolygon();  ///< the whole pixel

  /// Keeps where the function is >= 0.
  void clip(const LinearFunction& inside, int boundary);

  double area() const;

  int size() const { return size_; }

  const Vertex& vertex(int i) const { return vertices_[static_cast<std::size_t>(i)]; }

 private:
  std::array<Vertex, kMaxVertices> vertices_;
  int size_ = 0;
};

/// The sum that stands for the integral of shifted stripes over polygons: see sum_vertices() in
/// footprint_kernels.h.
struct StripeSum {
  double area = 0.0;
  std::vector<double> phase, second, first;  ///< vertex by vertex

  void clear();
  void add(const PixelPolygon& polygon, const LinearFunction& phase_of_pixel);

  /// The lit share of the pixel, stripes 1 on `duty` of a period and 0 elsewhere, for each shift.
  void evaluate(const std::vector<double>& shifts, double duty, double* shares) const;
};

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/overlap/outline.h"

#include <algorithm>
#include <cmath>

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr int kPaddingPx = 4;  ///< around a mask, so that every outline is closed
constexpr int kLinesPerPixel = 4;

Mask padded(const Mask& mask) {
  Mask larger(mask.width() + 2 * kPaddingPx, mask.height() + 2 * kPaddingPx);
  for (int y = 0; y < mask.height(); ++y) {
    std::copy_n(mask.row(y), mask.width(), larger.row(y + kPaddingPx) + kPaddingPx);
  }
  return larger;
}

/// In pixels of the larger picture, with points between neighbours that are more than a pixel
/// apart.
Boundary enlarged(const Boundary& line, int factor, const Vector2d& size_px) {
  Boundary result = {.points = {}, .is_closed = true};
  const auto place = [&](const BoundaryPoint& point) {
    const Vector2d at = factor * (point.at_px - Vector2d::Constant(kPaddingPx));
    return Vector2d(at.cwiseMax(0.0).cwiseMin(size_px));
  };
  for (std::size_t i = 0; i < line.points.size(); ++i) {
    const BoundaryPoint& here = line.points[i];
    const BoundaryPoint& next = line.points[(i + 1) % line.points.size()];
    for (int k = 0; k < factor; ++k) {
      const double t = static_cast<double>(k) / factor;
      const Vector2d normal = (1.0 - t) * here.normal + t * next.normal;
      result.points.push_back(
          {.at_px = (1.0 - t) * place(here) + t * place(next),
           .normal = normal.norm() > 1e-6 ? Vector2d(normal.normalized()) : here.normal});
    }
  }
  return result;
}

/// Where the outlines cross a horizontal line, in order.
std::vector<std::vector<double>> crossings(std::span<const Boundary> outlines, int lines) {
  std::vector<std::vector<double>> crossed(static_cast<std::size_t>(lines));
  for (const Boundary& outline : outlines) {
    for (std::size_t i = 0; i < outline.points.size(); ++i) {
      Vector2d a = outline.points[i].at_px;
      Vector2d b = outline.points[(i + 1) % outline.points.size()].at_px;
      if (a.y() > b.y()) {
        std::swap(a, b);
      }
      // Line k lies at (k + 0.5) / kLinesPerPixel; an end belongs to the stretch below it.
      const int first = std::max(static_cast<int>(std::ceil(a.y() * kLinesPerPixel - 0.5)), 0);
      for (int k = first; k < lines && (k + 0.5) / kLinesPerPixel < b.y(); ++k) {
        const double t = ((k + 0.5) / kLinesPerPixel - a.y()) / (b.y() - a.y());
        crossed[static_cast<std::size_t>(k)].push_back(a.x() + t * (b.x() - a.x()));
      }
    }
  }
  for (std::vector<double>& line : crossed) {
    std::ranges::sort(line);
  }
  return crossed;
}

/// Adds the stretch [from, to) of one line to a row of pixels.
void add_stretch(double from, double to, int width_px, float* row) {
  from = std::clamp(from, 0.0, static_cast<double>(width_px));
  to = std::clamp(to, 0.0, static_cast<double>(width_px));
  const int first = static_cast<int>(from);
  const int last = std::min(static_cast<int>(to), width_px - 1);
  for (int x = first; x <= last; ++x) {
    const double share = std::min(to, x + 1.0) - std::max(from, static_cast<double>(x));
    row[x] += static_cast<float>(std::max(share, 0.0) / kLinesPerPixel);
  }
}

}  // namespace

std::vector<Boundary> outlines_of(const Mask& mask, int factor) {
  const Vector2d size_px(mask.width() * factor, mask.height() * factor);
  std::vector<Boundary> outlines;
  for (const Boundary& line : boundaries_of(padded(mask))) {
    outlines.push_back(enlarged(line, factor, size_px));
  }
  return outlines;
}

std::vector<Boundary> refined(std::vector<Boundary> outlines, std::span<const LocatedEdge> edges) {
  for (const LocatedEdge& edge : edges) {
    outlines[edge.boundary].points[edge.point].at_px = edge.edge.at_px;
  }
  return outlines;
}

ImageF filled(std::span<const Boundary> outlines, int width_px, int height_px) {
  ImageF coverage(width_px, height_px);
  const auto crossed = crossings(outlines, height_px * kLinesPerPixel);
  for (int line = 0; line < height_px * kLinesPerPixel; ++line) {
    const std::vector<double>& at = crossed[static_cast<std::size_t>(line)];
    for (std::size_t i = 0; i + 1 < at.size(); i += 2) {
      add_stretch(at[i], at[i + 1], width_px, coverage.row(line / kLinesPerPixel));
    }
  }
  return coverage;
}

}  // namespace glint

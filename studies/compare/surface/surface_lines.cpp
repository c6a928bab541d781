// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/surface/surface_lines.h"

#include <algorithm>

#include "metrics/overlap/outline.h"

namespace glint {
namespace {

using Eigen::Vector2d;

constexpr double kBeside_px = 2.0;  ///< from a line, where the other surface is looked for
constexpr std::size_t kLeastLine = 8;

/// Columns and rows [x0, x1) x [y0, y1).
struct Window {
  int x0 = 0;
  int y0 = 0;
  int x1 = 0;
  int y1 = 0;
};

/// Of each label what holds its pixels and some around them, within the picture.
std::vector<Window> windows_of(const NamedSurfaces& surfaces) {
  constexpr int kAround_px = 4;
  const Image<int>& labels = surfaces.labels;
  std::vector<Window> windows(surfaces.names.size() + 1,
                              {.x0 = labels.width(), .y0 = labels.height()});
  for (int y = 0; y < labels.height(); ++y) {
    for (int x = 0; x < labels.width(); ++x) {
      Window& window = windows[static_cast<std::size_t>(std::max(labels(x, y), 0))];
      window = {.x0 = std::min(window.x0, std::max(x - kAround_px, 0)),
                .y0 = std::min(window.y0, std::max(y - kAround_px, 0)),
                .x1 = std::max(window.x1, std::min(x + kAround_px + 1, labels.width())),
                .y1 = std::max(window.y1, std::min(y + kAround_px + 1, labels.height()))};
    }
  }
  return windows;
}

/// Outlines of the pixels of one label, which the window holds.
std::vector<Boundary> outlines_in(const Image<int>& labels, const Window& window, int label) {
  Mask mask(window.x1 - window.x0, window.y1 - window.y0);
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      mask(x, y) = labels(window.x0 + x, window.y0 + y) == label ? 1 : 0;
    }
  }
  std::vector<Boundary> outlines = outlines_of(mask, 1);
  for (Boundary& outline : outlines) {
    for (BoundaryPoint& point : outline.points) {
      point.at_px += Vector2d(window.x0, window.y0);
    }
  }
  return outlines;
}

/// Pieces of a surface's outline beyond which another one of a higher number begins.
void add_lines(const NamedSurfaces& surfaces,
               int from,
               const Boundary& outline,
               std::vector<SurfaceLine>& lines) {
  SurfaceLine line = {.from = from};
  const auto finish = [&] {
    if (line.line.points.size() >= kLeastLine) {
      lines.push_back(line);
    }
    line.line.points.clear();
  };
  for (const BoundaryPoint& point : outline.points) {
    const int to = surfaces.at(point.at_px + kBeside_px * point.normal);
    if (to != line.to) {
      finish();
      line.to = to;
    }
    if (to > from) {
      line.line.points.push_back(point);
    }
  }
  finish();
}

}  // namespace

std::vector<SurfaceLine> lines_between(const NamedSurfaces& surfaces) {
  std::vector<SurfaceLine> lines;
  const std::vector<Window> windows = windows_of(surfaces);
  for (int from = 1; from < static_cast<int>(surfaces.names.size()); ++from) {
    for (const Boundary& outline :
         outlines_in(surfaces.labels, windows[static_cast<std::size_t>(from)], from)) {
      add_lines(surfaces, from, outline, lines);
    }
  }
  return lines;
}

}  // namespace glint

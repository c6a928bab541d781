// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/surface/named_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include <fmt/format.h>

#include "metrics/overlap/outline.h"
#include "studies/compare/surface/surface_shape.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kLeastBend = 0.1305;  ///< half of the change of a unit normal: 15 deg
constexpr double kSurelyBend =
    0.5;                           ///< no limb of a ball of more than four pixels bends so: 60 deg
constexpr double kSharp_px = 8.0;  ///< radius below which a bend is an edge
constexpr double kStep_px = 1.5;   ///< above the tangent plane
constexpr double kStepShare = 0.35;  ///< of the distance; at the limb of a ball it is less
constexpr std::size_t kLeastPixels = 100;
constexpr std::size_t kShapePoints = 2000;
constexpr int kGrown_px = 3;        ///< over the pixels of an edge, which mix two surfaces
constexpr double kBeside_px = 2.0;  ///< from a line, where the other surface is looked for
constexpr std::size_t kLeastLine = 8;

constexpr std::array<std::pair<int, int>, 4> kNeighbours = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

class SurfaceFinder {
 public:
  SurfaceFinder(const SimulatedSurface& surface, double focal_px)
      : surface_(surface),
        focal_px_(focal_px),
        labels_(surface.width(), surface.height(), NamedSurfaces::kBackground) {}

  NamedSurfaces find() {
    mark_edges();
    std::vector<std::vector<std::pair<int, int>>> pieces = pieces_between();
    std::ranges::stable_sort(pieces, std::greater<>(), &std::vector<std::pair<int, int>>::size);
    NamedSurfaces result;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      for (const auto& [x, y] : pieces[i]) {
        labels_(x, y) = static_cast<int>(i) + 1;
      }
      result.names.push_back(name_of(pieces[i]));
    }
    for (int round = 0; round < kGrown_px; ++round) {
      grow();
    }
    result.labels = std::move(labels_);
    return result;
  }

 private:
  static constexpr int kOpen = -2;  ///< of the part, no label yet

  bool is_inside(int x, int y) const {
    return x >= 0 && y >= 0 && x < labels_.width() && y < labels_.height();
  }

  bool is_part(int x, int y) const { return is_inside(x, y) && surface_.is_part(x, y); }

  double pixel_mm(int x, int y) const { return surface_.depth_mm(x, y) / focal_px_; }

  /// Whether an edge runs between two pixels that are two apart.
  bool is_edge_between(int x0, int y0, int x1, int y1) const {
    if (!is_part(x0, y0) || !is_part(x1, y1)) {
      return false;
    }
    const Vector3d step = surface_.point_mm(x1, y1) - surface_.point_mm(x0, y0);
    const Vector3d first = surface_.normal(x0, y0);
    const Vector3d second = surface_.normal(x1, y1);
    const double pixel = std::min(pixel_mm(x0, y0), pixel_mm(x1, y1));
    const double bend = 0.5 * (second - first).norm();
    const bool is_sharp = step.norm() < 2.0 * bend * kSharp_px * pixel;
    if (bend > kSurelyBend || (bend > kLeastBend && is_sharp)) {
      return true;
    }
    const double above = std::min(std::abs(step.dot(first)), std::abs(step.dot(second)));
    return above > std::max(kStep_px * pixel, kStepShare * step.norm());
  }

  void mark_edges() {
    for (int y = 0; y < labels_.height(); ++y) {
      for (int x = 0; x < labels_.width(); ++x) {
        if (surface_.is_part(x, y)) {
          const bool is_edge =
              is_edge_between(x - 1, y, x + 1, y) || is_edge_between(x, y - 1, x, y + 1);
          labels_(x, y) = is_edge ? NamedSurfaces::kNone : kOpen;
        }
      }
    }
  }

  /// Connected pixels without an edge, those of a size worth a name; the others are of none.
  std::vector<std::vector<std::pair<int, int>>> pieces_between() {
    std::vector<std::vector<std::pair<int, int>>> pieces;
    for (int y = 0; y < labels_.height(); ++y) {
      for (int x = 0; x < labels_.width(); ++x) {
        if (labels_(x, y) != kOpen) {
          continue;
        }
        std::vector<std::pair<int, int>> piece = flooded(x, y);
        if (piece.size() >= kLeastPixels) {
          pieces.push_back(std::move(piece));
        }
      }
    }
    return pieces;
  }

  std::vector<std::pair<int, int>> flooded(int x0, int y0) {
    std::vector<std::pair<int, int>> piece = {{x0, y0}};
    labels_(x0, y0) = NamedSurfaces::kNone;
    for (std::size_t i = 0; i < piece.size(); ++i) {
      for (const auto& [dx, dy] : kNeighbours) {
        const int x = piece[i].first + dx;
        const int y = piece[i].second + dy;
        if (is_inside(x, y) && labels_(x, y) == kOpen) {
          labels_(x, y) = NamedSurfaces::kNone;
          piece.emplace_back(x, y);
        }
      }
    }
    return piece;
  }

  std::string name_of(const std::vector<std::pair<int, int>>& piece) {
    const std::size_t stride = std::max<std::size_t>(piece.size() / kShapePoints, 1);
    std::vector<PointWithNormal> points;
    double pixel = 0.0;
    for (std::size_t i = 0; i < piece.size(); i += stride) {
      const auto& [x, y] = piece[i];
      points.push_back({.at_mm = surface_.point_mm(x, y), .normal = surface_.normal(x, y)});
      pixel = std::max(pixel, pixel_mm(x, y));
    }
    const std::string name = shape_name(points, pixel);
    const int number = ++numbers_[name];
    return number > 1 ? fmt::format("{} ({})", name, number) : name;
  }

  /// Pixels of an edge go to the neighbour whose normal is most like theirs.
  void grow() {
    Image<int> grown = labels_;
    for (int y = 0; y < labels_.height(); ++y) {
      for (int x = 0; x < labels_.width(); ++x) {
        if (labels_(x, y) != NamedSurfaces::kNone) {
          continue;
        }
        double most = -2.0;
        for (const auto& [dx, dy] : kNeighbours) {
          if (is_inside(x + dx, y + dy) && labels_(x + dx, y + dy) > 0) {
            const double alike = surface_.normal(x, y).dot(surface_.normal(x + dx, y + dy));
            grown(x, y) = alike > most ? labels_(x + dx, y + dy) : grown(x, y);
            most = std::max(most, alike);
          }
        }
      }
    }
    labels_ = std::move(grown);
  }

  const SimulatedSurface& surface_;
  double focal_px_;
  Image<int> labels_;
  std::map<std::string, int> numbers_;
};

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

int NamedSurfaces::at(const Vector2d& at_px) const {
  const int x = static_cast<int>(std::floor(at_px.x()));
  const int y = static_cast<int>(std::floor(at_px.y()));
  const bool is_inside = x >= 0 && y >= 0 && x < labels.width() && y < labels.height();
  return is_inside ? labels(x, y) : kBackground;
}

const std::string& NamedSurfaces::name_of(int label) const {
  static const std::string background = "background";
  return label > 0 ? names[static_cast<std::size_t>(label) - 1] : background;
}

NamedSurfaces find_surfaces(const SimulatedSurface& surface, double focal_px) {
  return SurfaceFinder(surface, focal_px).find();
}

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

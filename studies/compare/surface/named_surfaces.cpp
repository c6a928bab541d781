// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/surface/named_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "studies/compare/surface/surface_pieces.h"
#include "studies/compare/surface/surface_shape.h"

namespace glint {
namespace {

using compare_detail::Piece;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMinBend = 0.1305;  ///< half of the change of a unit normal: 15 deg
constexpr double kSurelyBend =
    0.5;                           ///< no limb of a ball of more than four pixels bends so: 60 deg
constexpr double kSharp_px = 8.0;  ///< radius below which a bend is an edge
constexpr double kMinFacetBend = 0.1219;  ///< between flat pieces: 14 deg
constexpr double kFlatShare = 0.1;        ///< of a bend, by which the surface turns beside an edge
constexpr std::size_t kMinPixels = 100;
constexpr std::size_t kShapePoints = 2000;
constexpr int kGrown_px = 3;  ///< over the pixels of an edge, which mix two surfaces

constexpr std::array<std::pair<int, int>, 4> kNeighbours = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

class SurfaceFinder {
 public:
  SurfaceFinder(const SimulatedSurface& surface, double focal_px)
      : surface_(surface),
        focal_px_(focal_px),
        labels_(surface.width(), surface.height(), NamedSurfaces::kBackground) {}

  NamedSurfaces find() {
    mark_edges();
    std::vector<Piece> pieces = pieces_between();
    put_labels(pieces);
    pieces = compare_detail::joined_facets(surface_, focal_px_, labels_, std::move(pieces));
    std::ranges::stable_sort(
        pieces, std::greater<>(), [](const Piece& piece) { return piece.pixels.size(); });
    put_labels(pieces);
    NamedSurfaces result;
    for (const Piece& piece : pieces) {
      result.names.push_back(name_of(piece));
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
    if (bend > kSurelyBend || compare_detail::is_step(step, first, second, pixel)) {
      return true;
    }
    // Foreshortening leads a long way from one pixel to the next: there a bend is an edge where the
    // surface is flat on both sides of it.
    return bend > kMinBend && (step.norm() < 2.0 * bend * kSharp_px * pixel ||
                               (is_flat(2 * x0 - x1, 2 * y0 - y1, x0, y0, bend) &&
                                is_flat(x1, y1, 2 * x1 - x0, 2 * y1 - y0, bend)));
  }

  /// Whether the surface bends hardly at all from one pixel to another, beside so much elsewhere;
  /// beyond the part's limb nothing bends.
  bool is_flat(int x0, int y0, int x1, int y1, double beside) const {
    return !is_part(x0, y0) || !is_part(x1, y1) ||
           0.5 * (surface_.normal(x1, y1) - surface_.normal(x0, y0)).norm() < kFlatShare * beside;
  }

  /// Whether flat pieces meet at a pixel. Pixels at their edge mix both normals, so that a bend is
  /// whole only over some more of them.
  bool is_between_facets(int x, int y, int dx, int dy) const {
    const int x0 = x - 2 * dx;
    const int y0 = y - 2 * dy;
    const int x1 = x + 2 * dx;
    const int y1 = y + 2 * dy;
    if (!is_part(x0, y0) || !is_part(x1, y1)) {
      return false;
    }
    const double bend = 0.5 * (surface_.normal(x1, y1) - surface_.normal(x0, y0)).norm();
    return bend > kMinFacetBend && is_flat(x0 - 2 * dx, y0 - 2 * dy, x0, y0, bend) &&
           is_flat(x1, y1, x1 + 2 * dx, y1 + 2 * dy, bend);
  }

  void mark_edges() {
    for (int y = 0; y < labels_.height(); ++y) {
      for (int x = 0; x < labels_.width(); ++x) {
        if (surface_.is_part(x, y)) {
          const bool is_edge = is_edge_between(x - 1, y, x + 1, y) ||
                               is_edge_between(x, y - 1, x, y + 1) ||
                               is_between_facets(x, y, 1, 0) || is_between_facets(x, y, 0, 1);
          labels_(x, y) = is_edge ? NamedSurfaces::kNone : kOpen;
        }
      }
    }
  }

  /// Connected pixels without an edge, those of a size worth a name; the others are of none.
  std::vector<Piece> pieces_between() {
    std::vector<Piece> pieces;
    for (int y = 0; y < labels_.height(); ++y) {
      for (int x = 0; x < labels_.width(); ++x) {
        if (labels_(x, y) != kOpen) {
          continue;
        }
        std::vector<std::pair<int, int>> piece = flooded(x, y);
        if (piece.size() >= kMinPixels) {
          pieces.push_back({.pixels = std::move(piece)});
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

  /// Piece i gets the label i + 1.
  void put_labels(const std::vector<Piece>& pieces) {
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      for (const auto& [x, y] : pieces[i].pixels) {
        labels_(x, y) = static_cast<int>(i) + 1;
      }
    }
  }

  std::string name_of(const Piece& piece) {
    const std::string name = shape_name(compare_detail::points_of(surface_, piece, kShapePoints),
                                        compare_detail::pixel_of(surface_, piece, focal_px_),
                                        piece.shape ? piece.shape->step_rad : 0.0);
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

}  // namespace glint

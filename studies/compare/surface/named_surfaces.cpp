// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/surface/named_surfaces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "studies/compare/surface/facet_fans.h"
#include "studies/compare/surface/surface_shape.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kLeastBend = 0.1305;  ///< half of the change of a unit normal: 15 deg
constexpr double kSurelyBend =
    0.5;                            ///< no limb of a ball of more than four pixels bends so: 60 deg
constexpr double kSharp_px = 8.0;   ///< radius below which a bend is an edge
constexpr double kFlatShare = 0.1;  ///< of a bend, by which the surface turns beside an edge
constexpr double kStep_px = 1.5;    ///< above the tangent plane
constexpr double kStepShare = 0.35;  ///< of the distance; at the limb of a ball it is less
constexpr std::size_t kLeastPixels = 100;
constexpr std::size_t kShapePoints = 2000;
constexpr int kGrown_px = 3;  ///< over the pixels of an edge, which mix two surfaces

constexpr int kAcrossEdge_px = 4;  ///< both sides of an edge, two pixels of which are marked
constexpr int kLeastAcross = 5;    ///< pixels along an edge that two facets have in common
constexpr std::size_t kFacetPoints = 200;
constexpr double kFlat = 0.035;  ///< rms of a facet's normals about their mean, 2 deg

/// Connected pixels of one surface.
struct Piece {
  std::vector<std::pair<int, int>> pixels;
  double facet_rad = 0.0;  ///< turn between the facets that it has; 0: none
};

constexpr std::array<std::pair<int, int>, 4> kNeighbours = {{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};

/// Whether each of two points lies beyond the other's tangent plane.
bool is_step(const Vector3d& step, const Vector3d& first, const Vector3d& second, double pixel) {
  const double above = std::min(std::abs(step.dot(first)), std::abs(step.dot(second)));
  return above > std::max(kStep_px * pixel, kStepShare * step.norm());
}

/// The flat ones of some pieces.
struct FlatPieces {
  std::vector<FlatPiece> flat;
  std::vector<std::size_t> piece_of;    ///< of each its index among all pieces
  std::map<int, std::size_t> of_label;  ///< by the label of its piece
  double pixel_mm = 0.0;
};

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
    pieces = joined_facets(std::move(pieces));
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
    if (bend > kSurelyBend || is_step(step, first, second, pixel)) {
      return true;
    }
    // Foreshortening leads a long way from one pixel to the next: there a bend is an edge where the
    // surface is flat on both sides of it.
    return bend > kLeastBend && (step.norm() < 2.0 * bend * kSharp_px * pixel ||
                                 (is_flat(2 * x0 - x1, 2 * y0 - y1, x0, y0, bend) &&
                                  is_flat(x1, y1, 2 * x1 - x0, 2 * y1 - y0, bend)));
  }

  /// Whether the surface bends hardly at all from one pixel to another, beside so much elsewhere;
  /// beyond the part's limb nothing bends.
  bool is_flat(int x0, int y0, int x1, int y1, double beside) const {
    return !is_part(x0, y0) || !is_part(x1, y1) ||
           0.5 * (surface_.normal(x1, y1) - surface_.normal(x0, y0)).norm() < kFlatShare * beside;
  }

  /// Whether two pixels of the part with an edge between them are of one skin.
  bool is_joined(int x0, int y0, int x1, int y1) const {
    return !is_step(surface_.point_mm(x1, y1) - surface_.point_mm(x0, y0),
                    surface_.normal(x0, y0),
                    surface_.normal(x1, y1),
                    std::min(pixel_mm(x0, y0), pixel_mm(x1, y1)));
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
  std::vector<Piece> pieces_between() {
    std::vector<Piece> pieces;
    for (int y = 0; y < labels_.height(); ++y) {
      for (int x = 0; x < labels_.width(); ++x) {
        if (labels_(x, y) != kOpen) {
          continue;
        }
        std::vector<std::pair<int, int>> piece = flooded(x, y);
        if (piece.size() >= kLeastPixels) {
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

  std::vector<PointWithNormal> points_of(const Piece& piece, std::size_t about) const {
    const std::size_t stride = std::max<std::size_t>(piece.pixels.size() / about, 1);
    std::vector<PointWithNormal> points;
    for (std::size_t i = 0; i < piece.pixels.size(); i += stride) {
      const auto& [x, y] = piece.pixels[i];
      points.push_back({.at_mm = surface_.point_mm(x, y), .normal = surface_.normal(x, y)});
    }
    return points;
  }

  /// The largest of its pixels.
  double pixel_of(const Piece& piece) const {
    double pixel = 0.0;
    for (const auto& [x, y] : piece.pixels) {
      pixel = std::max(pixel, pixel_mm(x, y));
    }
    return pixel;
  }

  /// Nothing of one that is not flat.
  std::optional<FlatPiece> flat_piece(const Piece& piece) const {
    const std::vector<PointWithNormal> points = points_of(piece, kFacetPoints);
    const auto count = static_cast<double>(points.size());
    FlatPiece flat = {.normal = Vector3d::Zero()};
    for (const PointWithNormal& point : points) {
      flat.normal += point.normal / count;
      flat.middle_mm += point.at_mm / count;
      flat.points_mm.push_back(point.at_mm);
    }
    // Unit vectors have the variance 1 - |mean|^2.
    if (1.0 - flat.normal.squaredNorm() > kFlat * kFlat) {
      return std::nullopt;
    }
    flat.normal.normalize();
    return flat;
  }

  FlatPieces flat_pieces(const std::vector<Piece>& pieces) const {
    FlatPieces result;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
      if (auto flat = flat_piece(pieces[i])) {
        result.of_label[static_cast<int>(i) + 1] = result.flat.size();
        result.flat.push_back(std::move(*flat));
        result.piece_of.push_back(i);
        result.pixel_mm = std::max(result.pixel_mm, pixel_of(pieces[i]));
      }
    }
    return result;
  }

  /// Labels on both sides of an edge that is no step, and how many pixels of it.
  std::map<std::pair<int, int>, int> joined_labels() const {
    std::map<std::pair<int, int>, int> counts;
    const auto add = [&](int x0, int y0, int x1, int y1) {
      if (!is_part(x0, y0) || !is_part(x1, y1)) {
        return;
      }
      const int one = std::min(labels_(x0, y0), labels_(x1, y1));
      const int other = std::max(labels_(x0, y0), labels_(x1, y1));
      if (one > 0 && one != other && is_joined(x0, y0, x1, y1)) {
        ++counts[{one, other}];
      }
    };
    for (int y = 0; y < labels_.height(); ++y) {
      for (int x = 0; x < labels_.width(); ++x) {
        add(x, y, x + kAcrossEdge_px, y);
        add(x, y, x, y + kAcrossEdge_px);
      }
    }
    return counts;
  }

  /// Facets of a mesh that stand for one round surface become one piece.
  std::vector<Piece> joined_facets(std::vector<Piece> pieces) const {
    const FlatPieces flat = flat_pieces(pieces);
    std::vector<std::pair<std::size_t, std::size_t>> neighbours;
    for (const auto& [labels, count] : joined_labels()) {
      const auto one = flat.of_label.find(labels.first);
      const auto other = flat.of_label.find(labels.second);
      if (count >= kLeastAcross && one != flat.of_label.end() && other != flat.of_label.end()) {
        neighbours.emplace_back(one->second, other->second);
      }
    }
    for (const FacetFan& fan : facet_fans(flat.flat, neighbours, flat.pixel_mm)) {
      Piece& whole = pieces[flat.piece_of[fan.pieces.front()]];
      whole.facet_rad = fan.step_rad;
      for (const std::size_t index : std::span(fan.pieces).subspan(1)) {
        std::vector<std::pair<int, int>>& pixels = pieces[flat.piece_of[index]].pixels;
        whole.pixels.insert(whole.pixels.end(), pixels.begin(), pixels.end());
        pixels.clear();
      }
    }
    std::erase_if(pieces, [](const Piece& piece) { return piece.pixels.empty(); });
    return pieces;
  }

  std::string name_of(const Piece& piece) {
    const std::string name =
        shape_name(points_of(piece, kShapePoints), pixel_of(piece), piece.facet_rad);
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

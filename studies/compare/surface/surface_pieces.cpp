// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/surface/surface_pieces.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace glint::compare_detail {
namespace {

using Eigen::Vector3d;

constexpr int kAcrossEdge_px = 6;  ///< both sides of an edge, up to four pixels of which are marked
constexpr int kMinAcross =
    5;  ///< looks across an edge that two facets have in common, some per row
constexpr std::size_t kFacetPoints = 200;
constexpr double kFlat = 0.035;      ///< rms of a facet's normals about their mean, 2 deg
constexpr double kHeight_px = 1.5;   ///< above the tangent plane
constexpr double kStepShare = 0.35;  ///< of the distance; at the limb of a ball it is less

/// The flat ones of some pieces.
struct FlatPieces {
  std::vector<FlatPiece> flat;
  std::vector<std::size_t> piece_of;    ///< of each its index among all pieces
  std::map<int, std::size_t> of_label;  ///< by the label of its piece
  double pixel_mm = 0.0;
};

class FacetJoiner {
 public:
  FacetJoiner(const SimulatedSurface& surface, double focal_px, const Image<int>& labels)
      : surface_(surface), focal_px_(focal_px), labels_(labels) {}

  std::vector<Piece> joined(std::vector<Piece> pieces) const {
    const FlatPieces flat = flat_pieces(pieces);
    std::vector<std::pair<std::size_t, std::size_t>> neighbours;
    for (const auto& [labels, count] : joined_labels()) {
      const auto one = flat.of_label.find(labels.first);
      const auto other = flat.of_label.find(labels.second);
      if (count >= kMinAcross && one != flat.of_label.end() && other != flat.of_label.end()) {
        neighbours.emplace_back(one->second, other->second);
      }
    }
    std::map<int, std::size_t> whole_of;
    for (const FacetFan& fan : facet_fans(flat.flat, neighbours, flat.pixel_mm)) {
      const std::size_t whole = flat.piece_of[fan.pieces.front()];
      pieces[whole].shape = fan.shape;
      for (const std::size_t index : fan.pieces) {
        whole_of[static_cast<int>(flat.piece_of[index]) + 1] = whole;
        move_pixels(pieces, flat.piece_of[index], whole);
      }
    }
    join_the_rest(flat, std::move(whole_of), pieces);
    std::erase_if(pieces, [](const Piece& piece) { return piece.pixels.empty(); });
    return pieces;
  }

 private:
  /// Whether two pixels of the part with an edge between them are of one skin.
  bool is_joined(int x0, int y0, int x1, int y1) const {
    return !is_step(surface_.point_mm(x1, y1) - surface_.point_mm(x0, y0),
                    surface_.normal(x0, y0),
                    surface_.normal(x1, y1),
                    std::min(surface_.depth_mm(x0, y0), surface_.depth_mm(x1, y1)) / focal_px_);
  }

  /// Nothing of one that is not flat.
  std::optional<FlatPiece> flat_piece(const Piece& piece) const {
    const std::vector<PointWithNormal> points = points_of(surface_, piece, kFacetPoints);
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
        result.pixel_mm = std::max(result.pixel_mm, pixel_of(surface_, pieces[i], focal_px_));
      }
    }
    return result;
  }

  /// Labels on both sides of an edge that is no step, and how many pixels of it.
  std::map<std::pair<int, int>, int> joined_labels() const {
    std::map<std::pair<int, int>, int> counts;
    const auto add = [&](int x0, int y0, int x1, int y1) {
      if (x1 >= labels_.width() || y1 >= labels_.height()) {
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

  static void move_pixels(std::vector<Piece>& pieces, std::size_t from, std::size_t to) {
    if (from != to) {
      std::vector<std::pair<int, int>> pixels = std::move(pieces[from].pixels);
      pieces[from].pixels.clear();
      pieces[to].pixels.insert(pieces[to].pixels.end(), pixels.begin(), pixels.end());
    }
  }

  /// Narrow facets beside the limb were not told apart: what has the shape of a fan beside it is of
  /// it. Planes are not: they would touch it in a line.
  /// @param whole_of  by label, of a fan's pieces the index of the one that holds them all
  void join_the_rest(const FlatPieces& flat,
                     std::map<int, std::size_t> whole_of,
                     std::vector<Piece>& pieces) const {
    std::map<int, double> pixels_mm;  // a look at all of a piece, which may have many neighbours
    const auto join = [&](int label, int other) {
      const auto found = whole_of.find(label);
      if (found == whole_of.end() || whole_of.contains(other) || flat.of_label.contains(other)) {
        return;
      }
      const std::size_t rest = static_cast<std::size_t>(other) - 1;
      const auto [pixel_mm, is_new] = pixels_mm.try_emplace(other, 0.0);
      if (is_new) {
        pixel_mm->second = pixel_of(surface_, pieces[rest], focal_px_);
      }
      if (pieces[found->second].shape->holds(points_of(surface_, pieces[rest], kFacetPoints),
                                             pixel_mm->second)) {
        move_pixels(pieces, rest, found->second);
        whole_of[other] = found->second;
      }
    };
    for (const auto& [labels, count] : joined_labels()) {
      if (count >= kMinAcross) {
        join(labels.first, labels.second);
        join(labels.second, labels.first);
      }
    }
  }

  const SimulatedSurface& surface_;
  double focal_px_;
  const Image<int>& labels_;
};

}  // namespace

bool is_step(const Vector3d& step, const Vector3d& first, const Vector3d& second, double pixel_mm) {
  const double above = std::min(std::abs(step.dot(first)), std::abs(step.dot(second)));
  return above > std::max(kHeight_px * pixel_mm, kStepShare * step.norm());
}

std::vector<PointWithNormal> points_of(const SimulatedSurface& surface,
                                       const Piece& piece,
                                       std::size_t about) {
  const std::size_t stride = std::max<std::size_t>(piece.pixels.size() / about, 1);
  std::vector<PointWithNormal> points;
  for (std::size_t i = 0; i < piece.pixels.size(); i += stride) {
    const auto& [x, y] = piece.pixels[i];
    points.push_back({.at_mm = surface.point_mm(x, y), .normal = surface.normal(x, y)});
  }
  return points;
}

double pixel_of(const SimulatedSurface& surface, const Piece& piece, double focal_px) {
  double depth_mm = 0.0;
  for (const auto& [x, y] : piece.pixels) {
    depth_mm = std::max(depth_mm, surface.depth_mm(x, y));
  }
  return depth_mm / focal_px;
}

std::vector<Piece> joined_facets(const SimulatedSurface& surface,
                                 double focal_px,
                                 const Image<int>& labels,
                                 std::vector<Piece> pieces) {
  return FacetJoiner(surface, focal_px, labels).joined(std::move(pieces));
}

}  // namespace glint::compare_detail

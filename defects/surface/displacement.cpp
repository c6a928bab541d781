// SPDX-License-Identifier: GPL-3.0-or-later
//
// A defect as a fine mesh that is really moved along the normal of the smooth surface. Faces near
// it are bisected until linear triangles miss the height by less than 1/512 of it
// (edge_bisection.h), vertices are moved, and corner normals are those of the height field, not of
// the facets. The change of volume is summed exactly over the faces: the volume that a moving
// triangle sweeps is the integral of a quadratic, for which Simpson's rule is exact. Own
// derivation: docs/theory/imprint.md, "Displacement". Cost: one copy and two passes over the mesh,
// then about 7,000 triangles for a dent.
#include "defects/surface/displacement.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <unordered_map>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/error.h"
#include "core/units.h"
#include "defects/surface/edge_bisection.h"
#include "defects/surface/feature_reach.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Area of the fine part over the area of an equilateral triangle of the allowed edge, doubled
/// because bisection stops between half the allowed edge and the whole.
void check_effort(const HeightFeature& feature, double edges_per_sigma) {
  constexpr double kMaxFaces = 2e7;
  const double half = feature.half_line_mm() / feature.cross_sigma_mm();
  const double area = 4.0 * kPi + 8.0 * half;  // sigma^2, within the radius
  const double faces = 2.0 * area * edges_per_sigma * edges_per_sigma / 0.433;
  if (faces > kMaxFaces) {
    throw ConfigError(fmt::format(
        "defect \"{}\": displacing it needs {:.2g} triangles, at most {:.0g} are allowed; make it "
        "shorter or wider, or realise it by its normal",
        feature.label,
        faces,
        kMaxFaces));
  }
}

std::vector<HeightFeature> with_height(std::span<const HeightFeature> features,
                                       double edges_per_sigma) {
  std::vector<HeightFeature> kept;
  for (const HeightFeature& feature : features) {
    if (feature.height_mm != 0.0) {
      kept.push_back(feature);
      check_effort(feature, edges_per_sigma);
    }
  }
  return kept;
}

/// A vertex before and after.
struct Move {
  Vector3d from_mm = Vector3d::Zero();
  Vector3d to_mm = Vector3d::Zero();
  int feature = -1;  ///< id of the nearest one
};

/// The volume a triangle passes through when its corners run straight from their old places to the
/// new ones; positive outwards. Exact (the area vector is quadratic in time: Simpson's rule), and
/// the same along an edge for both of its faces, so that the sum is the change of enclosed volume.
double swept_volume_mm3(const std::array<Vector3d, 3>& from, const std::array<Vector3d, 3>& to) {
  const auto area_at = [&](double time) {
    std::array<Vector3d, 3> p = {};
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = (1.0 - time) * from[k] + time * to[k];
    }
    return Vector3d(0.5 * (p[1] - p[0]).cross(p[2] - p[0]));
  };
  const Vector3d mean_move = (to[0] - from[0] + to[1] - from[1] + to[2] - from[2]) / 3.0;
  const Vector3d mean_area = (area_at(0.0) + 4.0 * area_at(0.5) + area_at(1.0)) / 6.0;
  return mean_move.dot(mean_area);
}

class Displacement {
 public:
  Displacement(Displaced& out, std::span<const ExactPatch> patches, const SurfaceDetail& detail)
      : out_(out), mesh_(out.mesh), patches_(patches), detail_(detail) {
    for (std::size_t i = 0; i < out.features.size(); ++i) {
      number_of_.emplace(out.features[i].id, i);
    }
  }

  /// @param faces  all whose vertices may move
  /// @return vertices that moved, in the order they were met
  std::vector<std::int32_t> move_vertices(const std::vector<std::int32_t>& faces);

  /// Shortens moves that would turn a face over: where a defect reaches a sharp edge, the faces
  /// beyond the edge are dragged along and may be smaller than the move.
  /// @param faces  all that have a vertex that moved
  void limit_moves(const std::vector<std::int32_t>& faces);

  /// @param faces  the same
  void finish(const std::vector<std::int32_t>& faces);

 private:
  void gather_directions(std::int32_t face);
  bool has_moved(std::int32_t face) const;
  bool turns_over(std::int32_t face) const;
  void tilt_normals(std::int32_t face);
  void label(std::int32_t face);
  void count_volume(std::int32_t face);
  void set_free(std::int32_t face);
  Vector3d old_place(std::int32_t vertex) const;

  /// The distinct normals of a vertex's corners that a feature acts on.
  struct Direction {
    std::vector<std::int32_t> normals;
  };

  Displaced& out_;
  TriangleMesh& mesh_;
  std::span<const ExactPatch> patches_;
  const SurfaceDetail& detail_;
  std::unordered_map<int, std::size_t> number_of_;
  std::vector<std::int32_t> order_;
  std::unordered_map<std::int32_t, Direction> directions_;
  std::unordered_map<std::int32_t, Move> moves_;
  std::unordered_map<std::uint64_t, std::int32_t> tilted_;  ///< by vertex and old normal
};

void Displacement::gather_directions(std::int32_t face) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int32_t vertex = mesh_.triangles[at(face)][k];
    const std::int32_t normal = mesh_.corner_normals[at(face)][k];
    const SurfaceDetail::Sample sample =
        detail_.sample(mesh_.vertices_mm[at(vertex)], mesh_.normals[at(normal)]);
    if (sample.feature < 0) {
      continue;
    }
    const auto [place, is_new] = directions_.try_emplace(vertex);
    if (is_new) {
      order_.push_back(vertex);
    }
    std::vector<std::int32_t>& normals = place->second.normals;
    if (std::ranges::find(normals, normal) == normals.end()) {
      normals.push_back(normal);
    }
  }
}

std::vector<std::int32_t> Displacement::move_vertices(const std::vector<std::int32_t>& faces) {
  for (const std::int32_t face : faces) {
    gather_directions(face);
  }
  for (const std::int32_t vertex : order_) {
    Vector3d direction = Vector3d::Zero();
    for (const std::int32_t normal : directions_[vertex].normals) {
      direction += mesh_.normals[at(normal)];
    }
    direction.normalize();
    const Vector3d from = mesh_.vertices_mm[at(vertex)];
    const SurfaceDetail::Sample sample = detail_.sample(from, direction);
    moves_[vertex] = {
        .from_mm = from, .to_mm = from + sample.height_mm * direction, .feature = sample.feature};
  }
  return std::move(order_);
}

bool Displacement::has_moved(std::int32_t face) const {
  return std::ranges::any_of(mesh_.triangles[at(face)],
                             [&](std::int32_t vertex) { return moves_.contains(vertex); });
}

/// More than 84 degrees, a slope of 10: no height field is meant to be so steep.
bool Displacement::turns_over(std::int32_t face) const {
  std::array<Vector3d, 3> q = {};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int32_t vertex = mesh_.triangles[at(face)][k];
    const auto found = moves_.find(vertex);
    q[k] = found == moves_.end() ? mesh_.vertices_mm[at(vertex)] : found->second.to_mm;
  }
  const Vector3d before = area_vector(mesh_, at(face));
  const Vector3d after = 0.5 * (q[1] - q[0]).cross(q[2] - q[0]);
  constexpr double kMinCosine = 0.1;
  return before.dot(after) <= kMinCosine * before.norm() * after.norm();
}

void Displacement::limit_moves(const std::vector<std::int32_t>& faces) {
  constexpr int kHalvings = 8;
  std::vector<std::int32_t> moved = faces;
  std::erase_if(moved, [&](std::int32_t face) {
    return !has_moved(face) || area_vector(mesh_, at(face)).isZero(0.0);
  });
  std::vector<std::int32_t> turned;
  for (int round = 0;; ++round) {
    turned.clear();
    std::ranges::copy_if(
        moved, std::back_inserter(turned), [&](std::int32_t face) { return turns_over(face); });
    if (turned.empty()) {
      return;
    }
    for (const std::int32_t face : turned) {
      for (const std::int32_t vertex : mesh_.triangles[at(face)]) {
        const auto found = moves_.find(vertex);
        if (found != moves_.end()) {
          Move& move = found->second;
          move.to_mm =
              round < kHalvings ? Vector3d(0.5 * (move.from_mm + move.to_mm)) : move.from_mm;
        }
      }
    }
  }
}

void Displacement::finish(const std::vector<std::int32_t>& faces) {
  for (const std::int32_t face : faces) {
    if (has_moved(face)) {
      label(face);
      count_volume(face);
      tilt_normals(face);
    }
  }
  for (const auto& [vertex, move] : moves_) {
    mesh_.vertices_mm[at(vertex)] = move.to_mm;
  }
  for (const std::int32_t face : faces) {
    if (has_moved(face)) {
      set_free(face);
    }
  }
}

Vector3d Displacement::old_place(std::int32_t vertex) const {
  return mesh_.vertices_mm[at(vertex)];
}

void Displacement::label(std::int32_t face) {
  Vector3d centre = Vector3d::Zero();
  Vector3d normal = Vector3d::Zero();
  for (std::size_t k = 0; k < 3; ++k) {
    centre += mesh_.vertex(at(face), k) / 3.0;
    normal += mesh_.normal(at(face), k);
  }
  const SurfaceDetail::Sample sample = detail_.sample(centre, normal.normalized());
  if (sample.feature >= 0 && sample.normalised_distance <= 1.0) {
    out_.labels[at(face)] = sample.feature;
    ++out_.features[number_of_.at(sample.feature)].faces;
  }
}

void Displacement::count_volume(std::int32_t face) {
  std::array<Vector3d, 3> from = {};
  std::array<Vector3d, 3> to = {};
  int feature = -1;
  double largest_mm = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int32_t vertex = mesh_.triangles[at(face)][k];
    from[k] = old_place(vertex);
    to[k] = from[k];
    const auto found = moves_.find(vertex);
    if (found == moves_.end()) {
      continue;
    }
    to[k] = found->second.to_mm;
    const double length_mm = (to[k] - from[k]).norm();
    if (found->second.feature >= 0 && (feature < 0 || length_mm > largest_mm)) {
      feature = found->second.feature;
      largest_mm = length_mm;
    }
  }
  const double volume_mm3 = swept_volume_mm3(from, to);
  out_.removed_volume_mm3 -= volume_mm3;
  if (feature >= 0) {
    out_.features[number_of_.at(feature)].removed_volume_mm3 -= volume_mm3;
  }
}

/// n - grad h, the normal of the height field over the smooth surface; corners that shared a normal
/// share the new one.
void Displacement::tilt_normals(std::int32_t face) {
  for (std::size_t k = 0; k < 3; ++k) {
    const std::int32_t vertex = mesh_.triangles[at(face)][k];
    const std::int32_t old_index = mesh_.corner_normals[at(face)][k];
    const Vector3d normal = mesh_.normals[at(old_index)];
    const SurfaceDetail::Sample sample = detail_.sample(old_place(vertex), normal);
    if (sample.feature < 0) {
      continue;
    }
    const std::uint64_t key =
        (static_cast<std::uint64_t>(vertex) << 32) | static_cast<std::uint64_t>(old_index);
    const auto [place, is_new] =
        tilted_.try_emplace(key, static_cast<std::int32_t>(mesh_.normals.size()));
    if (is_new) {
      const Vector3d tangential = sample.gradient - sample.gradient.dot(normal) * normal;
      mesh_.normals.push_back((normal - tangential).normalized());
    }
    mesh_.corner_normals[at(face)][k] = place->second;
  }
}

/// A face beside the defect, as the side of a plate, may still lie on its exact surface.
void Displacement::set_free(std::int32_t face) {
  const std::int32_t patch = mesh_.patch_of(at(face));
  if (patch < 0) {
    return;
  }
  constexpr double kStillOn_mm = 1e-9;
  const bool is_on = std::ranges::all_of(mesh_.triangles[at(face)], [&](std::int32_t vertex) {
    const auto found = moves_.find(vertex);
    return found == moves_.end() ||
           std::abs(implicit_value(patches_[at(patch)], found->second.to_mm, nullptr)) <=
               kStillOn_mm;
  });
  if (!is_on) {
    mesh_.patch[at(face)] = -1;
  }
}

std::vector<std::int32_t> faces_in_reach(const TriangleMesh& mesh,
                                         const FeatureReach& reach,
                                         double edges_per_sigma) {
  std::vector<std::int32_t> faces;
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    const auto face = static_cast<std::int32_t>(i);
    if (std::isfinite(reach.allowed_edge_mm(surface_triangle(mesh, face), edges_per_sigma))) {
      faces.push_back(face);
    }
  }
  return faces;
}

}  // namespace

Displaced displace(TriangleMesh mesh,
                   std::vector<std::int32_t> labels,
                   std::span<const ExactPatch> patches,
                   std::span<const HeightFeature> features,
                   double edges_per_sigma) {
  GLINT_CHECK(mesh.corner_normals.size() == mesh.num_triangles(), "the mesh has no normals");
  Displaced out = {
      .mesh = std::move(mesh), .labels = std::move(labels), .origin = {}, .features = {}};
  out.origin.resize(out.mesh.num_triangles());
  std::iota(out.origin.begin(), out.origin.end(), 0);
  for (const HeightFeature& feature : features) {
    out.features.push_back({.id = feature.id});
  }
  const SurfaceDetail detail(with_height(features, edges_per_sigma));
  if (detail.empty()) {
    return out;
  }
  const FeatureReach reach(detail.features());
  EdgeBisection bisection(out.mesh, out.labels, out.origin, patches);
  std::vector<std::int32_t> faces =
      bisection.refine(faces_in_reach(out.mesh, reach, edges_per_sigma), [&](std::int32_t face) {
        return reach.allowed_edge_mm(surface_triangle(out.mesh, face), edges_per_sigma);
      });
  Displacement displacement(out, patches, detail);
  for (const std::int32_t vertex : displacement.move_vertices(faces)) {
    const std::vector<std::int32_t> around = bisection.old_faces_at(vertex);
    faces.insert(faces.end(), around.begin(), around.end());
  }
  std::ranges::sort(faces);
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  displacement.limit_moves(faces);
  displacement.finish(faces);
  return out;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Moves vertices as far as the mesh allows without crossing itself. All faces that move are tested
// against all others by exact predicates and against turning over; the vertices of faces that fail
// keep half of their move, up to six times and then none, and only what changed is tested again. A
// limit of 0.3 of the smallest height of the triangles around a vertex avoids most failures
// beforehand. Own method: docs/theory/imprint.md, "No self-intersections". Cost: one tree of boxes
// and one query per moved face and round.
#include "defects/surface/safe_moves.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include "core/error.h"
#include "defects/boolean/box_tree.h"
#include "defects/boolean/patch_crossings.h"
#include "defects/surface/half_edges.h"

namespace glint {
namespace {

using Eigen::Vector3d;

TestFace test_face(const TriangleMesh& mesh, std::int32_t face) {
  const std::size_t i = at(face);
  return {mesh.triangles[i], Corners{mesh.vertex(i, 0), mesh.vertex(i, 1), mesh.vertex(i, 2)}};
}

std::vector<FloatBox> boxes_of(const TriangleMesh& mesh) {
  std::vector<FloatBox> boxes;
  boxes.reserve(mesh.num_triangles());
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    boxes.push_back(box_of(mesh.vertex(i, 0), mesh.vertex(i, 1), mesh.vertex(i, 2)));
  }
  return boxes;
}

/// Faces that cross another one in more than shared corners, in ascending order, by exact
/// predicates; only pairs of which at least one is among the given faces. Faces without area are
/// left out.
std::vector<std::int32_t> crossing_faces(const TriangleMesh& mesh,
                                         const std::vector<std::int32_t>& among) {
  const std::vector<FloatBox> boxes = boxes_of(mesh);
  const BoxTree tree(boxes);
  std::vector<char> is_among(mesh.num_triangles(), 0);
  for (const std::int32_t face : among) {
    is_among[at(face)] = 1;
  }
  std::vector<std::int32_t> crossing;
  for (const std::int32_t face : among) {
    const TestFace a = test_face(mesh, face);
    if (is_degenerate(a)) {
      continue;
    }
    tree.visit(boxes[at(face)], [&](std::int32_t other) {
      if (other == face || (other < face && is_among[at(other)] != 0)) {
        return;
      }
      const TestFace b = test_face(mesh, other);
      if (may_intersect(a, b) && !is_degenerate(b) && faces_cross(a, b)) {
        crossing.push_back(face);
        crossing.push_back(other);
      }
    });
  }
  std::ranges::sort(crossing);
  crossing.erase(std::unique(crossing.begin(), crossing.end()), crossing.end());
  return crossing;
}

/// The state of move_safely(): where the vertices were, and how much of its move each keeps.
class Mover {
 public:
  Mover(TriangleMesh& mesh, std::vector<Vector3d> moves_mm)
      : mesh_(mesh), from_mm_(mesh.vertices_mm), moves_mm_(std::move(moves_mm)) {
    GLINT_CHECK(moves_mm_.size() == from_mm_.size(), "one move a vertex");
    kept_.resize(from_mm_.size(), 1.0F);
    for (std::size_t i = 0; i < from_mm_.size(); ++i) {
      place(i);
    }
  }

  std::int64_t settle() {
    std::vector<std::int32_t> checked = faces_with_moves();
    for (int round = 0; !checked.empty(); ++round) {
      std::vector<std::int32_t> bad = crossing_faces(mesh_, checked);
      std::ranges::copy_if(
          checked, std::back_inserter(bad), [&](std::int32_t face) { return turns_over(face); });
      shorten(bad, round);
      checked = faces_with_changes();
    }
    return std::ranges::count_if(kept_, [](float share) { return share < 1.0F; });
  }

 private:
  bool is_moved(std::size_t vertex) const {
    return kept_[vertex] > 0.0F && !moves_mm_[vertex].isZero(0.0);
  }

  void place(std::size_t vertex) {
    mesh_.vertices_mm[vertex] =
        is_moved(vertex)
            ? Vector3d(from_mm_[vertex] + static_cast<double>(kept_[vertex]) * moves_mm_[vertex])
            : from_mm_[vertex];
  }

  std::vector<std::int32_t> faces_with_moves() const {
    return faces_where([&](std::size_t vertex) { return is_moved(vertex); });
  }

  std::vector<std::int32_t> faces_with_changes() {
    std::vector<char> is_changed(kept_.size(), 0);
    for (const std::int32_t vertex : changed_) {
      is_changed[at(vertex)] = 1;
    }
    return changed_.empty()
               ? std::vector<std::int32_t>()
               : faces_where([&](std::size_t vertex) { return is_changed[vertex] != 0; });
  }

  template <class Is>
  std::vector<std::int32_t> faces_where(const Is& is) const {
    std::vector<std::int32_t> faces;
    for (std::size_t i = 0; i < mesh_.num_triangles(); ++i) {
      if (std::ranges::any_of(mesh_.triangles[i], [&](std::int32_t v) { return is(at(v)); })) {
        faces.push_back(static_cast<std::int32_t>(i));
      }
    }
    return faces;
  }

  bool turns_over(std::int32_t face) const {
    const Triangle& t = mesh_.triangles[at(face)];
    const Vector3d& p = from_mm_[at(t[0])];
    const Vector3d before = 0.5 * (from_mm_[at(t[1])] - p).cross(from_mm_[at(t[2])] - p);
    const Vector3d after = area_vector(mesh_, at(face));
    constexpr double kMinCosine = 0.1;
    return !before.isZero(0.0) && before.dot(after) <= kMinCosine * before.norm() * after.norm();
  }

  /// Halves the moves of the faces' vertices, each vertex once.
  void shorten(const std::vector<std::int32_t>& faces, int round) {
    constexpr int kHalvings = 6;
    changed_.clear();
    for (const std::int32_t face : faces) {
      for (const std::int32_t vertex : mesh_.triangles[at(face)]) {
        if (is_moved(at(vertex))) {
          changed_.push_back(vertex);
        }
      }
    }
    std::ranges::sort(changed_);
    changed_.erase(std::unique(changed_.begin(), changed_.end()), changed_.end());
    for (const std::int32_t vertex : changed_) {
      kept_[at(vertex)] = round < kHalvings ? 0.5F * kept_[at(vertex)] : 0.0F;
      place(at(vertex));
    }
  }

  TriangleMesh& mesh_;
  std::vector<Vector3d> from_mm_;
  std::vector<Vector3d> moves_mm_;
  std::vector<float> kept_;  ///< share of its move that a vertex keeps: 2^-n or 0
  std::vector<std::int32_t> changed_;
};

/// Smallest height of a triangle; 0 without area.
double smallest_height_mm(const TriangleMesh& mesh, std::size_t face) {
  double longest_mm = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    longest_mm =
        std::max(longest_mm, (mesh.vertex(face, (k + 1) % 3) - mesh.vertex(face, k)).norm());
  }
  return longest_mm > 0.0 ? 2.0 * area_vector(mesh, face).norm() / longest_mm : 0.0;
}

}  // namespace

std::int64_t move_safely(TriangleMesh& mesh, std::vector<Vector3d> moves_mm) {
  return Mover(mesh, std::move(moves_mm)).settle();
}

std::int64_t limit_to_heights(const TriangleMesh& mesh,
                              double share,
                              std::vector<Vector3d>& moves_mm) {
  std::vector<double> allowed_mm(moves_mm.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    const double height_mm = smallest_height_mm(mesh, i);
    for (const std::int32_t vertex : mesh.triangles[i]) {
      allowed_mm[at(vertex)] = std::min(allowed_mm[at(vertex)], share * height_mm);
    }
  }
  std::int64_t count = 0;
  for (std::size_t i = 0; i < moves_mm.size(); ++i) {
    const double length_mm = moves_mm[i].norm();
    if (length_mm > allowed_mm[i]) {
      moves_mm[i] *= allowed_mm[i] / length_mm;
      ++count;
    }
  }
  return count;
}

}  // namespace glint

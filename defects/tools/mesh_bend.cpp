// SPDX-License-Identifier: GPL-3.0-or-later
//
// A straight tool is cut by planes across x into slabs thin enough that chords follow the path,
// edges that two triangles share getting one point, and then each vertex is put where its frame
// along the path has it. Cost: one pass over the triangles a plane, at most 400 planes.
// docs/theory/imprint.md, "Tools".
#include "defects/tools/mesh_bend.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

namespace glint {
namespace {

constexpr double kMaxSlabs = 400.0;

/// Cuts every triangle that a plane x = const crosses; shared edges get one point.
class PlaneCut {
 public:
  PlaneCut(TriangleMesh& mesh, double x_mm, double snap_mm) : mesh_(mesh), x_mm_(x_mm) {
    side_.reserve(mesh.vertices_mm.size());
    for (const Eigen::Vector3d& p : mesh.vertices_mm) {
      const double ahead = p.x() - x_mm;
      side_.push_back(std::abs(ahead) <= snap_mm ? 0 : (ahead < 0.0 ? -1 : 1));
    }
  }

  void run() {
    std::vector<Triangle> triangles;
    triangles.reserve(mesh_.triangles.size() + 64);
    for (const Triangle& triangle : mesh_.triangles) {
      cut(triangle, triangles);
    }
    mesh_.triangles = std::move(triangles);
  }

 private:
  int side(std::int32_t vertex) const { return side_[static_cast<std::size_t>(vertex)]; }

  /// The corner that is alone on its side, or lies in the plane.
  std::size_t first_corner(const Triangle& t) const {
    std::size_t first = 0;
    while (!(side(t[first]) == 0 || (side(t[first]) != side(t[(first + 1) % 3]) &&
                                     side(t[first]) != side(t[(first + 2) % 3]) &&
                                     side(t[(first + 1) % 3]) == side(t[(first + 2) % 3])))) {
      ++first;
    }
    return first;
  }

  void cut(const Triangle& t, std::vector<Triangle>& out) {
    const int lowest = std::min({side(t[0]), side(t[1]), side(t[2])});
    const int highest = std::max({side(t[0]), side(t[1]), side(t[2])});
    if (lowest >= 0 || highest <= 0) {
      out.push_back(t);
      return;
    }
    const std::size_t first = first_corner(t);
    const std::int32_t a = t[first];
    const std::int32_t b = t[(first + 1) % 3];
    const std::int32_t c = t[(first + 2) % 3];
    if (side(a) == 0) {
      const std::int32_t bc = split(b, c);
      out.push_back({a, b, bc});
      out.push_back({a, bc, c});
      return;
    }
    const std::int32_t ab = split(a, b);
    const std::int32_t ca = split(a, c);
    out.push_back({a, ab, ca});
    out.push_back({ab, b, c});
    out.push_back({ab, c, ca});
  }

  std::int32_t split(std::int32_t from, std::int32_t to) {
    const auto key = std::minmax(from, to);
    const auto [place, is_new] =
        points_.try_emplace(key, static_cast<std::int32_t>(mesh_.vertices_mm.size()));
    if (is_new) {
      const Eigen::Vector3d a = mesh_.vertices_mm[static_cast<std::size_t>(key.first)];
      const Eigen::Vector3d b = mesh_.vertices_mm[static_cast<std::size_t>(key.second)];
      Eigen::Vector3d p = a + (x_mm_ - a.x()) / (b.x() - a.x()) * (b - a);
      p.x() = x_mm_;
      mesh_.vertices_mm.push_back(p);
    }
    return place->second;
  }

  TriangleMesh& mesh_;
  double x_mm_;
  std::vector<int> side_;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> points_;
};

}  // namespace

TriangleMesh bent_along(const TriangleMesh& mesh,
                        const LineFrames& frames,
                        double step_mm,
                        double window_mm) {
  TriangleMesh bent = mesh;
  if (!frames.is_straight()) {
    const BoundingBox box = bounding_box(mesh);
    const double length = box.size_mm().x();
    const int slabs = static_cast<int>(std::ceil(std::min(kMaxSlabs, length / step_mm)));
    for (int i = 1; i < slabs; ++i) {
      PlaneCut(bent, box.min_mm.x() + length * i / slabs, 1e-6 * length / slabs).run();
    }
  }
  for (Eigen::Vector3d& p : bent.vertices_mm) {
    p = frames.at(p.x(), window_mm).at(p.y(), p.z());
  }
  return bent;
}

TriangleMesh quartered(const TriangleMesh& mesh) {
  TriangleMesh finer;
  finer.vertices_mm = mesh.vertices_mm;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
  const auto middle_of = [&](std::int32_t a, std::int32_t b) {
    const auto [place, is_new] =
        middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(finer.vertices_mm.size()));
    if (is_new) {
      const Eigen::Vector3d p = mesh.vertices_mm[static_cast<std::size_t>(a)];
      finer.vertices_mm.emplace_back(0.5 * (p + mesh.vertices_mm[static_cast<std::size_t>(b)]));
    }
    return place->second;
  };
  for (const Triangle& t : mesh.triangles) {
    const Triangle middle = {middle_of(t[0], t[1]), middle_of(t[1], t[2]), middle_of(t[2], t[0])};
    finer.triangles.push_back({t[0], middle[0], middle[2]});
    finer.triangles.push_back({middle[0], t[1], middle[1]});
    finer.triangles.push_back({middle[2], middle[1], t[2]});
    finer.triangles.push_back(middle);
  }
  return finer;
}

}  // namespace glint

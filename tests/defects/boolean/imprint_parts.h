// SPDX-License-Identifier: GPL-3.0-or-later
//
// Closed parts for the tests and benchmarks of imprints.
#pragma once

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "core/units.h"
#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint::imprint_support {

using Eigen::Vector3d;

inline std::int32_t add_vertex(TriangleMesh& mesh, const Vector3d& point) {
  mesh.vertices_mm.push_back(point);
  return static_cast<std::int32_t>(mesh.vertices_mm.size()) - 1;
}

inline void turn_outwards(TriangleMesh& mesh) {
  if (enclosed_volume_mm3(mesh) < 0.0) {
    for (Triangle& triangle : mesh.triangles) {
      std::swap(triangle[1], triangle[2]);
    }
  }
}

/// Splits every triangle in four; new points are pushed to the unit sphere.
inline TriangleMesh split_on_sphere(const TriangleMesh& mesh) {
  TriangleMesh out;
  out.vertices_mm = mesh.vertices_mm;
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
  for (const Triangle& t : mesh.triangles) {
    Triangle m = {};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto edge = std::minmax(t[k], t[(k + 1) % 3]);
      const auto found = middles.find(edge);
      if (found != middles.end()) {
        m[k] = found->second;
        continue;
      }
      const Vector3d sum = mesh.vertices_mm[static_cast<std::size_t>(edge.first)] +
                           mesh.vertices_mm[static_cast<std::size_t>(edge.second)];
      m[k] = add_vertex(out, sum.normalized());
      middles[edge] = m[k];
    }
    out.triangles.push_back({t[0], m[0], m[2]});
    out.triangles.push_back({m[0], t[1], m[1]});
    out.triangles.push_back({m[2], m[1], t[2]});
    out.triangles.push_back({m[0], m[1], m[2]});
  }
  return out;
}

/// Unit sphere of 20 * 4^level triangles; has vertices on the coordinate planes.
inline TriangleMesh unit_sphere(int level) {
  const double golden = 0.5 * (1.0 + std::sqrt(5.0));
  TriangleMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double a : {-1.0, 1.0}) {
      for (const double b : {-golden, golden}) {
        Vector3d point = Vector3d::Zero();
        point[(axis + 1) % 3] = a;
        point[(axis + 2) % 3] = b;
        add_vertex(mesh, point.normalized());
      }
    }
  }
  // Faces: the triples of corners that are one edge apart from each other.
  const double edge = (mesh.vertices_mm[0] - mesh.vertices_mm[2]).norm();
  const auto is_near = [&](std::size_t i, std::size_t j) {
    return (mesh.vertices_mm[i] - mesh.vertices_mm[j]).norm() < 1.01 * edge;
  };
  for (std::size_t i = 0; i < 12; ++i) {
    for (std::size_t j = i + 1; j < 12; ++j) {
      for (std::size_t k = j + 1; k < 12; ++k) {
        if (!is_near(i, j) || !is_near(j, k) || !is_near(i, k)) {
          continue;
        }
        const Vector3d& a = mesh.vertices_mm[i];
        const bool is_outwards = a.dot(mesh.vertices_mm[j].cross(mesh.vertices_mm[k])) > 0.0;
        const auto x = static_cast<std::int32_t>(j);
        const auto y = static_cast<std::int32_t>(k);
        mesh.triangles.push_back(
            {static_cast<std::int32_t>(i), is_outwards ? x : y, is_outwards ? y : x});
      }
    }
  }
  for (int i = 0; i < level; ++i) {
    mesh = split_on_sphere(mesh);
  }
  return mesh;
}

/// A box from `low` to `high` with n x n squares of two triangles a side.
inline TriangleMesh box(const Vector3d& low, const Vector3d& high, int n) {
  TriangleMesh mesh;
  const auto row = [&](int axis, int i) {
    const double t = static_cast<double>(i) / n;
    return i == n ? high[axis] : low[axis] + t * (high[axis] - low[axis]);
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    for (int side = 0; side < 2; ++side) {
      const auto first = static_cast<std::int32_t>(mesh.vertices_mm.size());
      for (int i = 0; i <= n; ++i) {
        for (int j = 0; j <= n; ++j) {
          Vector3d point;
          point[axis] = side == 0 ? low[axis] : high[axis];
          point[u] = row(u, i);
          point[v] = row(v, j);
          add_vertex(mesh, point);
        }
      }
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j < n; ++j) {
          const std::int32_t a = first + i * (n + 1) + j;
          const std::int32_t b = a + n + 1;
          Triangle lower = {a, b, b + 1};
          Triangle upper = {a, b + 1, a + 1};
          if (side == 0) {
            std::swap(lower[1], lower[2]);
            std::swap(upper[1], upper[2]);
          }
          mesh.triangles.push_back(lower);
          mesh.triangles.push_back(upper);
        }
      }
    }
  }
  weld(mesh);
  return mesh;
}

inline TriangleMesh cube(double side_mm, int n) {
  const Vector3d half = Vector3d::Constant(0.5 * side_mm);
  return box(-half, half, n);
}

/// Corners of the outline of a spur gear, counter-clockwise, split to pieces of at most edge_mm.
inline std::vector<Vector3d> gear_outline(int teeth, double module_mm, double edge_mm) {
  const double pitch = 2.0 * kPi / teeth;
  const double root = 0.5 * module_mm * teeth - 1.25 * module_mm;
  const double tip = 0.5 * module_mm * teeth + module_mm;
  std::vector<Vector3d> corners;
  for (int tooth = 0; tooth < teeth; ++tooth) {
    const auto add = [&](double part, double radius) {
      const double angle = (tooth + part) * pitch;
      corners.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0.0);
    };
    add(0.0, root);
    add(0.22, root);
    add(0.37, tip);
    add(0.63, tip);
    add(0.78, root);
  }
  std::vector<Vector3d> outline;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vector3d& from = corners[i];
    const Vector3d& to = corners[(i + 1) % corners.size()];
    const int pieces = std::max(1, static_cast<int>(std::ceil((to - from).norm() / edge_mm)));
    for (int k = 0; k < pieces; ++k) {
      outline.emplace_back(from + (static_cast<double>(k) / pieces) * (to - from));
    }
  }
  return outline;
}

/// A closed spur gear with a bore, edges of about edge_mm: rings of the outline, from the bore
/// outwards on the bottom, up the flanks, inwards on the top and down the bore.
inline TriangleMesh gear(double edge_mm, int teeth = 24) {
  constexpr double kModule_mm = 4.0;
  constexpr double kBore_mm = 15.0;
  constexpr double kWidth_mm = 20.0;
  const std::vector<Vector3d> outline = gear_outline(teeth, kModule_mm, edge_mm);
  const double reach = 0.5 * kModule_mm * teeth - kBore_mm;
  const int across = std::max(2, static_cast<int>(std::lround(reach / edge_mm)));
  const int up = std::max(2, static_cast<int>(std::lround(kWidth_mm / edge_mm)));
  TriangleMesh mesh;
  const auto add_ring = [&](double out, double z_mm) {
    for (const Vector3d& corner : outline) {
      const Vector3d bore = corner * (kBore_mm / corner.norm());
      const Vector3d point = bore + out * (corner - bore);
      add_vertex(mesh, {point.x(), point.y(), z_mm});
    }
  };
  for (int i = 0; i <= across; ++i) {
    add_ring(static_cast<double>(i) / across, 0.0);
  }
  for (int i = 1; i <= up; ++i) {
    add_ring(1.0, kWidth_mm * i / up);
  }
  for (int i = across - 1; i >= 0; --i) {
    add_ring(static_cast<double>(i) / across, kWidth_mm);
  }
  for (int i = up - 1; i >= 1; --i) {
    add_ring(0.0, kWidth_mm * i / up);
  }
  const auto size = static_cast<std::int32_t>(outline.size());
  const auto rings = static_cast<std::int32_t>(mesh.vertices_mm.size()) / size;
  for (std::int32_t ring = 0; ring < rings; ++ring) {
    const std::int32_t here = ring * size;
    const std::int32_t next = (ring + 1) % rings * size;
    for (std::int32_t j = 0; j < size; ++j) {
      const std::int32_t k = (j + 1) % size;
      mesh.triangles.push_back({here + j, here + k, next + k});
      mesh.triangles.push_back({here + j, next + k, next + j});
    }
  }
  turn_outwards(mesh);
  return mesh;
}

/// A closed ring of round section.
inline TriangleMesh torus(double radius_mm, double section_mm, int around, int section) {
  TriangleMesh mesh;
  for (int i = 0; i < around; ++i) {
    for (int j = 0; j < section; ++j) {
      const double a = 2.0 * kPi * i / around;
      const double b = 2.0 * kPi * j / section;
      const double r = radius_mm + section_mm * std::cos(b);
      add_vertex(mesh, {r * std::cos(a), r * std::sin(a), section_mm * std::sin(b)});
      const std::int32_t here = i * section + j;
      const std::int32_t up = i * section + (j + 1) % section;
      const std::int32_t across = (i + 1) % around * section + j;
      const std::int32_t far = (i + 1) % around * section + (j + 1) % section;
      mesh.triangles.push_back({here, across, far});
      mesh.triangles.push_back({here, far, up});
    }
  }
  turn_outwards(mesh);
  return mesh;
}

}  // namespace glint::imprint_support

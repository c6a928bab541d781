// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/surface/processing.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

#include "core/error.h"
#include "core/rng.h"
#include "defects/surface/half_edges.h"
#include "defects/surface/safe_moves.h"
#include "defects/surface/subdivision.h"
#include "defects/surface/surface_normals.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Where each use of random numbers begins, far above the numbers of defects.
enum class Use : std::uint64_t { kVertex = 1, kEdge = 2, kFaceNormal = 3 };

Rng rng_of(std::uint64_t seed, Use use, std::size_t number) {
  return {seed, Stream::kDefects, (static_cast<std::uint64_t>(use) << 56) + number};
}

/// A share of the triangles' heights below 1/3: see limit_to_heights().
constexpr double kHeightShare = 0.3;

std::vector<Vector3d> vertex_normals(const TriangleMesh& mesh) {
  std::vector<Vector3d> normals(mesh.vertices_mm.size(), Vector3d::Zero());
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    const Vector3d normal = face_normal(mesh, i);
    for (std::size_t k = 0; k < 3; ++k) {
      const auto corner = static_cast<std::int32_t>(3 * i + k);
      normals[at(mesh.triangles[i][k])] += corner_angle_rad(mesh, corner) * normal;
    }
  }
  for (Vector3d& normal : normals) {
    const double length = normal.norm();
    normal = length > 0.0 ? Vector3d(normal / length) : Vector3d::Zero();
  }
  return normals;
}

std::vector<char> is_on_sharp_edge(const TriangleMesh& mesh, double crease_rad) {
  std::vector<char> is_sharp(mesh.vertices_mm.size(), 0);
  const std::vector<std::int32_t> opposite = opposite_half_edges(mesh, VertexCorners(mesh));
  for (std::size_t i = 0; i < opposite.size(); ++i) {
    const std::int32_t other = opposite[i];
    if (other < 0 || angle_between_faces(mesh, i / 3, at(other / 3)) > crease_rad) {
      const auto half = static_cast<std::int32_t>(i);
      is_sharp[at(origin_of(mesh, half))] = 1;
      is_sharp[at(origin_of(mesh, next_corner(half)))] = 1;
    }
  }
  return is_sharp;
}

std::vector<Vector3d> noise_moves(const ProcessingSettings& settings,
                                  std::uint64_t seed,
                                  const TriangleMesh& mesh,
                                  double crease_rad) {
  std::vector<Vector3d> moves = vertex_normals(mesh);
  const std::vector<char> is_sharp = settings.edge_roughness_mm > 0.0
                                         ? is_on_sharp_edge(mesh, crease_rad)
                                         : std::vector<char>(moves.size(), 0);
  for (std::size_t i = 0; i < moves.size(); ++i) {
    double length_mm = 0.0;
    if (settings.vertex_noise_mm > 0.0) {
      length_mm += settings.vertex_noise_mm * rng_of(seed, Use::kVertex, i).normal();
    }
    if (is_sharp[i] != 0) {
      length_mm += settings.edge_roughness_mm * rng_of(seed, Use::kEdge, i).normal();
    }
    moves[i] *= length_mm;
  }
  return moves;
}

/// Frees the faces at moved vertices from their patches. @return which vertices these faces have
std::vector<char> free_moved_faces(TriangleMesh& mesh, const std::vector<Vector3d>& before_mm) {
  std::vector<char> is_near(before_mm.size(), 0);
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    const Triangle& triangle = mesh.triangles[i];
    if (std::ranges::any_of(triangle, [&](std::int32_t vertex) {
          return mesh.vertices_mm[at(vertex)] != before_mm[at(vertex)];
        })) {
      for (const std::int32_t vertex : triangle) {
        is_near[at(vertex)] = 1;
      }
      if (!mesh.patch.empty()) {
        mesh.patch[i] = -1;
      }
    }
  }
  return is_near;
}

/// The faces at vertices that are elsewhere than before, and what follows from that: these faces
/// are free, and normals at their vertices are new; all others keep theirs.
void renew_surface(TriangleMesh& mesh,
                   const std::vector<Vector3d>& before_mm,
                   std::span<const ExactPatch> patches,
                   double crease_rad) {
  const std::vector<char> is_near = free_moved_faces(mesh, before_mm);
  const std::vector<Vector3d> old_normals = std::move(mesh.normals);
  const std::vector<Triangle> old_corners = std::move(mesh.corner_normals);
  set_normals(mesh, patches, crease_rad);
  std::vector<std::int32_t> kept(old_normals.size(), -1);
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (is_near[at(mesh.triangles[i][k])] != 0) {
        continue;
      }
      std::int32_t& index = kept[at(old_corners[i][k])];
      if (index < 0) {
        index = static_cast<std::int32_t>(mesh.normals.size());
        mesh.normals.push_back(old_normals[at(old_corners[i][k])]);
      }
      mesh.corner_normals[i][k] = index;
    }
  }
}

void subdivide(const ProcessingSettings& settings,
               std::span<const ExactPatch> patches,
               double crease_rad,
               Processed& part) {
  Subdivided finer = subdivide_midpoint(part.mesh, part.labels, patches);
  if (settings.subdivision == ProcessingSettings::Subdivision::kLoop) {
    std::vector<Vector3d> moves = loop_places(part.mesh, part.labels, finer, crease_rad);
    const std::vector<Vector3d> before_mm = finer.mesh.vertices_mm;
    for (std::size_t i = 0; i < moves.size(); ++i) {
      moves[i] -= before_mm[i];
    }
    part.limited_vertices += move_safely(finer.mesh, std::move(moves));
    renew_surface(finer.mesh, before_mm, patches, crease_rad);
  }
  for (std::int32_t& face : finer.origin) {
    face = part.origin[at(face)];
  }
  part.mesh = std::move(finer.mesh);
  part.labels = std::move(finer.labels);
  part.origin = std::move(finer.origin);
}

/// Two unit vectors square to a unit vector and to each other.
std::pair<Vector3d, Vector3d> tangents(const Vector3d& normal) {
  const Vector3d u = normal.unitOrthogonal();
  return {u, normal.cross(u)};
}

void tilt_faces(TriangleMesh& mesh, double rms_rad, std::uint64_t seed) {
  std::vector<Vector3d> normals;
  normals.reserve(3 * mesh.num_triangles());
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    Rng rng = rng_of(seed, Use::kFaceNormal, i);
    const double x = rms_rad / std::sqrt(2.0) * rng.normal();
    const double y = rms_rad / std::sqrt(2.0) * rng.normal();
    const auto [u, v] = tangents(mesh.normal(i, 0));
    const double tilt_rad = std::hypot(x, y);
    const Vector3d axis = tilt_rad > 0.0 ? Vector3d((x * u + y * v) / tilt_rad) : u;
    const Eigen::Matrix3d turn = Eigen::AngleAxisd(tilt_rad, axis).toRotationMatrix();
    for (std::size_t k = 0; k < 3; ++k) {
      normals.push_back((turn * mesh.normal(i, k)).normalized());
    }
  }
  mesh.normals = std::move(normals);
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    const auto first = static_cast<std::int32_t>(3 * i);
    mesh.corner_normals[i] = {first, first + 1, first + 2};
  }
  std::ranges::fill(mesh.patch, -1);
}

}  // namespace

bool is_any(const ProcessingSettings& settings) {
  return settings.levels > 0 || settings.face_normal_noise_rad > 0.0 ||
         settings.vertex_noise_mm > 0.0 || settings.edge_roughness_mm > 0.0;
}

namespace {

/// Moves vertices and edges at random.
void add_noise(const ProcessingSettings& settings,
               std::uint64_t seed,
               std::span<const ExactPatch> patches,
               double crease_rad,
               Processed& part) {
  const std::vector<Vector3d> before_mm = part.mesh.vertices_mm;
  std::vector<Vector3d> moves = noise_moves(settings, seed, part.mesh, crease_rad);
  part.limited_vertices += limit_to_heights(part.mesh, kHeightShare, moves);
  part.limited_vertices += move_safely(part.mesh, std::move(moves));
  renew_surface(part.mesh, before_mm, patches, crease_rad);
}

}  // namespace

Processed apply_processing(const ProcessingSettings& settings,
                           std::uint64_t seed,
                           TriangleMesh mesh,
                           std::vector<std::int32_t> labels,
                           std::span<const ExactPatch> patches,
                           double crease_rad) {
  GLINT_CHECK(labels.size() == mesh.num_triangles(), "one label a face");
  Processed part = {.mesh = std::move(mesh), .labels = std::move(labels), .origin = {}};
  part.origin.resize(part.labels.size());
  std::iota(part.origin.begin(), part.origin.end(), 0);
  if (part.mesh.corner_normals.size() != part.mesh.num_triangles()) {
    set_normals(part.mesh, patches, crease_rad);
  }
  for (int level = 0; level < settings.levels; ++level) {
    subdivide(settings, patches, crease_rad, part);
  }
  if (settings.vertex_noise_mm > 0.0 || settings.edge_roughness_mm > 0.0) {
    add_noise(settings, seed, patches, crease_rad, part);
  }
  if (settings.face_normal_noise_rad > 0.0) {
    tilt_faces(part.mesh, settings.face_normal_noise_rad, seed);
  }
  return part;
}

}  // namespace glint

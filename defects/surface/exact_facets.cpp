// SPDX-License-Identifier: GPL-3.0-or-later
//
// The faces about a tool are cut out of the part, bisected (edge_bisection.h) and put back. A
// bisection may run on to neighbours; where it would leave the cutout, a larger one is taken. How
// far a facet is off its surface is told by the middles of its edges, which also holds for the
// pieces of facets that an earlier tool has cut, whose corners are off the surface themselves.
#include "defects/surface/exact_facets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <vector>

#include "defects/boolean/tool_reach.h"
#include "defects/surface/edge_bisection.h"
#include "defects/surface/half_edges.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// A bound on the distance of a facet from its exact surface, beyond that of its corners: a linear
/// facet misses a quadratic by 4 sum l_i l_j m_ij in barycentric coordinates l, with m_ij at the
/// middles of the edges, which is at most 4/3 of the largest of them.
double bend_mm(const ExactPatch& patch, const TriangleMesh& mesh, std::size_t face) {
  std::array<double, 3> at_corner = {};
  for (std::size_t k = 0; k < 3; ++k) {
    at_corner[k] = implicit_value(patch, mesh.vertex(face, k), nullptr);
  }
  double largest_mm = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    const Vector3d middle = 0.5 * (mesh.vertex(face, k) + mesh.vertex(face, next));
    const double straight_mm = 0.5 * (at_corner[k] + at_corner[next]);
    largest_mm =
        std::max(largest_mm, std::abs(implicit_value(patch, middle, nullptr) - straight_mm));
  }
  return 4.0 / 3.0 * largest_mm;
}

bool reaches(const ToolReach& tool, const TriangleMesh& mesh, std::size_t face) {
  return tool.reaches({mesh.vertex(face, 0), mesh.vertex(face, 1), mesh.vertex(face, 2)});
}

std::ptrdiff_t num_border_edges(const TriangleMesh& mesh) {
  return std::ranges::count(opposite_half_edges(mesh, VertexCorners(mesh)), -1);
}

BoundingBox grown(const BoundingBox& box, double share) {
  const Vector3d margin = Vector3d::Constant(share * box.size_mm().norm());
  return {.min_mm = box.min_mm - margin, .max_mm = box.max_mm + margin};
}

/// Bisected halves have half the area and, after two steps, a quarter of the error; a face that is
/// `excess` times too coarse becomes this many times as many.
constexpr double kOvershoot = 2.0;

enum class Refined { kDone, kLeftCutout, kTooMany };

/// One attempt with the faces about the tool.
Refined refine(MeshCutout& cutout,
               const ToolReach& tool,
               std::span<const ExactPatch> patches,
               double tolerance_mm) {
  TriangleMesh& mesh = cutout.mesh;
  const auto excess = [&](std::int32_t face) {  // over 1: too coarse
    const std::int32_t patch = mesh.patch_of(at(face));
    return patch < 0 ? 0.0 : bend_mm(patches[at(patch)], mesh, at(face)) / tolerance_mm;
  };
  const auto is_fine = [&](std::int32_t face) {
    return excess(face) <= 1.0 || !reaches(tool, mesh, at(face));
  };
  std::vector<std::int32_t> faces(mesh.num_triangles());
  std::iota(faces.begin(), faces.end(), 0);
  std::erase_if(faces, is_fine);
  if (faces.empty()) {
    return Refined::kDone;
  }
  if (std::transform_reduce(faces.begin(), faces.end(), 0.0, std::plus<>(), excess) >
      kMaxFacetsUnderTool / kOvershoot) {
    return Refined::kTooMany;
  }
  const std::ptrdiff_t border = num_border_edges(mesh);
  EdgeBisection bisection(mesh, cutout.labels, cutout.origin, patches);
  bisection.refine(std::move(faces), [&](std::int32_t face) {
    return is_fine(face) ? std::numeric_limits<double>::infinity() : 0.0;
  });
  return num_border_edges(mesh) == border ? Refined::kDone : Refined::kLeftCutout;
}

}  // namespace

bool refine_under_tool(ImprintedMesh& part,
                       const TriangleMesh& tool,
                       std::span<const ExactPatch> patches,
                       double tolerance_mm) {
  if (patches.empty()) {
    return true;
  }
  const ToolReach reach(tool);
  const BoundingBox box = bounding_box(tool);
  constexpr double kAll = 1e9;
  double share = 0.25;
  while (share < kAll) {
    MeshCutout cutout = part.cutout(grown(box, share));
    const bool is_whole = cutout.faces.size() == part.num_triangles();
    const std::size_t before = cutout.faces.size();
    const Refined refined = refine(cutout, reach, patches, tolerance_mm);
    if (refined == Refined::kTooMany) {
      return false;
    }
    if (refined == Refined::kDone || is_whole) {
      if (cutout.mesh.num_triangles() > before) {
        part.replace(cutout);
      }
      return true;
    }
    share *= 2.0;
  }
  return true;
}

}  // namespace glint

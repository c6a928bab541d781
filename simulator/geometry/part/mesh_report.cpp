// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/part/mesh_report.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"
#include "core/index.h"
#include "core/units.h"
#include "simulator/geometry/mesh/mesh_edges.h"

namespace glint {
namespace {

/// Neighbours that meet at less count as one plane: below what float coordinates resolve.
constexpr double kFlat_rad = 1e-5;

bool stands_for_itself(const TriangleMesh& mesh, std::int32_t triangle) {
  return mesh.patch_of(index(triangle)) < 0;
}

void count_edges(const std::vector<MeshEdge>& edges, MeshReport& report) {
  for (const MeshEdge& edge : edges) {
    report.open_edges += edge.num_faces == 1 ? 1U : 0U;
    report.nonmanifold_edges += edge.num_faces > 2 ? 1U : 0U;
    report.flipped_edges += edge.num_faces == 2 && !edge.is_consistent ? 1U : 0U;
  }
  report.is_watertight =
      report.open_edges == 0 && report.nonmanifold_edges == 0 && report.flipped_edges == 0;
}

/// Facet angles of the bent edges that are shaded as smooth and are not exact.
void measure_facets(const TriangleMesh& mesh,
                    const std::vector<MeshEdge>& edges,
                    double crease_rad,
                    MeshReport& report) {
  std::vector<double> angles_rad;
  for (const MeshEdge& edge : edges) {
    if (!edge.is_consistent ||
        (!stands_for_itself(mesh, edge.triangle_a) && !stands_for_itself(mesh, edge.triangle_b))) {
      continue;
    }
    const double angle = angle_between_faces(mesh, index(edge.triangle_a), index(edge.triangle_b));
    if (angle > kFlat_rad && angle <= crease_rad) {
      angles_rad.push_back(angle);
    }
  }
  if (angles_rad.empty()) {
    return;
  }
  report.largest_facet_angle_rad = *std::ranges::max_element(angles_rad);
  const auto rank = static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(angles_rad.size() - 1));
  std::ranges::nth_element(angles_rad, angles_rad.begin() + rank);
  report.facet_angle_95_rad = angles_rad[static_cast<std::size_t>(rank)];
}

/// Three digits, never with an exponent.
std::string plain_number(double value) {
  return std::abs(value) < 1000.0 ? fmt::format("{:.3g}", value) : fmt::format("{:.0f}", value);
}

/// Advice that can be followed: edges can be made some times shorter, not some hundred times, and
/// no surface is steeper than a right angle.
std::string what_helps(double facet_rad, double allowed_rad) {
  constexpr double kMaxTimesShorter = 10.0;
  constexpr double kSteepest_rad = 0.5;
  const double times = facet_rad / allowed_rad;
  const double slope_rad = facet_rad / kFacetShare;
  const std::string finer =
      times <= kMaxTimesShorter
          ? fmt::format(
                "export the part with edges {:.2g} times shorter (a facet angle below {:.2g} "
                "deg), use a parametric part",
                times,
                allowed_rad * kDegPerRad)
          : "use a parametric part, or a mesh made from exact CAD surfaces with a facet angle "
            "below " +
                fmt::format("{:.2g} deg", allowed_rad * kDegPerRad);
  return slope_rad <= kSteepest_rad
             ? fmt::format("{}, or trust only defects that are steeper than {} mrad ({:.2g} deg)",
                           finer,
                           plain_number(1e3 * slope_rad),
                           slope_rad * kDegPerRad)
             : finer + "; with this mesh no defect can be told from its facets by its slope";
}

void check_facets(MeshReport& report) {
  const double allowed_rad = kFacetShare * report.smallest_slope_rad;
  report.is_fine_enough = report.has_exact_surface || report.facet_angle_95_rad <= allowed_rad;
  if (report.has_exact_surface) {
    report.verdict = "normals are exact: facets cannot show up under fringes";
    return;
  }
  const std::string measured = fmt::format(
      "95 % of the bent edges turn by less than {} mrad (largest {}), {} mrad are "
      "allowed (0.1 of the smallest slope of {} mrad)",
      plain_number(1e3 * report.facet_angle_95_rad),
      plain_number(1e3 * report.largest_facet_angle_rad),
      plain_number(1e3 * allowed_rad),
      plain_number(1e3 * report.smallest_slope_rad));
  if (report.is_fine_enough) {
    report.verdict = "the mesh is fine enough: " + measured;
    return;
  }
  report.verdict = "facets show up as defects under fringes: " + measured;
  report.action = what_helps(report.facet_angle_95_rad, allowed_rad);
}

void add_warnings(MeshReport& report) {
  const auto add = [&](std::size_t count, std::string_view what) {
    if (count > 0) {
      report.warnings.push_back(fmt::format("{} {}", count, what));
    }
  };
  add(report.open_edges, "open edges: the mesh has holes (reflections may enter it there)");
  add(report.nonmanifold_edges, "edges with more than two faces");
  add(report.flipped_edges, "edges whose two faces are turned against each other");
  add(report.degenerate_triangles, "triangles without area");
  if (report.is_inside_out) {
    report.warnings.emplace_back("the faces point inwards: turn the mesh inside out");
  }
}

}  // namespace

namespace {

std::size_t count_degenerate(const TriangleMesh& mesh) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    count += area_vector(mesh, i).isZero(0.0) ? 1U : 0U;
  }
  return count;
}

}  // namespace

MeshReport report(const Part& part, double smallest_slope_rad, double crease_rad) {
  GLINT_CHECK(smallest_slope_rad > 0.0, "a slope of interest is positive");
  const TriangleMesh& mesh = part.mesh;
  MeshReport report = {.name = part.name,
                       .unit = std::string(unit_name(part.unit)),
                       .size_mm = part.box_in_part_mm.size_mm(),
                       .area_mm2 = surface_area_mm2(mesh),
                       .num_triangles = mesh.num_triangles(),
                       .num_vertices = mesh.vertices_mm.size(),
                       .smallest_slope_rad = smallest_slope_rad,
                       .scene_from_part = part.scene_from_part};
  const std::vector<MeshEdge> edges = mesh_edges(mesh);
  count_edges(edges, report);
  if (report.is_watertight) {
    const double volume_mm3 = enclosed_volume_mm3(mesh);
    report.volume_mm3 = std::abs(volume_mm3);
    report.is_inside_out = volume_mm3 < 0.0;
  }
  report.degenerate_triangles = count_degenerate(mesh);
  report.has_exact_surface =
      !mesh.patch.empty() && std::ranges::all_of(mesh.patch, [](auto p) { return p >= 0; });
  measure_facets(mesh, edges, crease_rad, report);
  check_facets(report);
  add_warnings(report);
  return report;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/part/parametric_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include <Eigen/Core>

#include "core/index.h"
#include "core/units.h"
#include "simulator/geometry/part/exact_surface.h"
#include "simulator/geometry/part/parametric_builder.h"

namespace glint::parametric {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// The longest cell edge with which a surface of that radius stays within half the tolerance.
double edge_for_radius(double radius_mm, double chord_mm) {
  return std::sqrt(4.0 * std::abs(radius_mm) * chord_mm);
}

/// Puts the apex on a vertex, so that the bounding box is exact.
int even(int count) {
  return count + count % 2;
}

/// A grid of (num_x + 1) x (num_y + 1) vertices, x fastest.
struct Grid {
  int num_x = 1;
  int num_y = 1;
  std::vector<std::int32_t> vertices;

  std::int32_t at(int i, int j) const { return vertices[index(j * (num_x + 1) + i)]; }
};

Grid top_grid(Builder& builder,
              const Vector2d& size_mm,
              const ParaboloidPatch& top,
              double chord_mm) {
  const double step_x = edge_for_radius(top.radius_along_mm, chord_mm);
  const double step_y = edge_for_radius(top.radius_across_mm, chord_mm);
  Grid grid;
  grid.num_x = even(
      std::max(pieces(size_mm.x(), step_x), slices(size_mm.x(), std::min(step_y, size_mm.y()))));
  grid.num_y = even(
      std::max(pieces(size_mm.y(), step_y), slices(size_mm.y(), std::min(step_x, size_mm.x()))));
  for (int j = 0; j <= grid.num_y; ++j) {
    for (int i = 0; i <= grid.num_x; ++i) {
      const double x = size_mm.x() * (static_cast<double>(i) / grid.num_x - 0.5);
      const double y = size_mm.y() * (static_cast<double>(j) / grid.num_y - 0.5);
      const double z = -0.5 * (x * x / top.radius_along_mm + y * y / top.radius_across_mm);
      grid.vertices.push_back(builder.add_vertex({x, y, z}));
    }
  }
  return grid;
}

/// The grid's border counter-clockwise seen from +z, one list of vertices per side (-y, +x, +y,
/// -x), each with both its ends.
std::array<std::vector<std::int32_t>, 4> border_of(const Grid& grid) {
  std::array<std::vector<std::int32_t>, 4> sides;
  for (int i = 0; i <= grid.num_x; ++i) {
    sides[0].push_back(grid.at(i, 0));
    sides[2].push_back(grid.at(grid.num_x - i, grid.num_y));
  }
  for (int j = 0; j <= grid.num_y; ++j) {
    sides[1].push_back(grid.at(grid.num_x, j));
    sides[3].push_back(grid.at(0, grid.num_y - j));
  }
  return sides;
}

/// Sides and bottom under a grid's border, down to z = bottom_mm.
void close_below(Builder& builder, const Grid& grid, const Vector2d& size_mm, double bottom_mm) {
  constexpr std::array<std::array<double, 2>, 4> kOutwards = {{{0, -1}, {1, 0}, {0, 1}, {-1, 0}}};
  const auto sides = border_of(grid);
  Loop bottom;
  for (const auto& side : sides) {
    for (std::size_t i = 0; i + 1 < side.size(); ++i) {
      const Vector3d p = builder.vertex(side[i]);
      bottom.vertices.push_back(builder.add_vertex({p.x(), p.y(), bottom_mm}));
    }
  }
  std::size_t below = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    const Vector3d normal(kOutwards[k][0], kOutwards[k][1], 0.0);
    const Vector3d on_side(0.5 * size_mm.x() * normal.x(), 0.5 * size_mm.y() * normal.y(), 0.0);
    const std::int32_t patch = builder.add_plane(on_side, normal);
    for (std::size_t i = 0; i + 1 < sides[k].size(); ++i, ++below) {
      const std::int32_t left = bottom.vertices[below];
      const std::int32_t right = bottom.vertices[(below + 1) % bottom.size()];
      builder.add_quad({left, right, sides[k][i + 1], sides[k][i]}, patch);
    }
  }
  const Vector3d centre(0.0, 0.0, bottom_mm);
  fan(builder,
      reversed(bottom),
      builder.add_vertex(centre),
      builder.add_plane(centre, -Vector3d::UnitZ()));
}

/// A slab under the paraboloid with its apex at the origin; a straight one is a plate.
void build_slab(const Vector2d& size_mm,
                const ParaboloidPatch& top,
                const PartSettings& settings,
                Part& part) {
  Builder builder;
  const bool is_flat = std::isinf(top.radius_along_mm) && std::isinf(top.radius_across_mm);
  const std::int32_t patch = is_flat ? builder.add_plane(Vector3d::Zero(), Vector3d::UnitZ())
                                     : builder.add_patch({.shape = top});
  const Grid grid = top_grid(builder, size_mm, top, settings.chord_tolerance_mm());
  for (int j = 0; j < grid.num_y; ++j) {
    for (int i = 0; i < grid.num_x; ++i) {
      builder.add_quad({grid.at(i, j), grid.at(i + 1, j), grid.at(i + 1, j + 1), grid.at(i, j + 1)},
                       patch);
    }
  }
  const double sag_mm = std::max(0.0, size_mm.x() * size_mm.x() / (8.0 * top.radius_along_mm)) +
                        std::max(0.0, size_mm.y() * size_mm.y() / (8.0 * top.radius_across_mm));
  close_below(builder, grid, size_mm, -sag_mm - settings.thickness_mm);
  builder.finish(part);
}

double straight_if_zero(double radius_mm) {
  return radius_mm == 0.0 ? std::numeric_limits<double>::infinity() : radius_mm;
}

/// Points on a full circle: a multiple of four, so that the bounding box is exact.
int full_circle(int count) {
  return 4 * std::max(2, (count + 3) / 4);
}

/// A circle of latitude with enough points, starting at angle 0.
Loop latitude(Builder& builder, double radius_mm, double polar_rad, double edge_mm) {
  const double ring_mm = radius_mm * std::sin(polar_rad);
  const int count = full_circle(pieces(2.0 * kPi * ring_mm, edge_mm));
  Loop loop;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * i / count;
    loop.angles_rad.push_back(angle);
    loop.vertices.push_back(builder.add_vertex(
        {ring_mm * std::cos(angle), ring_mm * std::sin(angle), radius_mm * std::cos(polar_rad)}));
  }
  return loop;
}

}  // namespace

void build_strip(const PartSettings& settings, Part& part) {
  build_slab({settings.length_mm, settings.width_mm},
             {.radius_along_mm = straight_if_zero(settings.radius_along_mm),
              .radius_across_mm = straight_if_zero(settings.radius_across_mm)},
             settings,
             part);
}

void build_plate(const PartSettings& settings, Part& part) {
  build_slab({settings.length_mm, settings.width_mm}, {}, settings, part);
}

void build_sphere_cap(const PartSettings& settings, Part& part) {
  Builder builder;
  const double radius_mm = settings.radius_mm;
  const bool is_whole = settings.height_mm >= 2.0 * radius_mm;
  const double end_rad = is_whole ? kPi : std::acos(1.0 - settings.height_mm / radius_mm);
  const std::int32_t sphere = builder.add_patch({.shape = SpherePatch{.radius_mm = radius_mm}});
  const double edge_mm =
      std::min(edge_for_radius(radius_mm, settings.chord_tolerance_mm()) * 0.85, radius_mm);
  const int num_rings = std::max(3, pieces(radius_mm * end_rad, edge_mm));
  const std::int32_t apex = builder.add_vertex({0.0, 0.0, radius_mm});
  Loop above = latitude(builder, radius_mm, end_rad / num_rings, edge_mm);
  fan(builder, above, apex, sphere);
  for (int i = 2; i <= num_rings - (is_whole ? 1 : 0); ++i) {
    Loop ring = latitude(builder, radius_mm, end_rad * i / num_rings, edge_mm);
    stitch(builder, ring, above, sphere);
    above = std::move(ring);
  }
  const double base_mm = is_whole ? -radius_mm : radius_mm * std::cos(end_rad);
  const Vector3d base_centre(0.0, 0.0, base_mm);
  const std::int32_t below = is_whole ? sphere : builder.add_plane(base_centre, -Vector3d::UnitZ());
  fan(builder, reversed(above), builder.add_vertex(base_centre), below);
  builder.finish(part);
}

void build_cylinder(const PartSettings& settings, Part& part) {
  Builder builder;
  const std::int32_t side =
      builder.add_patch({.shape = CylinderPatch{.radius_mm = settings.radius_mm}});
  const int count =
      full_circle(arc_segments(settings.radius_mm, 2.0 * kPi, settings.chord_tolerance_mm()));
  Profile circle;
  for (int i = 0; i < count; ++i) {
    const double angle = 2.0 * kPi * i / count;
    circle.points_mm.emplace_back(settings.radius_mm * std::cos(angle),
                                  settings.radius_mm * std::sin(angle));
  }
  circle.patches.assign(circle.points_mm.size(), side);
  const double step_mm = 2.0 * kPi * settings.radius_mm / count;
  const auto [back, front] =
      extrude(builder, circle, settings.length_mm, slices(settings.length_mm, step_mm), false);
  const Vector3d end(0.5 * settings.length_mm, 0.0, 0.0);
  fan(builder, front, builder.add_vertex(end), builder.add_plane(end, Vector3d::UnitX()));
  fan(builder,
      reversed(back),
      builder.add_vertex(-end),
      builder.add_plane(-end, -Vector3d::UnitX()));
  builder.finish(part);
}

}  // namespace glint::parametric

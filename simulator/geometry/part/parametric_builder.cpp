// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/part/parametric_builder.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/index.h"
#include "core/pose.h"
#include "core/units.h"

namespace glint::parametric {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

}  // namespace

std::int32_t Builder::add_vertex(const Vector3d& p_mm) {
  mesh_.vertices_mm.push_back(p_mm);
  return static_cast<std::int32_t>(mesh_.vertices_mm.size() - 1);
}

std::int32_t Builder::add_patch(const ExactPatch& patch) {
  patches_.push_back(patch);
  return static_cast<std::int32_t>(patches_.size() - 1);
}

std::int32_t Builder::add_plane(const Vector3d& point_mm, const Vector3d& normal) {
  Vector3d::Index across = 0;
  normal.cwiseAbs().minCoeff(&across);
  RigidTransform scene_from_patch = {.translation_mm = point_mm};
  const Vector3d x = Vector3d::Unit(across).cross(normal).normalized();
  scene_from_patch.rotation.col(0) = x;
  scene_from_patch.rotation.col(1) = normal.cross(x);
  scene_from_patch.rotation.col(2) = normal;
  return add_patch({.shape = PlanePatch{}, .scene_from_patch = scene_from_patch});
}

std::int32_t Builder::normal_at(std::int32_t vertex, std::int32_t patch) {
  const auto [place, is_new] =
      normal_of_.try_emplace({vertex, patch}, static_cast<std::int32_t>(mesh_.normals.size()));
  if (is_new) {
    Vector3d gradient;
    implicit_value(patches_[index(patch)], mesh_.vertices_mm[index(vertex)], &gradient);
    mesh_.normals.emplace_back(gradient.normalized());
  }
  return place->second;
}

void Builder::add_triangle(std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t patch) {
  mesh_.triangles.push_back({a, b, c});
  mesh_.corner_normals.push_back({normal_at(a, patch), normal_at(b, patch), normal_at(c, patch)});
  mesh_.patch.push_back(patch);
}

void Builder::add_quad(const std::array<std::int32_t, 4>& corners, std::int32_t patch) {
  add_triangle(corners[0], corners[1], corners[2], patch);
  add_triangle(corners[0], corners[2], corners[3], patch);
}

void Builder::finish(Part& part) {
  part.mesh = std::move(mesh_);
  part.patches = std::move(patches_);
}

void stitch(Builder& builder, const Loop& lower, const Loop& upper, std::int32_t patch) {
  const auto angle = [](const Loop& loop, std::size_t i) {
    return loop.angles_rad[i % loop.size()] + (i >= loop.size() ? 2.0 * kPi : 0.0);
  };
  const auto vertex = [](const Loop& loop, std::size_t i) {
    return loop.vertices[i % loop.size()];
  };
  for (std::size_t i = 0, j = 0; i < lower.size() || j < upper.size();) {
    const bool takes_lower =
        j == upper.size() || (i < lower.size() && angle(lower, i + 1) <= angle(upper, j + 1));
    if (takes_lower) {
      builder.add_triangle(vertex(lower, i), vertex(lower, i + 1), vertex(upper, j), patch);
      ++i;
    } else {
      builder.add_triangle(vertex(lower, i), vertex(upper, j + 1), vertex(upper, j), patch);
      ++j;
    }
  }
}

void fan(Builder& builder, const Loop& loop, std::int32_t centre, std::int32_t patch) {
  for (std::size_t i = 0; i < loop.size(); ++i) {
    builder.add_triangle(loop.vertices[i], loop.vertices[(i + 1) % loop.size()], centre, patch);
  }
}

Loop reversed(const Loop& loop) {
  Loop backwards = loop;
  std::ranges::reverse(backwards.vertices);
  std::ranges::reverse(backwards.angles_rad);
  for (double& angle : backwards.angles_rad) {
    angle = -angle;
  }
  return backwards;
}

int arc_segments(double radius_mm, double angle_rad, double chord_mm) {
  const double step_rad = 2.0 * std::acos(1.0 - std::min(0.5, chord_mm / radius_mm));
  return pieces(angle_rad, step_rad);
}

int pieces(double length_mm, double step_mm) {
  return std::max(1, static_cast<int>(std::ceil(length_mm / step_mm)));
}

int slices(double length_mm, double step_mm) {
  return std::min(pieces(length_mm, 16.0 * step_mm), 1000);
}

namespace {

/// Quads from one slice to the next.
void add_band(
    Builder& builder, const Profile& profile, const Loop& from, const Loop& to, bool is_hole) {
  const std::size_t count = profile.points_mm.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = (i + 1) % count;
    std::array<std::int32_t, 4> quad = {
        from.vertices[i], from.vertices[next], to.vertices[next], to.vertices[i]};
    if (is_hole) {
      std::ranges::reverse(quad);
    }
    builder.add_quad(quad, profile.patches[i]);
  }
}

}  // namespace

std::pair<Loop, Loop> extrude(
    Builder& builder, const Profile& profile, double length_mm, int num_slices, bool is_hole) {
  std::pair<Loop, Loop> ends;
  Loop previous;
  for (int slice = 0; slice <= num_slices; ++slice) {
    const double x = length_mm * (static_cast<double>(slice) / num_slices - 0.5);
    Loop loop;
    for (const Vector2d& point : profile.points_mm) {
      loop.vertices.push_back(builder.add_vertex({x, point.x(), point.y()}));
    }
    if (slice > 0) {
      add_band(builder, profile, previous, loop, is_hole);
    } else {
      ends.first = loop;
    }
    previous = std::move(loop);
  }
  ends.second = std::move(previous);
  return ends;
}

}  // namespace glint::parametric

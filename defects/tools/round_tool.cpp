// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rings about the axis in even steps of the profile's length, ring k of 6 k points, then a wall and
// a roof above the surface. Noise moves points along rays from the middle of the opening, or along
// z in shallow caps: either way each ray still meets the tool once and it cannot cross itself. At
// the end everything is scaled so that the lowest point is exact. Our own construction; cost:
// linear in the triangles. docs/theory/imprint.md, "Tools".
#include "defects/tools/round_tool.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "core/units.h"
#include "defects/tools/tool_noise.h"

namespace glint {
namespace {

/// How far over the surface the shape below it goes on, as a share of depth or radius.
constexpr double kRoundMargin = 0.25;
constexpr int kProfilePoints = 1000;
constexpr double kMinFactor = 0.25;  ///< limits of the noise's factor on a point's distance
constexpr double kMaxFactor = 2.5;

/// A tool as a stack of rings about the z axis: ring k of 0..n has 6 k points, ring n + 1 is the
/// upper end of the wall with 6 n, the last point is the roof's tip.
struct Rings {
  int n = 3;

  int begin(int ring) const { return ring == 0 ? 0 : 1 + 3 * ring * (ring - 1); }

  int wall_begin() const { return begin(n + 1); }

  int tip() const { return wall_begin() + 6 * n; }
};

/// 6 n^2 + 18 n triangles, as near to 20 * 4^level as they come.
Rings rings_of(int level) {
  const double wanted = 20.0 * std::pow(4.0, level);
  const double n = (-18.0 + std::sqrt(324.0 + 24.0 * wanted)) / 12.0;
  return {.n = std::max(3, static_cast<int>(std::lround(n)))};
}

double margin_mm(const RoundTool& shape) {
  return std::min(kRoundMargin * std::min(shape.depth_mm, 0.5 * shape.diameter_mm),
                  0.2 * shape.reach_mm);
}

/// Points (distance from the axis, z) from the lowest point to the margin over the surface.
std::vector<Eigen::Vector2d> dense_profile(const RoundTool& shape) {
  const double a = 0.5 * shape.diameter_mm;
  const double h = shape.depth_mm;
  const double margin = margin_mm(shape);
  const bool is_cap = shape.exponent == 2.0 && h <= a;
  const double radius = is_cap ? (a * a + h * h) / (2.0 * h) : a;
  const double top = is_cap ? std::min(margin, radius - h) : 0.0;
  std::vector<Eigen::Vector2d> points;
  for (int i = 0; i <= kProfilePoints; ++i) {
    const double share = static_cast<double>(i) / kProfilePoints;
    if (is_cap) {
      // sin^2(angle / 2) instead of 1 - cos: no cancellation in caps of a huge ball.
      const double half = share * std::asin(std::sqrt((h + top) / (2.0 * radius)));
      points.emplace_back(radius * std::sin(2.0 * half),
                          -h + 2.0 * radius * std::pow(std::sin(half), 2));
    } else {
      const double angle = share * 0.5 * kPi;
      const double power = 2.0 / shape.exponent;
      points.emplace_back(a * std::pow(std::sin(angle), power),
                          -h * std::pow(std::max(0.0, std::cos(angle)), power));
    }
  }
  if (top < margin) {
    points.emplace_back(points.back().x(), margin);
  }
  return points;
}

/// The profile at n + 1 places in equal steps. Shallow shapes are stretched for measuring the
/// steps, so that steep walls get rings as well.
std::vector<Eigen::Vector2d> profile(const RoundTool& shape, int n) {
  const std::vector<Eigen::Vector2d> dense = dense_profile(shape);
  const double stretch = std::max(1.0, 0.25 * shape.diameter_mm / shape.depth_mm);
  std::vector<double> length(dense.size(), 0.0);
  for (std::size_t i = 1; i < dense.size(); ++i) {
    const Eigen::Vector2d step = dense[i] - dense[i - 1];
    length[i] = length[i - 1] + std::hypot(step.x(), stretch * step.y());
  }
  std::vector<Eigen::Vector2d> points;
  std::size_t at = 1;
  for (int i = 0; i <= n; ++i) {
    const double wanted = length.back() * i / n;
    while (at + 1 < dense.size() && length[at] < wanted) {
      ++at;
    }
    const double share = (wanted - length[at - 1]) / (length[at] - length[at - 1]);
    points.emplace_back(dense[at - 1] + std::clamp(share, 0.0, 1.0) * (dense[at] - dense[at - 1]));
  }
  return points;
}

void add_ring_triangles(const Rings& rings, std::vector<Triangle>& triangles) {
  for (int k = 1; k <= rings.n; ++k) {
    const int inner = rings.begin(k - 1);
    const int outer = rings.begin(k);
    const int inner_count = std::max(1, 6 * (k - 1));
    for (int sector = 0; sector < 6; ++sector) {
      for (int j = 0; j < k; ++j) {
        const int in = inner + (sector * (k - 1) + j) % inner_count;
        const int out = outer + sector * k + j;
        const int next_out = outer + (sector * k + j + 1) % (6 * k);
        triangles.push_back({in, next_out, out});
        if (j + 1 < k) {
          triangles.push_back({in, inner + (sector * (k - 1) + j + 1) % inner_count, next_out});
        }
      }
    }
  }
}

std::vector<Triangle> triangles_of(const Rings& rings) {
  std::vector<Triangle> triangles;
  add_ring_triangles(rings, triangles);
  const int rim = rings.begin(rings.n);
  const int wall = rings.wall_begin();
  const int count = 6 * rings.n;
  for (int j = 0; j < count; ++j) {
    const int next = (j + 1) % count;
    triangles.push_back({rim + j, rim + next, wall + next});
    triangles.push_back({rim + j, wall + next, wall + j});
    triangles.push_back({wall + j, wall + next, rings.tip()});
  }
  return triangles;
}

/// Seen from below, no triangle of the rings lies on its back.
bool is_graph(const std::vector<Eigen::Vector3d>& points, const std::vector<Triangle>& rings) {
  const auto flat = [&](std::int32_t i) -> Eigen::Vector2d {
    return points[static_cast<std::size_t>(i)].head<2>();
  };
  return std::all_of(rings.begin(), rings.end(), [&](const Triangle& t) {
    const Eigen::Vector2d u = flat(t[1]) - flat(t[0]);
    const Eigen::Vector2d v = flat(t[2]) - flat(t[0]);
    return u.x() * v.y() - u.y() * v.x() < -1e-3 * u.norm() * v.norm();
  });
}

/// Octaves the rings can show: a feature of the finest spans at least three of them.
int octaves_of(const RoundTool& shape, const Rings& rings) {
  int octaves = 1;
  while (octaves < 6 && shape.noise_per_radius * std::pow(2.0, octaves) <= rings.n / 3.0) {
    ++octaves;
  }
  return octaves;
}

/// Shares by which points move away from the middle of the opening, mean 0, rms the roughness. The
/// noise lives in a space in which radius and depth are 1.
std::vector<double> moves(const RoundTool& shape,
                          const ToolNoise& noise,
                          const std::vector<Eigen::Vector3d>& points) {
  const Eigen::Vector3d per_mm(
      2.0 / shape.diameter_mm, 2.0 / shape.diameter_mm, 1.0 / shape.depth_mm);
  std::vector<double> values;
  values.reserve(points.size());
  for (const Eigen::Vector3d& p : points) {
    values.push_back(noise(shape.noise_per_radius * p.cwiseProduct(per_mm)));
  }
  standardise(values);
  for (double& value : values) {
    value = std::clamp(shape.roughness * value, kMinFactor - 1.0, kMaxFactor - 1.0);
  }
  return values;
}

/// Shallow caps: heights and distances from the axis move apart from each other, the distances with
/// the coarsest features only and no more than leaves a graph.
void add_graph_noise(const RoundTool& shape,
                     const Rings& rings,
                     const std::vector<double>& heights,
                     std::vector<Eigen::Vector3d>& points) {
  const std::vector<double> distances = moves(shape, ToolNoise(shape.seed, 3, 1, 1.0), points);
  std::vector<Triangle> triangles;
  add_ring_triangles(rings, triangles);
  const std::vector<Eigen::Vector3d> plain = points;
  for (const double share : {1.0, 0.8, 0.6, 0.4, 0.2, 0.0}) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      points[i].head<2>() = (1.0 + share * distances[i]) * plain[i].head<2>();
      points[i].z() = (1.0 + heights[i]) * plain[i].z();
    }
    if (is_graph(points, triangles)) {
      return;
    }
  }
}

/// Moves the points along rays from the middle of the opening, which cannot make them cross.
void add_noise(const RoundTool& shape, const Rings& rings, std::vector<Eigen::Vector3d>& points) {
  if (shape.roughness <= 0.0) {
    return;
  }
  const ToolNoise noise(shape.seed, 0, octaves_of(shape, rings), shape.noise_gain);
  const std::vector<double> shares = moves(shape, noise, points);
  if (is_shallow_cap(shape)) {
    add_graph_noise(shape, rings, shares, points);
    return;
  }
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] *= 1.0 + shares[i];
  }
}

void fit_depth(double depth_mm, std::vector<Eigen::Vector3d>& points) {
  double lowest = 0.0;
  for (const Eigen::Vector3d& p : points) {
    lowest = std::min(lowest, p.z());
  }
  for (Eigen::Vector3d& p : points) {
    p.z() = p.z() == lowest ? -depth_mm : p.z() * (depth_mm / -lowest);
  }
}

/// The wall above the rim, and the tip of the roof.
void add_wall(const RoundTool& shape, const Rings& rings, std::vector<Eigen::Vector3d>& points) {
  const double a = 0.5 * shape.diameter_mm;
  const auto rim = static_cast<std::size_t>(rings.begin(rings.n));
  double top = std::min(std::max(0.5 * a, std::min(shape.depth_mm, a)), 0.5 * shape.reach_mm);
  for (std::size_t i = rim; i < static_cast<std::size_t>(rings.wall_begin()); ++i) {
    top = std::max(top, 1.5 * points[i].z());
  }
  for (std::size_t i = rim; i < static_cast<std::size_t>(rings.wall_begin()); ++i) {
    points.emplace_back(points[i].x(), points[i].y(), top);
  }
  points.emplace_back(0.0, 0.0, 1.15 * top);
}

}  // namespace

bool is_shallow_cap(const RoundTool& shape) {
  return shape.exponent == 2.0 && shape.depth_mm < 0.25 * shape.diameter_mm;
}

TriangleMesh round_tool(const RoundTool& shape) {
  const Rings rings = rings_of(shape.level);
  const std::vector<Eigen::Vector2d> outline = profile(shape, rings.n);
  std::vector<Eigen::Vector3d> points;
  points.emplace_back(0.0, 0.0, -shape.depth_mm);
  for (int k = 1; k <= rings.n; ++k) {
    const Eigen::Vector2d& at = outline[static_cast<std::size_t>(k)];
    for (int j = 0; j < 6 * k; ++j) {
      const double turn = 2.0 * kPi * j / (6 * k);
      points.emplace_back(at.x() * std::cos(turn), at.x() * std::sin(turn), at.y());
    }
  }
  add_noise(shape, rings, points);
  fit_depth(shape.depth_mm, points);
  add_wall(shape, rings, points);
  return {.vertices_mm = std::move(points), .triangles = triangles_of(rings)};
}

TriangleMesh upside_down(TriangleMesh mesh) {
  for (Eigen::Vector3d& p : mesh.vertices_mm) {
    p.z() = -p.z();
  }
  for (Triangle& triangle : mesh.triangles) {
    std::swap(triangle[1], triangle[2]);
  }
  return mesh;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tools for the tests and benchmarks of imprints, and places for them.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include "core/rng.h"
#include "core/units.h"
#include "simulator/geometry/mesh/triangle_mesh.h"
#include "tests/defects/boolean/imprint_parts.h"

namespace glint::imprint_support {

/// A smooth random function of space: waves of falling amplitude, about +-1.
class Waves {
 public:
  explicit Waves(Rng& rng) {
    for (int octave = 0; octave < 4; ++octave) {
      for (int i = 0; i < 6; ++i) {
        const double scale = 2.0 * std::pow(2.0, octave);
        waves_.push_back(
            {{rng.uniform(-scale, scale), rng.uniform(-scale, scale), rng.uniform(-scale, scale)},
             rng.uniform(0.0, 2.0 * kPi),
             0.3 * std::pow(0.5, octave)});
      }
    }
  }

  double operator()(const Vector3d& point) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) {
      sum += wave.amplitude * std::sin(wave.vector.dot(point) + wave.phase);
    }
    return sum;
  }

 private:
  struct Wave {
    Vector3d vector;
    double phase = 0.0;
    double amplitude = 0.0;
  };

  std::vector<Wave> waves_;
};

/// A rough ball of about unit radius, 20 * 4^level triangles.
inline TriangleMesh rough_ball(int level, double roughness, Rng& rng) {
  TriangleMesh mesh = unit_sphere(level);
  const Waves waves(rng);
  for (Vector3d& point : mesh.vertices_mm) {
    point *= 1.0 + roughness * waves(point);
  }
  return mesh;
}

/// A blade along x with a section like a diamond, pointed at both ends, rough.
/// 2 * sides * (stations - 1) triangles: 1,504 for 48 stations and 16 sides.
inline TriangleMesh rough_blade(double length,
                                double width,
                                double height,
                                double roughness,
                                Rng& rng,
                                int stations = 48,
                                int sides = 16) {
  TriangleMesh mesh;
  const Waves waves(rng);
  const std::int32_t first = add_vertex(mesh, {-0.5 * length, 0.0, 0.0});
  for (int i = 1; i < stations; ++i) {
    const double along = static_cast<double>(i) / stations;
    const double taper = std::pow(std::sin(kPi * along), 0.6);
    for (int j = 0; j < sides; ++j) {
      const double angle = 2.0 * kPi * j / sides;
      const double c = std::cos(angle);
      const double s = std::sin(angle);
      const double rough = 1.0 + roughness * waves({length * along / width, c, s});
      const double radius = taper * rough / (std::abs(c) + std::abs(s));
      add_vertex(mesh, {length * (along - 0.5), 0.5 * width * radius * c, height * radius * s});
    }
  }
  const std::int32_t last = add_vertex(mesh, {0.5 * length, 0.0, 0.0});
  for (int j = 0; j < sides; ++j) {
    const std::int32_t a = first + 1 + j;
    const std::int32_t b = first + 1 + (j + 1) % sides;
    mesh.triangles.push_back({first, b, a});
    for (int i = 0; i + 2 < stations; ++i) {
      const std::int32_t row = i * sides;
      mesh.triangles.push_back({a + row, b + row, a + row + sides});
      mesh.triangles.push_back({b + row, b + row + sides, a + row + sides});
    }
    mesh.triangles.push_back({a + (stations - 2) * sides, b + (stations - 2) * sides, last});
  }
  turn_outwards(mesh);
  return mesh;
}

inline TriangleMesh moved(TriangleMesh mesh, const RigidTransform& pose) {
  transform(mesh, pose);
  return mesh;
}

inline TriangleMesh scaled(TriangleMesh mesh, double factor) {
  for (Vector3d& point : mesh.vertices_mm) {
    point *= factor;
  }
  return mesh;
}

/// Area-weighted places on a surface.
class Places {
 public:
  explicit Places(const TriangleMesh& mesh) : mesh_(mesh) {
    double sum = 0.0;
    for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
      sum += area_vector(mesh, i).norm();
      sums_.push_back(sum);
    }
  }

  /// Origin on the surface, z along the normal, turned at random and tilted by at most 0.15 rad.
  RigidTransform draw(Rng& rng) const {
    const double wanted = rng.uniform(0.0, sums_.back());
    const auto found = std::lower_bound(sums_.begin(), sums_.end(), wanted);
    const auto face = static_cast<std::size_t>(
        std::min<std::ptrdiff_t>(found - sums_.begin(), std::ssize(sums_) - 1));
    double u = rng.uniform();
    double v = rng.uniform();
    if (u + v > 1.0) {
      u = 1.0 - u;
      v = 1.0 - v;
    }
    const Vector3d normal = face_normal(mesh_, face);
    const double turn = rng.uniform(0.0, 2.0 * kPi);
    const double tilt_x = rng.uniform(-0.15, 0.15);
    const double tilt_y = rng.uniform(-0.15, 0.15);
    const Eigen::Matrix3d upright =
        Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), normal).toRotationMatrix();
    const Eigen::Matrix3d turned =
        (Eigen::AngleAxisd(turn, Vector3d::UnitZ()) * Eigen::AngleAxisd(tilt_x, Vector3d::UnitX()) *
         Eigen::AngleAxisd(tilt_y, Vector3d::UnitY()))
            .toRotationMatrix();
    const Vector3d& a = mesh_.vertex(face, 0);
    return {
        .rotation = upright * turned,
        .translation_mm = a + u * (mesh_.vertex(face, 1) - a) + v * (mesh_.vertex(face, 2) - a)};
  }

 private:
  const TriangleMesh& mesh_;
  std::vector<double> sums_;
};

/// Tool number `index` of a seed: three of five are dents of 1,280 triangles and 0.8 to 2.5 % of
/// the size in radius, the others scratches of 1,504 triangles, 4 to 10 % long and 0.3 to 0.7 %
/// wide.
inline TriangleMesh mixed_tool(const Places& places,
                               double size_mm,
                               std::uint64_t seed,
                               int index) {
  Rng rng(seed, Stream::kTest, static_cast<std::uint64_t>(index));
  const RigidTransform place = places.draw(rng);
  TriangleMesh tool;
  Vector3d lift;
  if (index % 5 < 3) {
    const double radius = size_mm * rng.uniform(0.008, 0.025);
    tool = scaled(rough_ball(3, 0.15, rng), radius);
    lift = {0.0, 0.0, radius * (1.0 - rng.uniform(0.1, 0.5))};
  } else {
    const double length = size_mm * rng.uniform(0.04, 0.1);
    const double width = size_mm * rng.uniform(0.003, 0.007);
    tool = rough_blade(length, width, width, 0.15, rng);
    lift = {0.0, 0.0, width * rng.uniform(0.2, 0.6)};
  }
  for (Vector3d& point : tool.vertices_mm) {
    point += lift;
  }
  return moved(std::move(tool), place);
}

inline double diagonal_mm(const TriangleMesh& mesh) {
  return bounding_box(mesh).size_mm().norm();
}

inline Vector3d random_point(Rng& rng, double half) {
  const double x = rng.uniform(-half, half);
  const double y = rng.uniform(-half, half);
  return {x, y, rng.uniform(-half, half)};
}

inline TriangleMesh ball_at(const Vector3d& centre, double radius_mm, int level = 2) {
  return moved(scaled(unit_sphere(level), radius_mm), {.translation_mm = centre});
}

/// A turned ball has no edges along the axes.
inline TriangleMesh turned_ball_at(const Vector3d& centre, double radius_mm, int level = 2) {
  const Eigen::AngleAxisd turn(0.7, Vector3d(0.3, 0.5, 0.8).normalized());
  return moved(scaled(unit_sphere(level), radius_mm),
               {.rotation = turn.toRotationMatrix(), .translation_mm = centre});
}

}  // namespace glint::imprint_support

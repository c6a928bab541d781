// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/camera/viewpoint_set.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include "core/error.h"
#include "core/units.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr std::string_view kSourceNames[] = {"listed", "file", "sphere", "surface"};
constexpr std::string_view kLayoutNames[] = {"fibonacci", "rings"};

Vector3d vector3(const std::vector<double>& values) {
  return {values[0], values[1], values[2]};
}

std::vector<double> numbers(const Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

/// The wish without its part along a unit axis, unit; another axis where nothing is left.
Vector3d upright(const Vector3d& wish, const Vector3d& axis) {
  for (const Vector3d& candidate : {wish, Vector3d(Vector3d::UnitX())}) {
    const Vector3d across = candidate - candidate.dot(axis) * axis;
    if (across.norm() > 1e-6 * candidate.norm() && across.norm() > 0.0) {
      return across.normalized();
    }
  }
  return axis.unitOrthogonal();
}

/// From target_mm + distance_mm * outward towards the target.
Viewpoint looking_at(const Vector3d& target_mm,
                     const Vector3d& outward,
                     double distance_mm,
                     const Vector3d& up) {
  return normalised({.position_mm = numbers(target_mm + distance_mm * outward),
                     .direction = numbers(-outward),
                     .up = numbers(upright(up, outward))});
}

Vector3d on_sphere(double polar_rad, double azimuth_rad) {
  return {std::sin(polar_rad) * std::cos(azimuth_rad),
          std::sin(polar_rad) * std::sin(azimuth_rad),
          std::cos(polar_rad)};
}

std::vector<Vector3d> fibonacci(int count, double polar_min_rad, double polar_max_rad) {
  const double golden_rad = kPi * (3.0 - std::sqrt(5.0));
  const double top = std::cos(polar_min_rad);
  const double bottom = std::cos(polar_max_rad);
  std::vector<Vector3d> outward;
  for (int i = 0; i < count; ++i) {
    const double height = top + (bottom - top) * (i + 0.5) / count;
    outward.push_back(on_sphere(std::acos(std::clamp(height, -1.0, 1.0)), golden_rad * i));
  }
  return outward;
}

/// Polar angles of rings about as far apart as the poses on them.
std::vector<double> ring_angles(int count, double polar_min_rad, double polar_max_rad) {
  const double range = polar_max_rad - polar_min_rad;
  const double area = 2.0 * kPi * (std::cos(polar_min_rad) - std::cos(polar_max_rad));
  const double spacing = std::sqrt(area / count);
  const int wanted = spacing > 0.0 ? static_cast<int>(std::lround(range / spacing)) + 1 : 1;
  const int rings = std::clamp(wanted, 1, count);
  std::vector<double> angles;
  for (int ring = 0; ring < rings; ++ring) {
    angles.push_back(rings > 1 ? polar_min_rad + range * ring / (rings - 1)
                               : 0.5 * (polar_min_rad + polar_max_rad));
  }
  return angles;
}

/// Poses per ring: one each, a pole no more than that, the rest by length with the largest gaps
/// filled first.
std::vector<int> ring_counts(const std::vector<double>& angles, int count) {
  std::vector<int> counts(angles.size(), 1);
  for (int left = count - static_cast<int>(angles.size()); left > 0; --left) {
    std::size_t widest = 0;
    double widest_gap = -1.0;
    for (std::size_t ring = 0; ring < angles.size(); ++ring) {
      const double gap = std::sin(angles[ring]) / counts[ring];
      if (gap > widest_gap) {
        widest_gap = gap;
        widest = ring;
      }
    }
    ++counts[widest];
  }
  return counts;
}

std::vector<Vector3d> rings(int count, double polar_min_rad, double polar_max_rad) {
  const std::vector<double> angles = ring_angles(count, polar_min_rad, polar_max_rad);
  const std::vector<int> counts = ring_counts(angles, count);
  std::vector<Vector3d> outward;
  for (std::size_t ring = 0; ring < angles.size(); ++ring) {
    const double shift = ring % 2 == 0 ? 0.0 : 0.5;  // neighbours on neighbouring rings alternate
    for (int i = 0; i < counts[ring]; ++i) {
      outward.push_back(on_sphere(angles[ring], 2.0 * kPi * (i + shift) / counts[ring]));
    }
  }
  return outward;
}

void check_normal(const Vector3d& point_mm, const Vector3d& normal, std::size_t index) {
  if (!point_mm.allFinite() || !normal.allFinite() || !(normal.stableNorm() > 0.0)) {
    throw ConfigError(
        "viewpoints.source",
        fmt::format("point {} of the surface is at ({}, {}, {}) with the normal ({}, {}, "
                    "{}); both must be finite, the normal not zero",
                    index,
                    point_mm.x(),
                    point_mm.y(),
                    point_mm.z(),
                    normal.x(),
                    normal.y(),
                    normal.z()));
  }
}

}  // namespace

void visit_keys(KeyVisitor& keys, ViewpointSettings& s) {
  keys.choice("source",
              s.source,
              kSourceNames,
              "where the poses come from: [[viewpoint]], a file,"
              " around the part, or along its surface");
  keys.file("file", s.file, "TOML, CSV or JSON with nine numbers per pose; for source = \"file\"");
  keys.integer("count", s.count, Range::between(1, 100000), "poses on the sphere or the surface");
  keys.choice("layout", s.layout, kLayoutNames, "of the sphere: even by area, or circles");
  keys.number("polar_min_deg",
              s.polar_min_rad,
              Range::between(0, 180),
              "of the sphere, from the part's +z axis");
  keys.number("polar_max_deg", s.polar_max_rad, Range::between(0, 180), "of the sphere");
  keys.number("radius_mm",
              s.radius_mm,
              Range::between(0, 1e5),
              "of the sphere; 0 = the camera's working distance");
  keys.numbers("target_mm",
               s.target_mm,
               {.min = 3, .max = 3},
               Range{},
               "centre of the sphere, where all its poses look");
  keys.number("tilt_deg",
              s.tilt_rad,
              Range::between(-80, 80),
              "along the surface: of the view against the normal, towards up");
  keys.numbers("up",
               s.up,
               {.min = 3, .max = 3},
               Range{},
               "towards the top of the image, as far as the view allows");
  keys.require((s.source == ViewpointSource::kFile) == !s.file.empty(),
               "file",
               "must be given with source = \"file\", and only with it");
  keys.require(
      s.polar_min_rad <= s.polar_max_rad, "polar_min_deg", "must not be larger than polar_max_deg");
  keys.require(vector3(s.up).norm() > 0.0, "up", "must not be zero");
}

std::vector<Viewpoint> sphere_viewpoints(const ViewpointSettings& settings, double radius_mm) {
  const bool is_range = settings.polar_min_rad >= 0.0 && settings.polar_max_rad <= kPi + 1e-12 &&
                        settings.polar_min_rad <= settings.polar_max_rad;
  if (settings.count < 1 || !is_range || !(radius_mm > 0.0) || !std::isfinite(radius_mm)) {
    throw ConfigError(
        "viewpoints",
        fmt::format("{} poses at polar angles {:g} to {:g} deg and radius {:g} mm; count must be > "
                    "0, the angles ascending in [0, 180], the radius > 0",
                    settings.count,
                    settings.polar_min_rad * kDegPerRad,
                    settings.polar_max_rad * kDegPerRad,
                    radius_mm));
  }
  const auto layout = settings.layout == SphereLayout::kRings ? rings : fibonacci;
  std::vector<Viewpoint> viewpoints;
  for (const Vector3d& outward :
       layout(settings.count, settings.polar_min_rad, settings.polar_max_rad)) {
    viewpoints.push_back(
        looking_at(vector3(settings.target_mm), outward, radius_mm, vector3(settings.up)));
  }
  return viewpoints;
}

std::vector<Viewpoint> surface_viewpoints(std::span<const Vector3d> points_mm,
                                          std::span<const Vector3d> normals,
                                          double working_distance_mm,
                                          const ViewpointSettings& settings) {
  GLINT_CHECK(points_mm.size() == normals.size(), "each point has one normal");
  GLINT_CHECK(working_distance_mm > 0.0, "the camera stands off the surface");
  std::vector<Viewpoint> viewpoints;
  for (std::size_t i = 0; i < points_mm.size(); ++i) {
    check_normal(points_mm[i], normals[i], i);
    const Vector3d normal = normals[i].stableNormalized();
    const Vector3d up = upright(vector3(settings.up), normal);
    const Vector3d outward =
        std::cos(settings.tilt_rad) * normal + std::sin(settings.tilt_rad) * up;
    viewpoints.push_back(looking_at(points_mm[i], outward.normalized(), working_distance_mm, up));
  }
  return viewpoints;
}

std::vector<Viewpoint> make_viewpoints(const ViewpointSettings& settings,
                                       double working_distance_mm) {
  GLINT_CHECK(
      settings.source == ViewpointSource::kFile || settings.source == ViewpointSource::kSphere,
      "listed poses and surface poses are made from more than the settings");
  if (settings.source == ViewpointSource::kFile) {
    return read_viewpoints(settings.file);
  }
  return sphere_viewpoints(settings,
                           settings.radius_mm > 0.0 ? settings.radius_mm : working_distance_mm);
}

}  // namespace glint

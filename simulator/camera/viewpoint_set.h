// SPDX-License-Identifier: GPL-3.0-or-later
//
// The [viewpoints] table: many poses for one part, from a file or generated.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/config/keys.h"
#include "simulator/camera/viewpoint_file.h"

namespace glint {

enum class ViewpointSource { kListed, kFile, kSphere, kSurface };
enum class SphereLayout { kFibonacci, kRings };

/// Keys of [viewpoints].
struct ViewpointSettings {
  ViewpointSource source = ViewpointSource::kListed;
  std::filesystem::path file;  ///< for kFile
  int count = 12;              ///< poses, for kSphere and kSurface
  SphereLayout layout = SphereLayout::kFibonacci;
  double polar_min_rad = 0.0;  ///< from the +z axis
  double polar_max_rad = 1.2217304763960306;
  double radius_mm = 0.0;                           ///< 0: the camera's working distance
  std::vector<double> target_mm = {0.0, 0.0, 0.0};  ///< centre of the sphere, where all poses look
  double tilt_rad = 0.0;                            ///< for kSurface: away from the normal
  std::vector<double> up = {0.0, 1.0, 0.0};         ///< towards the top of the image, where it can
};

void visit_keys(KeyVisitor& keys, ViewpointSettings& settings);

/// Poses on a sphere around the target, all looking at it. Fibonacci: as many poses per area
/// everywhere between the polar angles. Rings: circles of equal polar spacing, both ends included,
/// each with poses in proportion to its length. `up` is projected onto the image; where it stands
/// along the view, the x axis is taken.
///
/// Source of the lattice: A. Gonzalez, "Measurement of areas on a sphere using Fibonacci and
/// latitude-longitude lattices", Mathematical Geosciences 42, 2010.
/// @param radius_mm  > 0
/// @throws ConfigError when a setting is not possible
std::vector<Viewpoint> sphere_viewpoints(const ViewpointSettings& settings, double radius_mm);

/// One pose per point of a surface: at the working distance along the normal, tilted by tilt_rad
/// towards the top of the image, looking at the point.
/// @param points_mm, normals  equally many; normals of any length
/// @throws ConfigError for a number that is not finite or a normal of zero
std::vector<Viewpoint> surface_viewpoints(std::span<const Eigen::Vector3d> points_mm,
                                          std::span<const Eigen::Vector3d> normals,
                                          double working_distance_mm,
                                          const ViewpointSettings& settings);

/// The poses of a source that needs no surface: kFile and kSphere. For kListed and kSurface the
/// caller has the list or the points.
/// @throws ConfigError, IoError
std::vector<Viewpoint> make_viewpoints(const ViewpointSettings& settings,
                                       double working_distance_mm);

}  // namespace glint

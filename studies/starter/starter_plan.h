// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a starter study is made of, before it is written down.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace glint {

/// The kind of light a starter study is for; kAll compares the others.
enum class StarterLight { kTunnel, kRing, kDome, kBar, kAll };

/// "tunnel", "ring", "dome", "bar", "all"
std::string_view light_name(StarterLight light);

/// Whether the part stays a mirror: under a fringe tunnel alone. Else it is rough metal.
constexpr bool is_mirror(StarterLight light) {
  return light == StarterLight::kTunnel;
}

/// What the working distance and the part's size ask for, [mm] and pixels. Places of lights are
/// distances from the camera.
struct StarterSizes {
  double tilt_deg = 0.0;  ///< of the part about the tunnel's axis
  double working_distance_mm = 0.0;
  double object_pixel_mm = 0.0;
  int width_px = 0;
  int height_px = 0;

  double tunnel_radius_mm = 0.0;
  double largest_radius_mm = 0.0;  ///< below the camera
  double slot_mm = 0.0;
  double length_mm = 0.0;
  double period_mm = 0.0;

  double view_radius_mm = 0.0;  ///< of a circle about what the camera sees, at the part
  double top_mm = 0.0;          ///< from the camera to the part's highest point
  double dome_radius_mm = 0.0;
  double diameter_mm = 0.0;  ///< of the defect
};

/// @param upright_mm  the part's box before it is turned
/// @throws ConfigError when the light would touch camera or part
StarterSizes starter_sizes(const Eigen::Vector3d& upright_mm,
                           double tilt_deg,
                           double working_distance_mm,
                           StarterLight light);

/// Everything that the text of a starter study is made of.
struct StarterPlan {
  StarterLight light = StarterLight::kTunnel;
  std::string name;         ///< of the part
  std::string part_file;    ///< as the study names it
  std::string unit = "mm";  ///< of the part's file
  std::string study_file;   ///< where the study will lie
  std::string camera_keys;  ///< TOML lines of a data sheet; empty: as the sizes have it
  StarterSizes sizes;
  std::vector<Eigen::Vector2d> places_mm;    ///< of dents, in the part's frame
  double slope_rad = 0.02;                   ///< of the dents at their steepest
  std::map<StarterLight, double> exposures;  ///< factors that fill the picture; none: 1
  double min_h = 0.0;                        ///< limit of homogeneity.h_rms
  double max_clipped = 0.01;                 ///< limit of homogeneity.clipped_share
  std::vector<std::string> remarks;          ///< sentences about the dent, for the text

  /// Of the sensor under a kind of light.
  double exposure(StarterLight kind) const;

  /// Depth of the dents: depth / (sigma sqrt(e)) is a Gaussian's largest slope, its diameter 4
  /// sigma.
  double depth_mm() const;
};

/// The score that a starter study maximises.
std::string_view objective_of(StarterLight light);

}  // namespace glint

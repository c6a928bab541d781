// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "simulator/light/area/emitter_shape.h"
#include "simulator/light/area/ies_table.h"

namespace glint {

inline constexpr double kM2PerMm2 = 1e-6;

/// A luminous surface with an angular profile.
///
/// Lobe: the radiance is `radiance` cos^(exponent - 1) of the angle to the normal, so the intensity
/// falls like cos^exponent; exponent 1 is a Lambertian surface. IES: `radiance` scales the table.
struct Emitter {
  EmitterShape shape = RectangleShape{};
  Eigen::Array3f radiance = Eigen::Array3f::Ones();  ///< W / (m^2 sr), along the normal
  double exponent = 1.0;                             ///< >= 1
  int body = -1;                                     ///< index of an IesBody; < 0: a lobe
  int group = 0;
  bool is_solid = true;  ///< its back hides what is behind; else rays pass from behind
  bool is_drawn = true;  ///< sample_light() draws directions to it; else rays meet it by themselves
};

/// The luminous opening of a measured light: all visible sides have the same radiance, which is the
/// intensity over the area that the opening shows in that direction.
struct IesBody {
  IesTable table;
  EmitterFrame frame;  ///< z its axis (vertical angle 0), x its length (horizontal angle 0)
  Eigen::Vector3d size_mm = Eigen::Vector3d::Ones();
  bool is_round = false;  ///< flat and a disc

  /// @param direction  unit, away from the light
  double projected_area_m2(const Eigen::Vector3d& direction) const;
  /// W / (m^2 sr) when the table is in W / sr.
  double radiance(const Eigen::Vector3d& direction) const;
};

/// What can be switched by itself. Pictures are linear in its factor.
struct LightGroup {
  std::string name;                                 ///< "ring", "ring.3"
  double factor = 1.0;                              ///< chosen in the scene; not in the radiances
  Eigen::Array3f power_w = Eigen::Array3f::Zero();  ///< at factor 1; 0 for an environment
};

/// W / (m^2 sr) that leave the surface of an emitter.
/// @param cosine     between its normal there and the way out; <= 0: 0
/// @param direction  unit, away from the light
Eigen::Array3f emitted_radiance(const Emitter& emitter,
                                const std::vector<IesBody>& bodies,
                                double cosine,
                                const Eigen::Vector3d& direction);

/// Flux of an emitter with a lobe: radiance area 2 pi / (exponent + 1).
Eigen::Array3f lobe_power_w(const Emitter& emitter);

/// The exponent whose intensity has fallen to one half at that angle, in (0, pi / 3].
double exponent_of_half_angle(double half_angle_rad);

}  // namespace glint

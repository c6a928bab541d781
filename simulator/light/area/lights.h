// SPDX-License-Identifier: GPL-3.0-or-later
//
// All lights of a scene, ready to be sampled and to be met by rays. Immutable once built
// (build_lights.h), safe to share between threads. Millimetres; radiance in W / (m^2 sr), relative:
// 1 is full scale of the sensor at exposure and gain 1 when the camera looks into the light.
//
// Radiances are those at factor 1 of each group: whoever adds them up keeps a sum for each group or
// multiplies by groups[g].factor. Nothing is clamped. docs/theory/lights.md
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "simulator/light/area/emitter.h"
#include "simulator/light/area/environment.h"
#include "simulator/light/area/light_tree.h"
#include "simulator/light/area/striped_wall.h"

namespace glint {

/// Stands for the environment where the index of an emitter is asked for.
inline constexpr int kEnvironment = -1;

struct Lights {
  std::vector<Emitter> emitters;
  std::vector<IesBody> bodies;
  std::vector<LightGroup> groups;
  LightTree tree;  ///< over the emitters
  std::optional<Environment> environment;
  EmitterFrame environment_frame;  ///< in which its picture stands upright
  int environment_group = -1;
  std::optional<StripedWall> wall;  ///< which of the emitters are a tunnel's
  int first_tunnel_group = -1;      ///< its groups are the last

  bool empty() const { return emitters.empty() && !environment; }

  bool has_wall() const { return first_tunnel_group >= 0; }

  bool is_of_wall(int group) const { return has_wall() && group >= first_tunnel_group; }
};

/// A direction towards a light.
struct LightSample {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();  ///< unit, from the point to the light
  double distance_mm = std::numeric_limits<double>::infinity();
  Eigen::Array3f radiance = Eigen::Array3f::Zero();  ///< towards the point
  double density = 0.0;                              ///< per steradian, with the choice; > 0
  int emitter = kEnvironment;
  int group = 0;
};

/// A light that a ray meets.
struct LightHit {
  double distance_mm = std::numeric_limits<double>::infinity();
  double cosine = 1.0;                               ///< <= 0: a back, which is dark
  Eigen::Array3f radiance = Eigen::Array3f::Zero();  ///< back along the ray
  int emitter = kEnvironment;
  int group = 0;
};

/// Draws a direction from a point to a light. Whether other things or lights stand between is not
/// asked: see is_occluded(). Empty: this sample contributes nothing. @param u, v  in [0, 1)
std::optional<LightSample> sample_light(const Lights& lights,
                                        const Eigen::Vector3d& point_mm,
                                        double u,
                                        double v);

/// The nearest light before max_mm on a ray; at infinity the environment.
std::optional<LightHit> hit_light(const Lights& lights,
                                  const Ray& ray,
                                  double max_mm = std::numeric_limits<double>::infinity());

/// The density with which sample_light() draws the direction of a ray that hits like that.
double light_density(const Lights& lights, const Ray& ray, const LightHit& hit);

/// True when a light stands in the way of a sample: hit_light() would not see its emitter.
bool is_occluded(const Lights& lights, const Eigen::Vector3d& point_mm, const LightSample& sample);

/// Sentences for lights whose files (IES) have a table of the lamp's output against its tilt, which
/// is not applied.
std::vector<std::string> tilt_warnings(const Lights& lights);

/// Sentences for lights whose intensities were measured from afar (IES) and that stand nearer to
/// one of the points than five times the size of their opening.
std::vector<std::string> far_field_warnings(const Lights& lights,
                                            const std::vector<Eigen::Vector3d>& points_mm);

}  // namespace glint

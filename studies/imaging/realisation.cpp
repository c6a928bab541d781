// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/realisation.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/units.h"
#include "defects/part/height_defects.h"

namespace glint {
namespace {

/// A fine mesh that is moved along the normal needs stretched triangles beyond this slope.
constexpr double kSteepest_rad = 45.0 * kRadPerDeg;

/// The light stands nearer than the camera; how much is not known while the tunnel is searched for.
constexpr double kLightShare = 0.1;

double max_slope_rad(const Defect& defect) {
  return height_feature(defect, DefectGroup{}).max_slope_rad();
}

/// Roughness and custom tools have no height that could be written down.
bool needs_tool(const Defect& defect, const DefectGroup& group) {
  const bool is_ragged = defect.type == DefectType::kPit || defect.type == DefectType::kGouge;
  return !group.tool_folder.empty() || std::atan(max_slope_rad(defect)) > kSteepest_rad ||
         (is_ragged && group.roughness > 0.0);
}

}  // namespace

double normal_error(const Defect& defect, double view_rad, double light_mm) {
  const double slope = max_slope_rad(defect);
  // Beyond this the mirrored ray, or the way to the camera, meets the flank on the other side.
  if (view_rad + 2.0 * std::atan(slope) >= 0.5 * kPi - std::atan(slope)) {
    return std::numeric_limits<double>::infinity();
  }
  const double sigma_mm = 0.5 * defect.radius_mm();
  const double tangent = std::tan(view_rad);
  return std::sqrt(std::exp(1.0)) * (slope + sigma_mm / light_mm) * tangent + slope * slope;
}

Realisation cheapest_realisation(const Defect& defect,
                                 const DefectGroup& group,
                                 const SceneSettings& scene) {
  if (defect.type == DefectType::kStain) {
    return Realisation::kNormal;
  }
  if (needs_tool(defect, group)) {
    return Realisation::kImprinted;
  }
  const std::vector<double>& at_mm = scene.viewpoint().position_mm;
  const Eigen::Vector3d to_camera =
      Eigen::Vector3d(at_mm[0], at_mm[1], at_mm[2]) - defect.place.centre_mm;
  const double distance_mm = to_camera.norm();
  const double cosine = to_camera.dot(defect.place.normal) / distance_mm;
  if (cosine <= 0.0) {
    return Realisation::kNormal;  // the camera does not see it
  }
  const double view_rad = std::acos(std::min(1.0, cosine));
  return normal_error(defect, view_rad, kLightShare * distance_mm) <= group.tolerance
             ? Realisation::kNormal
             : Realisation::kDisplaced;
}

}  // namespace glint

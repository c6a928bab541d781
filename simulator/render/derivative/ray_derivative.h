// SPDX-License-Identifier: GPL-3.0-or-later
//
// How the rays of a cache move with the camera: for the derivative of a picture by the camera's
// pose. The surface stays where it is, and so does each ray's place on the image.
#pragma once

#include <vector>

#include "simulator/render/corner_rays/corner_rays.h"

namespace glint {

/// A motion of the camera: the pinhole moves by `translation_mm` and the camera turns about it by
/// the vector `rotation_rad` (right hand, axes of the world), both times the unit that a derivative
/// is taken by.
struct CameraTwist {
  Eigen::Vector3d translation_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();
};

/// Everything the rays of a camera depend on.
struct CameraScene {
  const Part& part;
  const Bvh& bvh;
  const SurfaceDetail& detail;
  const PinholeCamera& camera;
  const RigidTransform& camera_from_world;
  const RenderSettings& settings;
};

/// Derivatives of origin and direction of the corner rays, one for each motion, in the order of
/// CornerRays::corners. Zero for rays that miss the part or meet it more than once: what becomes of
/// those jumps. Exact surfaces and defects by central differences in double (to about 1e-6);
/// triangles are treated as constant, so that kinks of interpolated normals do not show.
/// Cost: about two tracings, whatever the number of motions, and a tenth of one for each motion.
std::vector<RayDerivative> corner_derivatives(const CameraScene& scene,
                                              const std::vector<CameraTwist>& twists,
                                              ThreadPool& pool);

/// The same for the rays of refined pixels, in the order of RefinedGroup::rays.
std::vector<RayDerivative> refined_derivatives(const CameraScene& scene,
                                               const RefinedGroup& group,
                                               const std::vector<CameraTwist>& twists,
                                               ThreadPool& pool);

}  // namespace glint

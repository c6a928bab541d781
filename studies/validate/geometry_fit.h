// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where edges of many views lie against where the simulation has them, explained by one lens, one
// hand-eye, one place of the part and the robot's errors, each as well as it is known. Model and
// decision: docs/validate.md.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/pose.h"
#include "simulator/camera/pinhole_camera.h"
#include "studies/compare/fit/cause_fit.h"

namespace glint {

/// Edges of one view. Their order is that of their boundaries.
struct ViewEdges {
  std::vector<SpaceEdge> edges;
  RigidTransform camera_from_scene;
  double robot_sigma_mm = 0.0;  ///< of this picture's pose, per axis
  double robot_sigma_rad = 0.0;
};

/// How well things are known before the pictures are looked at.
struct GeometryBudget {
  /// Of fx fy cx cy k1 k2 k3 p1 p2, then a small motion of the camera in its own frame, rotation
  /// [rad] before position [mm].
  Eigen::Matrix<double, 15, 15> camera = Eigen::Matrix<double, 15, 15>::Zero();
  /// Of the same numbers what p1 and p2 may be that the calibration left at zero, with the turn and
  /// the centre by which it has seen them instead (docs/validate.md); one standard deviation a
  /// column. The edges cannot tell them, and no limit grows by them.
  Eigen::Matrix<double, 15, 2> unseen = Eigen::Matrix<double, 15, 2>::Zero();
  /// Of a small motion of the part in the scene's frame about `middle_mm`, rotation before
  /// position, per axis.
  Eigen::Matrix<double, 6, 1> part_sigma = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Vector3d middle_mm = Eigen::Vector3d::Zero();  ///< of the part, in the scene
};

/// What may be wrong beyond its budget.
enum class GeometryFault : std::size_t { kFocalLength, kCentre, kDistortion, kHandEye, kPartPose };

inline constexpr std::size_t kGeometryFaults = 5;

/// "focal_length", "centre", "distortion", "hand_eye", "part_pose".
std::string name_of(GeometryFault fault);

struct GeometryFit {
  bool is_known = false;                ///< false: fewer than 50 edges
  std::vector<GeometryFault> faults;    ///< beyond their budgets; empty: nothing is
  std::vector<GeometryFault> or_these;  ///< would explain the edges nearly as well
  Eigen::Matrix<double, 9, 1> lens = Eigen::Matrix<double, 9, 1>::Zero();      ///< changes
  Eigen::Matrix<double, 6, 1> hand_eye = Eigen::Matrix<double, 6, 1>::Zero();  ///< as the budget's
  Eigen::Matrix<double, 6, 1> part = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 21, 1> sigma = Eigen::Matrix<double, 21, 1>::Zero();  ///< of all of them
  std::vector<Eigen::Matrix<double, 6, 1>> robot;  ///< of each view: motion of the camera
  /// Of the lens's nine numbers, then of each view's motion of the camera against the part, all
  /// that may have moved it together: in the camera's frame, rotation [rad] before position [mm].
  Eigen::MatrixXd covariance;

  // Root mean squares along the edges' normals, px.
  double before_px = 0.0;  ///< of all offsets
  double after_px = 0.0;   ///< of what nothing explains
  double pose_px = 0.0;    ///< explained by hand-eye, part and robot
  double lens_px = 0.0;
  double noise_px = 0.0;        ///< of one edge
  double pose_budget_px = 0.0;  ///< what the budget predicts of them
  double lens_budget_px = 0.0;
};

/// The most likely explanation by least squares with the budget as prior. A fault is told where
/// freeing it lowers the sum of squares by more than kGeometryPrice for each of its numbers, and by
/// 2 % of the misfit.
GeometryFit fit_geometry(std::span<const ViewEdges> views,
                         const PinholeIntrinsics& camera,
                         const GeometryBudget& budget);

/// camera_from_scene after the changes of a fit. @param view  index of the fit's view
RigidTransform refitted_view(const GeometryFit& fit,
                             const GeometryBudget& budget,
                             const RigidTransform& camera_from_scene,
                             std::size_t view);

/// The motion of a rotation vector [rad] and a translation [mm].
RigidTransform moved_by(const Eigen::Matrix<double, 6, 1>& motion);

}  // namespace glint

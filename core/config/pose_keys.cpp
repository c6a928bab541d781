// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/config/pose_keys.h"

#include <Eigen/Geometry>

#include "core/pose.h"

namespace glint {
namespace {

using Eigen::Vector3d;

constexpr Count kThree = {.min = 3, .max = 3};

}  // namespace

void visit_keys(KeyVisitor& keys, PoseSettings& s) {
  keys.numbers("translation_mm",
               s.translation_mm,
               kThree,
               Range{},
               "of target_from_source: the source's origin in the target's frame");
  keys.numbers("rotation_vector_deg",
               s.rotation_vector_rad,
               kThree,
               Range::between(-360, 360),
               "axis, in the target's frame, times angle by which the source is turned there");
}

void visit_keys(KeyVisitor& keys, MeasuredPoseSettings& s) {
  visit_keys(keys, s.pose);
  keys.numbers("sigma_mm",
               s.sigma_mm,
               kThree,
               Range::at_least(0),
               "standard deviations of the position along the source's axes; 0 = not known");
  keys.numbers("sigma_deg",
               s.sigma_rad,
               kThree,
               Range::at_least(0),
               "standard deviations of the rotation about the source's axes; 0 = not known");
}

RigidTransform transform_of(const PoseSettings& settings) {
  const Vector3d turn = vector_of(settings.rotation_vector_rad);
  const double angle = turn.norm();
  RigidTransform transform = {.translation_mm = vector_of(settings.translation_mm)};
  if (angle > 0.0) {
    transform.rotation = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  }
  return transform;
}

PoseSettings pose_settings(const RigidTransform& transform) {
  const Eigen::AngleAxisd turn(transform.rotation);
  const Vector3d vector = turn.angle() * turn.axis();
  const Vector3d& at = transform.translation_mm;
  return {.translation_mm = {at.x(), at.y(), at.z()},
          .rotation_vector_rad = {vector.x(), vector.y(), vector.z()}};
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/kinematics/closed_form.h"

#include <algorithm>
#include <cmath>

#include "core/units.h"

namespace glint {
namespace {

constexpr double kFreeSine = 1e-12;  ///< below it joint 6 turns about the axis of joint 4

/// A pose in the frame after joint 1, seen along the parallel axes of joints 2 to 4.
class ShoulderView {
 public:
  ShoulderView(const DhTable& table, const Eigen::Isometry3d& base_from_flange, double joint1_rad)
      : joint1_rad_(joint1_rad) {
    const double c = std::cos(joint1_rad);
    const double s = std::sin(joint1_rad);
    // Rows of the rotation of frame 1 in the base: x1, y1 = base's z, z1 = the parallel axes.
    Eigen::Matrix3d frame1_from_base;
    frame1_from_base << c, s, 0.0, 0.0, 0.0, 1.0, s, -c, 0.0;
    rotation_ = frame1_from_base * base_from_flange.linear();
    translation_mm_ = frame1_from_base *
                      (base_from_flange.translation() - Eigen::Vector3d(0.0, 0.0, table[0].d_mm));
  }

  double joint1_rad() const { return joint1_rad_; }

  /// |sin| of joint 5.
  double wrist_sine() const { return std::hypot(rotation_(2, 0), rotation_(2, 1)); }

  double joint5_rad(int sign) const { return std::atan2(sign * wrist_sine(), rotation_(2, 2)); }

  bool is_joint6_free() const { return wrist_sine() < kFreeSine; }

  double joint6_rad(int sign) const {
    return std::atan2(-sign * rotation_(2, 1), sign * rotation_(2, 0));
  }

  const Eigen::Matrix3d& rotation() const { return rotation_; }

  const Eigen::Vector3d& translation_mm() const { return translation_mm_; }

 private:
  double joint1_rad_;
  Eigen::Matrix3d rotation_;
  Eigen::Vector3d translation_mm_;
};

/// Joint 5 and 6, and what is left for joints 2 to 4: the place of the wrist and the sum of angles.
struct PlanarTask {
  double joint5_rad;
  double joint6_rad;
  double x_mm;
  double y_mm;
  double sum_rad;  ///< joints 2 + 3 + 4
};

PlanarTask planar_task(const DhTable& table,
                       const ShoulderView& view,
                       int sign,
                       double joint6_rad) {
  PlanarTask task = {.joint5_rad = view.joint5_rad(sign),
                     .joint6_rad = joint6_rad,
                     .x_mm = 0.0,
                     .y_mm = 0.0,
                     .sum_rad = 0.0};
  // Columns of frame 4: x4 is x5 turned back by joint 5, and x5 is x6 turned back by joint 6.
  const double c6 = std::cos(task.joint6_rad);
  const double s6 = std::sin(task.joint6_rad);
  const double c5 = std::cos(task.joint5_rad);
  const double s5 = std::sin(task.joint5_rad);
  const Eigen::Matrix3d& flange = view.rotation();
  const Eigen::Vector3d x5 = c6 * flange.col(0) - s6 * flange.col(1);
  const Eigen::Vector3d y5 = s6 * flange.col(0) + c6 * flange.col(1);
  const Eigen::Vector3d& z5 = flange.col(2);
  // link_motion() of joint 5 with alpha = -pi/2: x5 = c5 x4 + s5 y4, y5 = -z4, z5 = -s5 x4 + c5 y4.
  const Eigen::Vector3d x4 = c5 * x5 - s5 * z5;
  const Eigen::Vector3d z4 = -y5;
  const Eigen::Vector3d wrist_mm = view.translation_mm() - table[5].d_mm * z5 - table[4].d_mm * z4;
  task.x_mm = wrist_mm.x();
  task.y_mm = wrist_mm.y();
  task.sum_rad = std::atan2(x4.y(), x4.x());
  return task;
}

/// @return the wrist's place is within reach of upper arm and forearm
bool add_elbows(const DhTable& table,
                double joint1_rad,
                const PlanarTask& task,
                double slack,
                ArmSolutions& solutions) {
  const double a2 = table[1].a_mm;
  const double a3 = table[2].a_mm;
  const double square = task.x_mm * task.x_mm + task.y_mm * task.y_mm;
  const double cosine = (square - a2 * a2 - a3 * a3) / (2.0 * a2 * a3);
  if (std::abs(cosine) > 1.0 + slack) {
    return false;
  }
  const double c3 = std::clamp(cosine, -1.0, 1.0);
  const double sine = std::sqrt((1.0 - c3) * (1.0 + c3));
  for (const int sign : {1, -1}) {
    const double s3 = sign * sine;
    const double joint3 = std::atan2(s3, c3);
    const double joint2 = std::atan2(task.y_mm, task.x_mm) - std::atan2(a3 * s3, a2 + a3 * c3);
    JointVector joints_rad;
    joints_rad << wrapped_rad(joint1_rad), wrapped_rad(joint2), joint3,
        wrapped_rad(task.sum_rad - joint2 - joint3), task.joint5_rad, task.joint6_rad;
    solutions.add(joints_rad);
    if (sine == 0.0) {
      break;  // both elbows are one
    }
  }
  return true;
}

/// Joint 5 at 0 or pi: joint 6 turns the wrist's place on a circle, of which a part may be in
/// reach.
void add_free_wrist(const DhTable& table,
                    const ShoulderView& view,
                    double slack,
                    ArmSolutions& solutions) {
  constexpr int kAngles = 72;
  for (int i = 0; i < kAngles; ++i) {
    const int turn = i % 2 == 0 ? i / 2 : -(i + 1) / 2;
    const double joint6 = wrapped_rad(2.0 * kPi * turn / kAngles);
    if (add_elbows(
            table, view.joint1_rad(), planar_task(table, view, 1, joint6), slack, solutions)) {
      return;
    }
  }
}

}  // namespace

double wrapped_rad(double angle_rad) {
  const double wrapped = std::remainder(angle_rad, 2.0 * kPi);
  return wrapped <= -kPi ? kPi : wrapped;
}

ArmSolutions closed_form_inverse(const DhTable& table,
                                 const Eigen::Isometry3d& base_from_flange,
                                 double slack) {
  ArmSolutions solutions;
  const Eigen::Vector3d wrist_mm =
      base_from_flange.translation() - table[5].d_mm * base_from_flange.linear().col(2);
  const double radius_mm = std::hypot(wrist_mm.x(), wrist_mm.y());
  const double offset_mm = table[3].d_mm;
  if (radius_mm < offset_mm * (1.0 - slack)) {
    return solutions;
  }
  const double side_mm =
      std::sqrt(std::max(0.0, (radius_mm - offset_mm) * (radius_mm + offset_mm)));
  const double direction = std::atan2(wrist_mm.y(), wrist_mm.x());
  for (const int shoulder : {1, -1}) {
    const double joint1 = direction + std::atan2(shoulder * side_mm, offset_mm) + kPi / 2.0;
    const ShoulderView view(table, base_from_flange, joint1);
    if (view.is_joint6_free()) {
      add_free_wrist(table, view, slack, solutions);
    } else {
      for (const int wrist : {1, -1}) {
        const PlanarTask task = planar_task(table, view, wrist, view.joint6_rad(wrist));
        add_elbows(table, joint1, task, slack, solutions);
      }
    }
    if (side_mm == 0.0) {
      break;
    }
  }
  return solutions;
}

}  // namespace glint

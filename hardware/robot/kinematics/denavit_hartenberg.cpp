// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/kinematics/denavit_hartenberg.h"

#include <cmath>

#include "core/units.h"

namespace glint {
namespace {

/// The lengths that are not zero.
struct ArmLengths {
  double d1_mm;
  double a2_mm;
  double a3_mm;
  double d4_mm;
  double d5_mm;
  double d6_mm;
};

constexpr std::array<ArmLengths, 3> kLengths = {{
    {151.9, -243.65, -213.25, 112.35, 85.35, 81.9},
    {151.85, -243.55, -213.2, 131.05, 85.35, 92.1},
    {162.5, -425.0, -392.2, 133.3, 99.7, 99.6},
}};

}  // namespace

DhTable nominal_table(ArmModel model) {
  const ArmLengths& lengths = kLengths.at(static_cast<std::size_t>(model));
  return {{{.d_mm = lengths.d1_mm, .alpha_rad = kPi / 2.0},
           {.a_mm = lengths.a2_mm},
           {.a_mm = lengths.a3_mm},
           {.d_mm = lengths.d4_mm, .alpha_rad = kPi / 2.0},
           {.d_mm = lengths.d5_mm, .alpha_rad = -kPi / 2.0},
           {.d_mm = lengths.d6_mm}}};
}

bool is_cb3(ArmModel model) {
  return model == ArmModel::kUr3;
}

Eigen::Isometry3d link_motion(const DhRow& row, double joint_rad) {
  const double angle_rad = joint_rad + row.theta_rad;
  const double c = std::cos(angle_rad);
  const double s = std::sin(angle_rad);
  const double ca = std::cos(row.alpha_rad);
  const double sa = std::sin(row.alpha_rad);
  Eigen::Isometry3d motion;
  motion.matrix() << c, -s * ca, s * sa, row.a_mm * c,  //
      s, c * ca, -c * sa, row.a_mm * s,                 //
      0.0, sa, ca, row.d_mm,                            //
      0.0, 0.0, 0.0, 1.0;
  return motion;
}

LinkFrames link_frames(const DhTable& table, const JointVector& joints_rad) {
  LinkFrames frames;
  frames[0] = Eigen::Isometry3d::Identity();
  for (std::size_t i = 0; i < table.size(); ++i) {
    frames[i + 1] = frames[i] * link_motion(table[i], joints_rad[static_cast<Eigen::Index>(i)]);
  }
  return frames;
}

}  // namespace glint

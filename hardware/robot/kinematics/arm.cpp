// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/kinematics/arm.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/SVD>

#include "core/error.h"
#include "core/units.h"

namespace glint {
namespace {

constexpr int kMaxSteps = 30;
constexpr double kExactMm = 1e-9;
constexpr double kExactRad = 1e-9;
constexpr double kStartSlack = 0.15;  ///< an arm with deltas reaches where the nominal one does not
constexpr double kSameRad = 1e-6;
constexpr double kMetrePerMm = 1e-3;
/// Below this measure of a start, branches of the nominal arm and of one with deltas may meet at
/// different places, so that both starts of a pair lead to one of the two: starts on both sides
/// find the other.
constexpr double kMeetingMeasure = 0.04;
constexpr std::array<double, 3> kMeetingSteps_rad = {0.03, 0.1, 0.3};

ArmJacobian jacobian_of(const LinkFrames& frames) {
  ArmJacobian jacobian;
  const Eigen::Vector3d flange_mm = frames[6].translation();
  for (int i = 0; i < 6; ++i) {
    const Eigen::Isometry3d& frame = frames[static_cast<std::size_t>(i)];
    const Eigen::Vector3d axis = frame.linear().col(2);
    jacobian.col(i).head<3>() = axis.cross(flange_mm - frame.translation());
    jacobian.col(i).tail<3>() = axis;
  }
  return jacobian;
}

/// The step that takes the difference away, in least squares with lengths in metres; damped where
/// the Jacobian is nearly singular and the difference large.
JointVector newton_step(ArmJacobian jacobian, JointVector difference) {
  jacobian.topRows<3>() *= kMetrePerMm;
  difference.head<3>() *= kMetrePerMm;
  const double damping = 1e-3 * difference.squaredNorm();
  ArmJacobian normal = jacobian.transpose() * jacobian;
  if (damping > 1e-24) {
    normal.diagonal().array() += damping;
    return normal.ldlt().solve(jacobian.transpose() * difference);
  }
  return jacobian.fullPivLu().solve(difference);
}

/// Where branches meet, the flange stands still while the joints move along this direction.
JointVector stillest_motion(const ArmJacobian& jacobian, double& measure) {
  ArmJacobian scaled = jacobian;
  scaled.topRows<3>() *= kMetrePerMm;
  const Eigen::JacobiSVD<ArmJacobian> svd(scaled, Eigen::ComputeFullV);
  measure = svd.singularValues()[5];
  return svd.matrixV().col(5);
}

bool is_known(const ArmSolutions& solutions, const JointVector& joints_rad) {
  return std::ranges::any_of(solutions, [&joints_rad](const JointVector& known) {
    const JointVector apart = (joints_rad - known).unaryExpr(&wrapped_rad);
    return apart.cwiseAbs().maxCoeff() < kSameRad;
  });
}

}  // namespace

Arm::Arm(ArmModel model, const ArmDeltas& deltas)
    : model_(model),
      nominal_(nominal_table(model)),
      table_(calibrated_table(model, deltas)),
      is_nominal_(deltas.is_zero()) {
  GLINT_CHECK(is_nominal_ || deltas.model == model, "deltas are of this arm");
}

Eigen::Isometry3d Arm::forward(const JointVector& joints_rad) const {
  return frames(joints_rad)[6];
}

ArmJacobian Arm::jacobian(const JointVector& joints_rad) const {
  return jacobian_of(frames(joints_rad));
}

ArmSolutions Arm::inverse(const Eigen::Isometry3d& base_from_flange) const {
  if (is_nominal_) {
    return closed_form_inverse(nominal_, base_from_flange);
  }
  ArmSolutions solutions;
  const auto add_from = [&](const JointVector& start_rad) {
    const std::optional<JointVector> joints_rad = refined(base_from_flange, start_rad);
    if (joints_rad && !solutions.is_full() && !is_known(solutions, *joints_rad)) {
      solutions.add(*joints_rad);
    }
  };
  const ArmSolutions starts_rad = closed_form_inverse(nominal_, base_from_flange, kStartSlack);
  std::ranges::for_each(starts_rad, add_from);
  for (const JointVector& start_rad : starts_rad) {
    if (solutions.is_full()) {
      break;
    }
    double measure = 0.0;
    const JointVector along = stillest_motion(jacobian(start_rad), measure);
    if (measure < kMeetingMeasure) {
      for (const double step_rad : kMeetingSteps_rad) {
        add_from(start_rad + step_rad * along);
        add_from(start_rad - step_rad * along);
      }
    }
  }
  return solutions;
}

std::optional<JointVector> Arm::refined(const Eigen::Isometry3d& base_from_flange,
                                        const JointVector& start_rad) const {
  JointVector joints_rad = start_rad;
  for (int i = 0; i < kMaxSteps; ++i) {
    const LinkFrames now = frames(joints_rad);
    const JointVector difference = pose_difference(base_from_flange, now[6]);
    if (difference.head<3>().norm() < kExactMm && difference.tail<3>().norm() < kExactRad) {
      return joints_rad.unaryExpr(&wrapped_rad);
    }
    joints_rad += newton_step(jacobian_of(now), difference);
    if (!joints_rad.allFinite()) {
      return std::nullopt;
    }
  }
  return std::nullopt;
}

JointVector pose_difference(const Eigen::Isometry3d& to, const Eigen::Isometry3d& from) {
  JointVector difference;
  difference.head<3>() = to.translation() - from.translation();
  const Eigen::AngleAxisd turn(Eigen::Matrix3d(to.linear() * from.linear().transpose()));
  difference.tail<3>() = turn.angle() * turn.axis();
  return difference;
}

double singularity_measure(const ArmJacobian& jacobian) {
  ArmJacobian scaled = jacobian;
  scaled.topRows<3>() *= kMetrePerMm;
  return Eigen::JacobiSVD<ArmJacobian>(scaled).singularValues()[5];
}

JointVector nearest_turns(const JointVector& solution_rad,
                          const JointVector& reference_rad,
                          double limit_rad) {
  JointVector joints_rad;
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double angle = reference_rad[i] + wrapped_rad(solution_rad[i] - reference_rad[i]);
    joints_rad[i] = angle > limit_rad    ? angle - 2.0 * kPi
                    : angle < -limit_rad ? angle + 2.0 * kPi
                                         : angle;
  }
  return joints_rad;
}

std::optional<JointVector> nearest_solution(const ArmSolutions& solutions,
                                            const JointVector& reference_rad,
                                            double limit_rad) {
  std::optional<JointVector> nearest;
  double min_rad = 0.0;
  for (const JointVector& solution_rad : solutions) {
    const JointVector joints_rad = nearest_turns(solution_rad, reference_rad, limit_rad);
    const double motion_rad = (joints_rad - reference_rad).cwiseAbs().maxCoeff();
    if (!nearest || motion_rad < min_rad) {
      nearest = joints_rad;
      min_rad = motion_rad;
    }
  }
  return nearest;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/joint_choices.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace glint {
namespace {

/// A joint's angles that are whole turns apart and within limits.
std::vector<double> turns_of(double angle_rad, double min_rad, double max_rad) {
  std::vector<double> turns;
  for (int k = -2; k <= 2; ++k) {
    const double turned = angle_rad + 2.0 * kPi * k;
    if (turned >= min_rad && turned <= max_rad) {
      turns.push_back(turned);
    }
  }
  return turns;
}

std::string limit_text(const PlanningCell& cell, const JointVector& joints_rad) {
  for (Eigen::Index i = 0; i < 6; ++i) {
    if (turns_of(joints_rad[i], cell.joint_min_rad[i], cell.joint_max_rad[i]).empty()) {
      return fmt::format("joint {} would be at {:.1f} degrees, allowed are {:.1f} to {:.1f}",
                         i + 1,
                         joints_rad[i] * kDegPerRad,
                         cell.joint_min_rad[i] * kDegPerRad,
                         cell.joint_max_rad[i] * kDegPerRad);
    }
  }
  return {};
}

/// How far a branch came, and why no farther.
struct Judgement {
  ViewOutcome outcome = ViewOutcome::kPlanned;
  std::string reason;
};

Judgement judge(const PlanningCell& cell,
                const ClearanceCheck& clearance,
                const JointVector& joints_rad,
                JointChoice& choice) {
  if (std::string text = limit_text(cell, joints_rad); !text.empty()) {
    return {.outcome = ViewOutcome::kJointLimit, .reason = std::move(text)};
  }
  if (std::string text = singular_text(cell, joints_rad); !text.empty()) {
    return {.outcome = ViewOutcome::kSingular, .reason = std::move(text)};
  }
  choice.turns_rad = turns_within(cell, joints_rad);
  choice.singularity = singularity_measure(cell.arm.arm.jacobian(joints_rad));
  const Clearance there = clearance.at(choice.turns_rad.front());
  choice.margin_mm = there.margin_mm;
  switch (there.touch) {
    case Clearance::Touch::kBox:
      return {.outcome = ViewOutcome::kBox, .reason = there.text};
    case Clearance::Touch::kCollision:
      return {.outcome = ViewOutcome::kCollision, .reason = there.text};
    case Clearance::Touch::kNone:
      break;
  }
  return {};
}

/// Unreachable is the worst, then beyond limits, singular, out of the box, in collision.
int rank_of(ViewOutcome outcome) {
  return outcome == ViewOutcome::kPlanned ? 100 : static_cast<int>(outcome);
}

}  // namespace

std::vector<JointVector> turns_within(const PlanningCell& cell, const JointVector& joints_rad) {
  std::vector<JointVector> all = {joints_rad};
  for (Eigen::Index i = 0; i < 6; ++i) {
    std::vector<JointVector> more;
    for (const double turned :
         turns_of(joints_rad[i], cell.joint_min_rad[i], cell.joint_max_rad[i])) {
      for (JointVector joints : all) {
        joints[i] = turned;
        more.push_back(joints);
      }
    }
    all = std::move(more);
  }
  const JointVector middle_rad = 0.5 * (cell.joint_min_rad + cell.joint_max_rad);
  std::ranges::stable_sort(
      all, {}, [&](const JointVector& joints) { return (joints - middle_rad).squaredNorm(); });
  return all;
}

std::string singular_text(const PlanningCell& cell, const JointVector& joints_rad) {
  for (const Eigen::Index joint : {2, 4}) {
    const double sine = std::abs(std::sin(joints_rad[joint]));
    if (sine < cell.min_joint_sine) {
      return fmt::format("joint {} at {:.1f} degrees: its sine has to be {:g} or more",
                         joint + 1,
                         joints_rad[joint] * kDegPerRad,
                         cell.min_joint_sine);
    }
  }
  const double measure = singularity_measure(cell.arm.arm.jacobian(joints_rad));
  if (measure < cell.arm.limits.min_singularity_measure) {
    return fmt::format("singularity measure {:.4f}, allowed is {:.4f}",
                       measure,
                       cell.arm.limits.min_singularity_measure);
  }
  return {};
}

JointChoices choices_of(const PlanningCell& cell,
                        const ClearanceCheck& clearance,
                        const Eigen::Isometry3d& base_from_flange) {
  JointChoices choices = {.outcome = ViewOutcome::kUnreachable,
                          .reason = "no joints take the camera there"};
  for (const JointVector& joints_rad : cell.arm.arm.inverse(base_from_flange)) {
    JointChoice choice;
    Judgement judged = judge(cell, clearance, joints_rad, choice);
    if (judged.outcome == ViewOutcome::kPlanned) {
      choices.accepted.push_back(std::move(choice));
    }
    if (rank_of(judged.outcome) > rank_of(choices.outcome)) {
      choices.outcome = judged.outcome;
      choices.reason = std::move(judged.reason);
    }
  }
  return choices;
}

}  // namespace glint

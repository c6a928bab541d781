// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/acquisition/arm_guide.h"

#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "core/units.h"

namespace glint {
namespace {

constexpr double kOldStateS = 0.5;
constexpr double kSettleS = 60.0;   ///< for an arm that still moves when it is found
constexpr double kMovedRad = 2e-4;  ///< twice what the rule of standstill lets joints be off

std::string joints_text(const JointVector& joints_rad) {
  std::string text;
  for (int i = 0; i < 6; ++i) {
    text += fmt::format("{}{:.2f}", i == 0 ? "" : ", ", joints_rad[i] * kDegPerRad);
  }
  return "joints at " + text + " degrees";
}

std::string outcome_text(const MotionResult& result) {
  return fmt::format(
      "{}{}{}", name_of(result.outcome), result.text.empty() ? "" : ": ", result.text);
}

}  // namespace

RobotState ArmGuide::fresh_state() const {
  const auto state = robot_.state();
  if (!state || state->age_s > kOldStateS) {
    throw ArmFailure{.text = "the arm's pose is not known"};
  }
  if (!allows_motion(state->safety_mode)) {
    throw ArmFailure{.text = fmt::format("safety mode {}", name_of(state->safety_mode))};
  }
  if (state->robot_mode != RobotMode::kRunning) {
    throw ArmFailure{.text = fmt::format("robot mode {}", name_of(state->robot_mode))};
  }
  if (state->is_guided()) {
    throw ArmFailure{.text = "the teach button is pressed: somebody guides the arm by hand"};
  }
  return *state;
}

void ArmGuide::normal_state() const {
  const RobotState state = fresh_state();
  if (state.safety_mode != SafetyMode::kNormal) {
    throw ArmFailure{.text = fmt::format("safety mode {}", name_of(state.safety_mode))};
  }
}

void ArmGuide::find_place(std::size_t near) {
  fresh_state();
  const StillPose pose = still(kSettleS);
  place_ = place_on(tour_, pose.joints_rad, near);
  if (!place_) {
    has_failed_ = true;
    throw ArmFailure{
        .text = fmt::format("the arm stands on no planned way, {:.1f} degrees from the nearest; "
                            "bring it to a safe position first: glint cell safe CELL --move",
                            distance_from_tour_rad(tour_, pose.joints_rad) * kDegPerRad),
        .is_off_tour = true};
  }
}

std::vector<std::size_t> ArmGuide::way(std::size_t goal) const {
  if (!place_) {
    throw ArmFailure{.text = "the arm's place is not known", .is_off_tour = true};
  }
  return way_to(*place_, goal);
}

void ArmGuide::go(std::size_t point) {
  GLINT_CHECK(place_ && (point == place_->leg || point == place_->leg + 1 ||
                         (place_->is_point && point + 1 == place_->leg)),
              "the arm goes to neighbours");
  if (has_failed_) {
    throw ArmFailure{.text = "the arm was stopped before"};
  }
  last_point_ = point;
  const MotionResult result = robot_.move_joints(tour_[point].joints_rad, speed_share_);
  if (!result.is_done()) {
    has_failed_ = true;
    place_.reset();
    throw ArmFailure{.text = outcome_text(result)};
  }
  place_ = TourPlace{.leg = point};
}

void ArmGuide::go_to_end(const std::function<void()>& before_each) {
  if (!tour_.back().is_safe) {
    back_out();
    return;
  }
  while (!is_at_end()) {
    before_each();
    normal_state();
    go(place_.value().is_point ? place_->leg + 1 : place_->ahead());
  }
}

void ArmGuide::go_to_safe_point(const std::function<void()>& before_each) {
  for (const std::size_t point : way_to_safe_point(tour_, place_.value())) {
    before_each();
    normal_state();
    go(point);
  }
}

bool ArmGuide::is_at_end() const {
  return place_ && place_->is_point && place_->leg + 1 == tour_.size();
}

void ArmGuide::back_out() {
  if (has_failed_) {
    throw ArmFailure{.text = "the arm was stopped before"};
  }
  normal_state();
  const StillPose pose = still(kSettleS);
  const std::size_t near = place_ ? place_->leg : last_point_;
  place_ = place_on(tour_, pose.joints_rad, near);
  if (!place_) {
    throw ArmFailure{.text = "the arm stands on no planned way", .is_off_tour = true};
  }
  for (const std::size_t point : way_back(tour_, *place_)) {
    normal_state();
    go(point);
  }
}

StillPose ArmGuide::still(double timeout_s) {
  const auto pose = robot_.still_pose(timeout_s);
  if (pose) {
    return *pose;
  }
  const RobotState state = fresh_state();
  if (const auto stop = robot_.halted()) {
    throw ArmFailure{.text = outcome_text(*stop)};
  }
  const std::string problem = readiness_problem(state);
  throw ArmFailure{.text = fmt::format("the arm does not stand still within {:.0f} s{}",
                                       timeout_s,
                                       problem.empty()
                                           ? ", or the pendant's TCP is no longer the cell's"
                                           : ": " + problem)};
}

StillPose ArmGuide::still_at_point(double timeout_s) {
  StillPose pose = still(timeout_s);
  const bool is_there =
      place_ && place_->is_point &&
      (pose.joints_rad - tour_[place_->leg].joints_rad).cwiseAbs().maxCoeff() <= kOnTourRad;
  if (!is_there) {
    has_failed_ = true;
    throw ArmFailure{.text = "the arm does not stand where it was sent: " +
                             joints_text(pose.joints_rad)};
  }
  return pose;
}

void ArmGuide::check_still(const StillPose& pose) const {
  const RobotState state = fresh_state();
  if (const auto stop = robot_.halted()) {
    throw ArmFailure{.text = outcome_text(*stop)};
  }
  if (!((state.actual_q_rad - pose.joints_rad).array().abs() <= kMovedRad).all()) {
    throw ArmFailure{.text = "the arm moved while a picture was taken"};
  }
  if (std::string problem = readiness_problem(state); !problem.empty()) {
    throw ArmFailure{.text = std::move(problem)};
  }
}

std::string ArmGuide::place() const {
  if (place_ && !has_failed_) {
    return place_text(tour_, *place_);
  }
  const auto state = robot_.state();
  if (!state) {
    return "not known";
  }
  const auto place = place_on(tour_, state->actual_q_rad, last_point_);
  return place ? place_text(tour_, *place) : joints_text(state->actual_q_rad);
}

}  // namespace glint

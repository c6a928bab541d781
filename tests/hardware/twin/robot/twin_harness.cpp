// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/hardware/twin/robot/twin_harness.h"

#include "tests/hardware/robot/cell_robot_settings.h"

namespace glint {

TwinSettings test_twin(ArmModel model) {
  const UrSettings robot = test_robot(model);
  return {.arm = Arm(model),
          .start_rad = test_start_rad(),
          .flange_from_tcp = pose_of_six(robot.flange_from_tcp),
          .payload_kg = robot.payload_kg,
          .payload_cog_mm = Eigen::Map<const Eigen::Vector3d>(robot.payload_cog_mm.data())};
}

Fault random_fault(Rng& rng) {
  const auto kind = rng.next_u32() % (kFaultNames.size() - 1);
  return {.kind = static_cast<FaultKind>(kind),
          .when = static_cast<Fault::When>(rng.next_u32() % 3),
          .delay_s = rng.uniform(0.0, 1.5)};
}

bool is_stop(MotionOutcome outcome) {
  using enum MotionOutcome;
  return outcome != kDone && outcome != kUnreachable && outcome != kRefused;
}

TwinHarness::TwinHarness(ArmModel model) : TwinHarness(test_twin(model)) {}

TwinHarness::TwinHarness(const TwinSettings& settings)
    : twin(settings),
      driver(test_robot(settings.arm.model()),
             arm_with_tool(test_robot(settings.arm.model()), test_limits())),
      session_(std::make_unique<RtdeSession>(twin, held_)) {
  driver.allow_motion(MotionPermit::from_command_line(true, "test"));
  run(0.1);
}

void TwinHarness::pass_to_driver(const std::string& bytes) {
  const std::size_t step = is_split_ ? 1 : std::max<std::size_t>(1, bytes.size());
  for (std::size_t at = 0; at < bytes.size(); at += step) {
    driver.on_rtde(std::string_view(bytes).substr(at, step), now_s_);
  }
}

void TwinHarness::cycle() {
  pass_scripts();
  pass_packages();
}

void TwinHarness::pass_scripts() {
  const std::string script = driver.take_script_output();
  scripts_ += script;
  if (is_linked_) {
    const std::string request = driver.take_rtde_output();
    requests_ += request;
    pass_to_driver(session_->on_bytes(request));
    LineSplitter lines;
    lines.append(script);
    while (const auto line = lines.next()) {
      if (const auto result = reader_.add_line(*line)) {
        twin.run(*result);
      }
    }
  }
}

void TwinHarness::pass_packages() {
  const double dt_s = 1.0 / twin.rate_hz();
  now_s_ += dt_s;
  twin.step(dt_s);
  look_for_fault();
  if (is_linked_) {
    pass_to_driver(session_->on_cycle());
    for (const PrimaryMessage& message : twin.take_messages()) {
      driver.on_primary(primary_frame(message));
    }
  }
  driver.on_time(now_s_);
}

void TwinHarness::look_for_fault() {
  for (const FaultKind fault : twin.take_network_faults()) {
    is_split_ = fault == FaultKind::kSplit || (is_split_ && fault != FaultKind::kRelease);
    if (fault == FaultKind::kCut || fault == FaultKind::kRestart) {
      is_linked_ = false;
      driver.on_rtde_closed("the connection was closed");
      driver.on_primary_closed("the connection was closed");
    }
    if (fault == FaultKind::kRestart) {
      twin.restart();
    }
  }
  if (!fault_at_s_ && twin.num_faults_applied() > 0) {
    fault_at_s_ = now_s_;
  }
}

void TwinHarness::run(double duration_s) {
  const double until_s = now_s_ + duration_s;
  while (now_s_ < until_s) {
    cycle();
  }
}

void TwinHarness::run_without_scripts(double duration_s) {
  const double until_s = now_s_ + duration_s;
  while (now_s_ < until_s) {
    pass_packages();
  }
}

std::optional<MotionResult> TwinHarness::finish(const CheckedMotion& motion) {
  if (auto refusal = driver.begin(motion, now_s_)) {
    return refusal;
  }
  const double until_s = now_s_ + 60.0;
  while (!driver.result() && now_s_ < until_s) {
    cycle();
  }
  if (!leaves_programs_ && driver.may_hold_program()) {
    twin.reply("stop");  // as drop_program() does over the network
    driver.on_program_dropped("");
  }
  return driver.result();
}

std::optional<MotionResult> TwinHarness::move(const JointVector& goal_rad, double share) {
  const JointVector start_rad = driver.state(now_s_)->actual_q_rad;
  return finish(check_joint_motion(driver.arm(), start_rad, goal_rad, share));
}

std::optional<MotionResult> TwinHarness::move_line(const Eigen::Isometry3d& base_from_tcp,
                                                   double share) {
  const JointVector start_rad = driver.state(now_s_)->actual_q_rad;
  return finish(check_line_motion(driver.arm(), start_rad, base_from_tcp, share));
}

double TwinHarness::motion_rad(double duration_s) {
  double sum_rad = 0.0;
  const double until_s = now_s_ + duration_s;
  while (now_s_ < until_s) {
    const JointVector before_rad = twin.view().joints_rad;
    cycle();
    sum_rad += (twin.view().joints_rad - before_rad).cwiseAbs().sum();
  }
  return sum_rad;
}

}  // namespace glint

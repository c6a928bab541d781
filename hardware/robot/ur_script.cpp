// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/ur_script.h"

#include <fmt/format.h>

namespace glint {
namespace {

constexpr double kMPerMm = 1e-3;

std::string six_text(const JointVector& six) {
  return fmt::format("[{:.12g}, {:.12g}, {:.12g}, {:.12g}, {:.12g}, {:.12g}]",
                     six[0],
                     six[1],
                     six[2],
                     six[3],
                     six[4],
                     six[5]);
}

std::string move_text(const CheckedMotion& motion) {
  if (motion.kind == CheckedMotion::Kind::kJoints) {
    return fmt::format("movej({}, a={:.6g}, v={:.6g})",
                       six_text(motion.goal_rad),
                       motion.acceleration,
                       motion.speed);
  }
  JointVector six = pose_difference(motion.base_from_tcp, Eigen::Isometry3d::Identity());
  six.head<3>() *= kMPerMm;
  return fmt::format("movel(p{}, a={:.6g}, v={:.6g})",
                     six_text(six),
                     motion.acceleration * kMPerMm,
                     motion.speed * kMPerMm);
}

}  // namespace

ScriptAck ScriptAck::after(std::int32_t held) {
  constexpr std::int32_t kMax = 1000000;
  const std::int32_t begun = held < 0 || held >= kMax - 3 ? 1 : held + 1;
  return {.begun = begun, .beat = begun + 1, .ended = begun + 2};
}

std::string motion_script(const CheckedMotion& motion, int ack_register, const ScriptAck& ack) {
  return fmt::format(
      "def glint_motion():\n"
      "  thread glint_beat():\n"
      "    while True:\n"
      "      write_output_integer_register({0}, {2})\n"
      "      sleep(0.02)\n"
      "      write_output_integer_register({0}, {1})\n"
      "      sleep(0.02)\n"
      "    end\n"
      "  end\n"
      "  write_output_integer_register({0}, {1})\n"
      "  glint_beats = run glint_beat()\n"
      "  {3}\n"
      "  kill glint_beats\n"
      "  write_output_integer_register({0}, {4})\n"
      "end\n",
      ack_register,
      ack.begun,
      ack.beat,
      move_text(motion),
      ack.ended);
}

std::string stop_script(double joint_deceleration_rad_s2) {
  return fmt::format("def glint_stop():\n  stopj({:.6g})\nend\n", joint_deceleration_rad_s2);
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/ur_script.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "hardware/robot/motion_permit.h"

namespace glint {
namespace {

TEST(MotionScript, FramesTheMotionByItsAcknowledgements) {
  CheckedMotion motion;
  motion.goal_rad = JointVector{0.5, -1.0, 1.25, 0.0, 0.0, 2.0};
  motion.speed = 0.25;
  motion.acceleration = 1.5;
  EXPECT_EQ(motion_script(motion, 3, {.begun = 7, .beat = 8, .ended = 9}),
            "def glint_motion():\n"
            "  thread glint_beat():\n"
            "    while True:\n"
            "      write_output_integer_register(3, 8)\n"
            "      sleep(0.02)\n"
            "      write_output_integer_register(3, 7)\n"
            "      sleep(0.02)\n"
            "    end\n"
            "  end\n"
            "  write_output_integer_register(3, 7)\n"
            "  glint_beats = run glint_beat()\n"
            "  movej([0.5, -1, 1.25, 0, 0, 2], a=1.5, v=0.25)\n"
            "  kill glint_beats\n"
            "  write_output_integer_register(3, 9)\n"
            "end\n");
}

// 100 mm are 0.1 m, 250 mm/s are 0.25 m/s.
TEST(MotionScript, GivesLinesInMetres) {
  CheckedMotion motion = {.kind = CheckedMotion::Kind::kLine};
  motion.base_from_tcp.translation() = Eigen::Vector3d(100.0, -200.0, 300.0);
  motion.speed = 250.0;
  motion.acceleration = 500.0;
  EXPECT_THAT(motion_script(motion, 0, {.begun = 1, .beat = 2, .ended = 3}),
              testing::HasSubstr("movel(p[0.1, -0.2, 0.3, 0, 0, 0], a=0.5, v=0.25)"));
}

TEST(ScriptAck, DiffersFromWhatTheRegisterHeld) {
  for (const int held : {-5, 0, 1, 2, 77, 999997, 999998, 1000000, 2147483647}) {
    const ScriptAck ack = ScriptAck::after(held);
    EXPECT_FALSE(ack.is_of_program(held));
    EXPECT_EQ(ack.beat, ack.begun + 1);
    EXPECT_EQ(ack.ended, ack.beat + 1);
    EXPECT_GT(ack.begun, 0);
    EXPECT_LE(ack.ended, 1000000);
  }
}

TEST(MotionPermit, IsGivenByTypingAlone) {
  EXPECT_THROW(MotionPermit::from_command_line(false, "cell move"), ConfigError);
  EXPECT_NO_THROW(MotionPermit::from_command_line(true, "cell move"));
}

}  // namespace
}  // namespace glint

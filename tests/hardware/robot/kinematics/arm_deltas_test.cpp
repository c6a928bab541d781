// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/robot/kinematics/arm_deltas.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

constexpr const char* kFile = R"([arm_deltas]
model = "ur3e"
serial_number = "20195300001"
delta_theta_rad = [1e-3, 0, 0, 0, 0, 0]
delta_d_mm = [0, 210, -210.3, 0, 0, 0]
)";

TEST(ArmDeltas, AreAddedToTheNominalTable) {
  const ArmDeltas deltas = parse_arm_deltas(kFile, "arm.toml");
  const DhTable table = calibrated_table(ArmModel::kUr3e, deltas);
  EXPECT_EQ(table[0].theta_rad, 1e-3);
  EXPECT_EQ(table[0].d_mm, 151.85);
  EXPECT_EQ(table[1].d_mm, 210.0);
  EXPECT_EQ(table[2].d_mm, -210.3);
  EXPECT_EQ(table[2].a_mm, -213.2);
  EXPECT_FALSE(deltas.is_zero());
}

TEST(ArmDeltas, SlipsAreRefusedWithTheirPlace) {
  const auto text_of = [](const std::string& text) {
    return text_thrown_by<ConfigError>([&] { parse_arm_deltas(text, "arm.toml"); });
  };
  EXPECT_THAT(text_of("model = \"ur3\"\n"), testing::HasSubstr("[arm_deltas]"));
  EXPECT_THAT(text_of("[arm_deltas]\ndelta_a_mm = [1, 2, 3]\nmodel = \"ur3\"\n"),
              testing::HasSubstr("arm.toml:2:1: arm_deltas.delta_a_mm"));
  EXPECT_THAT(text_of("[arm_deltas]\ndelta_a_mm = [0, 0, 0, 0, 0, 0]\n"),
              testing::HasSubstr("ur3, ur3e or ur5e"));
  EXPECT_THAT(text_of("[arm_deltas]\nmodel = \"ur3\"\ndelta_theta_rad = [0, 0, 0, 1, 0, 0]\n"),
              testing::HasSubstr("delta_theta_rad"));
}

}  // namespace
}  // namespace glint

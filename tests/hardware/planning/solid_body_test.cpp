// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/solid_body.h"

#include <gtest/gtest.h>

#include "hardware/robot/kinematics/link_shapes.h"
#include "simulator/geometry/mesh/winding_number.h"
#include "tests/hardware/robot/cell_robot_settings.h"
#include "tests/hardware/robot/kinematics/arm_poses.h"

namespace glint {
namespace {

/// Largest distance of a capsule's end from where arm_shape() has it, over random joints.
double worst_mm(const ArmWithTool& arm) {
  const std::vector<SolidBody> bodies = arm_bodies(arm);
  double worst = 0.0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    const JointVector joints_rad = random_joints(i);
    const ArmShape shape = arm_shape(arm.arm, joints_rad, arm.flange_from_tcp, arm.tool_radius_mm);
    const LinkFrames frames = arm.arm.frames(joints_rad);
    for (std::size_t k = 0; k < shape.size(); ++k) {
      const SolidBody& body = bodies[k + 1];
      const Eigen::Isometry3d& pose = frames[static_cast<std::size_t>(body.link)];
      worst = std::max({worst,
                        (pose * body.mesh.vertices_mm[0] - shape[k].from_mm).norm(),
                        (pose * body.mesh.vertices_mm[1] - shape[k].to_mm).norm()});
    }
  }
  return worst;
}

TEST(ArmBodies, MoveWithTheLinksAsArmShapeHasThem) {
  for (const ArmModel model : {ArmModel::kUr3, ArmModel::kUr3e, ArmModel::kUr5e}) {
    ArmWithTool arm = arm_with_tool(test_robot(model), test_limits());
    EXPECT_LT(worst_mm(arm), 1e-6);
    arm.arm = Arm(model, typical_deltas(model));
    EXPECT_LT(worst_mm(arm), 1.0) << "capsules are rounded up by more than that";
  }
}

TEST(BoxMesh, IsClosedAndTurnsOutwards) {
  const TriangleMesh mesh = box_mesh({1.0, 2.0, 3.0}, {4.0, 5.0, 6.0});
  EXPECT_NEAR(enclosed_volume_mm3(mesh), 120.0, 1e-12);
  EXPECT_NEAR(winding_number(mesh, {1.5, 2.5, 3.5}), 1.0, 1e-12);
  EXPECT_NEAR(winding_number(mesh, {4.0, 2.0, 3.0}), 0.0, 1e-12);
}

TEST(HullOf, EnclosesAllVertices) {
  TriangleMesh mesh = box_mesh({0.0, 0.0, 0.0}, {2.0, 2.0, 2.0});
  EXPECT_EQ(hull_of(mesh).size(), 8U);
  mesh.vertices_mm.emplace_back(5.0, 0.0, 0.0);
  const std::vector<Eigen::Vector3d> hull = hull_of(mesh);
  ASSERT_EQ(hull.size(), 8U);
  EXPECT_DOUBLE_EQ(hull[1].x(), 5.0);
}

}  // namespace
}  // namespace glint

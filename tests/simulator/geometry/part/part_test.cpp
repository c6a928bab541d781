// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/part/part.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/config/config.h"
#include "core/config/toml.h"
#include "core/error.h"
#include "core/units.h"
#include "simulator/geometry/mesh_file/mesh_write.h"
#include "tests/simulator/geometry/geometry_fixtures.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

struct ReadPart {
  PartSettings settings;
  std::vector<Problem> errors;
};

ReadPart read_settings(const std::string& toml) {
  ReadPart read;
  const ConfigNode root = parse_toml(toml, "study.toml");
  KeyReader reader(&root, "part", read.errors);
  visit_keys(reader, read.settings);
  reader.report_unknown();
  return read;
}

TEST(PartSettings, AreReadFromTheirKeys) {
  const ReadPart read = read_settings(
      "shape = \"spur_gear\"\ncrease_deg = 45\nposition_mm = [1, 2, 3]\nrotation_deg = [0, 0, 90]\n"
      "origin = \"file\"\n[gear]\nteeth = 24\nmodule_mm = 1.5\npressure_angle_deg = 25\n");
  EXPECT_THAT(read.errors, IsEmpty());
  EXPECT_EQ(read.settings.shape, PartSettings::Shape::kSpurGear);
  EXPECT_EQ(read.settings.origin, PartSettings::Origin::kFile);
  EXPECT_EQ(read.settings.gear.teeth, 24);
  EXPECT_DOUBLE_EQ(read.settings.gear.pressure_angle_rad, 25.0 * kRadPerDeg);
  EXPECT_DOUBLE_EQ(read.settings.crease_rad, kPi / 4.0);
  EXPECT_DOUBLE_EQ(read.settings.rotation_rad[2], kPi / 2.0);
}

TEST(PartSettings, AFileMakesThePartAMesh) {
  EXPECT_EQ(read_settings("file = \"a.stl\"\n").settings.shape, PartSettings::Shape::kMesh);
  EXPECT_EQ(read_settings("shape = \"strip\"\nfile = \"a.stl\"\n").settings.shape,
            PartSettings::Shape::kMesh);
}

TEST(PartSettings, ReportWrongCombinationsByKey) {
  EXPECT_THAT(messages_of(read_settings("shape = \"mesh\"\n").errors),
              ElementsAre(HasSubstr("part.file")));
  EXPECT_THAT(messages_of(read_settings("radius_across_mm = 20\n").errors),
              ElementsAre(HasSubstr("part.radius_across_mm")));
  EXPECT_THAT(messages_of(read_settings("shape = \"sphere_cap\"\nheight_mm = 60\n").errors),
              ElementsAre(HasSubstr("part.height_mm")));
  EXPECT_THAT(messages_of(read_settings("shape = \"spur_gear\"\ngear.bore_mm = 60\n").errors),
              ElementsAre(HasSubstr("part.gear.bore_mm")));
  EXPECT_THAT(messages_of(read_settings("expected_size_mm = [1, 2]\n").errors),
              ElementsAre(HasSubstr("part.expected_size_mm")));
  EXPECT_THAT(messages_of(read_settings("unit = \"mile\"\n").errors),
              ElementsAre(HasSubstr("part.unit")));
}

// Rz(90) Ry(0) Rx(90): first x: (0, 1, 0) -> (0, 0, 1), which z leaves; (1, 0, 0) -> (0, 1, 0).
TEST(PoseFromAngles, TurnsAboutFixedXThenYThenZ) {
  const RigidTransform pose = pose_from_angles({1, 2, 3}, {kPi / 2.0, 0.0, kPi / 2.0});
  EXPECT_LT((pose * Vector3d(0, 1, 0) - Vector3d(1, 2, 4)).norm(), 1e-15);
  EXPECT_LT((pose * Vector3d(1, 0, 0) - Vector3d(1, 3, 3)).norm(), 1e-15);
  const RigidTransform second = pose_from_angles({0, 0, 0}, {0.0, kPi / 2.0, kPi / 2.0});
  EXPECT_LT((second * Vector3d(0, 0, 1) - Vector3d(0, 1, 0)).norm(), 1e-15);
}

TEST(BuildPart, MovesMeshAndPatchesTogether) {
  PartSettings settings;
  settings.position_mm = {10, -20, 30};
  settings.rotation_rad = {0.3, -0.4, 0.5};
  const Part moved = build_part(settings);
  const Part rest = build_part({});
  EXPECT_EQ(moved.box_in_part_mm.size_mm(), rest.box_in_part_mm.size_mm());
  for (std::size_t i = 0; i < moved.mesh.num_triangles(); ++i) {
    const ExactPatch& patch = moved.patches[static_cast<std::size_t>(moved.mesh.patch[i])];
    Vector3d gradient;
    ASSERT_NEAR(implicit_value(patch, moved.mesh.vertex(i, 0), &gradient), 0.0, 1e-11);
    ASSERT_LT((gradient.normalized() - moved.mesh.normal(i, 0)).norm(), 1e-12);
    ASSERT_LT((moved.scene_from_part * rest.mesh.vertex(i, 1) - moved.mesh.vertex(i, 1)).norm(),
              1e-11);
  }
}

/// A cube of that edge length in a file, as a [part].
PartSettings cube_file(const TemporaryFolder& folder, double edge) {
  write_mesh(folder / "cube.stl", cube_mesh(0.5 * edge));
  PartSettings settings;
  settings.shape = PartSettings::Shape::kMesh;
  settings.file = folder / "cube.stl";
  return settings;
}

std::string refusal_of(const PartSettings& settings) {
  return text_thrown_by<ConfigError>([&] { build_part(settings); });
}

TEST(BuildPart, ReadsAMeshInItsUnitAndCentresIt) {
  const TemporaryFolder folder;
  TriangleMesh cube = cube_mesh(1.0);
  transform(cube, {.translation_mm = Vector3d(7, 8, 9)});
  write_mesh(folder / "c.ply", cube);
  PartSettings settings;
  settings.shape = PartSettings::Shape::kMesh;
  settings.file = folder / "c.ply";
  settings.unit = PartSettings::Unit::kInch;
  Part part = build_part(settings);
  EXPECT_NEAR(part.box_in_part_mm.size_mm().x(), 50.8, 1e-12);
  EXPECT_LT(part.box_in_part_mm.centre_mm().norm(), 1e-12);
  EXPECT_EQ(part.name, "c.ply");
  EXPECT_EQ(part.mesh.normals.size(), 24U);  // the cube's edges stay sharp
  EXPECT_TRUE(part.patches.empty());
  settings.origin = PartSettings::Origin::kFile;
  part = build_part(settings);
  EXPECT_LT((part.box_in_part_mm.centre_mm() - 25.4 * Vector3d(7, 8, 9)).norm(), 1e-12);
}

TEST(BuildPart, AsksForTheUnitOfAnImplausibleSize) {
  const TemporaryFolder folder;
  EXPECT_THAT(refusal_of(cube_file(folder, 0.2)),
              AllOf(HasSubstr("part.unit"),
                    HasSubstr("0.2 mm large: is the file in m? The unit \"m\" makes it 200 mm")));
  PartSettings in_metres = cube_file(folder, 40.0);
  in_metres.unit = PartSettings::Unit::kMetre;
  EXPECT_THAT(refusal_of(in_metres), HasSubstr("4e+04 mm large: is the file in mm?"));
  EXPECT_THAT(refusal_of(cube_file(folder, 1e6)), HasSubstr("allowed: 1 to 5000 mm"));
}

TEST(BuildPart, RefusesHugeShapesBeforeBuildingThem) {
  PartSettings settings;
  settings.length_mm = 1e12;
  settings.radius_along_mm = 0.0;
  EXPECT_THAT(refusal_of(settings), HasSubstr("allowed: 1 to 5000 mm"));
  settings = {.shape = PartSettings::Shape::kCylinder, .radius_mm = 1e9};
  EXPECT_THAT(refusal_of(settings), HasSubstr("part.shape"));
}

TEST(BuildPart, ChecksTheExpectedSize) {
  const TemporaryFolder folder;
  PartSettings settings = cube_file(folder, 20.0);
  settings.expected_size_mm = {20.1, 20.0, 19.9};
  EXPECT_NO_THROW(build_part(settings));
  settings.expected_size_mm = {20.0, 20.0, 25.0};
  EXPECT_THAT(refusal_of(settings), HasSubstr("part.expected_size_mm"));
}

TEST(BuildPart, AcceptsAnOpenMesh) {
  const TemporaryFolder folder;
  TriangleMesh cube = cube_mesh(5.0);
  cube.triangles.pop_back();
  write_mesh(folder / "open.obj", cube);
  PartSettings settings;
  settings.shape = PartSettings::Shape::kMesh;
  settings.file = folder / "open.obj";
  EXPECT_EQ(build_part(settings).mesh.num_triangles(), 11U);
}

TEST(BuildPart, RefusesAMeshShapeWithoutFile) {
  EXPECT_THAT(refusal_of({.shape = PartSettings::Shape::kMesh}), HasSubstr("part.file"));
}

}  // namespace
}  // namespace glint

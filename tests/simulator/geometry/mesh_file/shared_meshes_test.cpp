// SPDX-License-Identifier: GPL-3.0-or-later
//
// Real part meshes made by nobody here; counts are those of the README beside them.
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/units.h"
#include "simulator/geometry/mesh_file/mesh_io.h"
#include "simulator/geometry/part/mesh_report.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Unit = PartSettings::Unit;

struct SharedMesh {
  const char* name;
  std::size_t triangles;
  double largest_size;  ///< in file units
  bool is_watertight;
  Unit unit;
};

constexpr SharedMesh kSharedMeshes[] = {
    {"moveo_servo_gear.stl", 56688, 58.9, false, Unit::kMillimetre},
    {"moveo_pivot_arm.stl", 15008, 48.0, false, Unit::kMillimetre},
    {"moveo_t3m1c.stl", 4016, 31.5, true, Unit::kMillimetre},
    {"odri_pulley_at3_t30_output.stl", 19054, 29.0, true, Unit::kMillimetre},
    {"odri_foot_structure.stl", 14676, 100.0, false, Unit::kMillimetre},
    {"fandisk.obj", 12946, 5.25, true, Unit::kCentimetre},
    {"rocker-arm.obj", 20088, 1.0, true, Unit::kMetre},
    {"stanford-bunny.obj", 69451, 0.156, false, Unit::kMetre}};

std::filesystem::path mesh_folder() {
  return std::filesystem::path(GLINT_SHARED_DIR) / "data" / "meshes";
}

TEST(SharedMeshes, AllReadWithTheirCountsAndSizes) {
  if (!std::filesystem::exists(mesh_folder())) {
    GTEST_SKIP() << "the folder of shared meshes is absent";
  }
  for (const SharedMesh& expected : kSharedMeshes) {
    SCOPED_TRACE(expected.name);
    PartSettings settings;
    settings.shape = PartSettings::Shape::kMesh;
    settings.file = mesh_folder() / expected.name;
    settings.unit = expected.unit;
    const Part part = build_part(settings);
    const MeshReport r = report(part, 5e-3, settings.crease_rad);
    EXPECT_EQ(r.num_triangles, expected.triangles);
    EXPECT_EQ(r.is_watertight, expected.is_watertight);
    EXPECT_NEAR(r.size_mm.maxCoeff() / mm_per_unit(expected.unit),
                expected.largest_size,
                0.005 * expected.largest_size);
    EXPECT_FALSE(r.is_fine_enough);  // CAD exports are far too coarse for fringes
    EXPECT_NE(r.action, "");
  }
}

TEST(SharedMeshes, InTheWrongUnitAreRefused) {
  if (!std::filesystem::exists(mesh_folder())) {
    GTEST_SKIP() << "the folder of shared meshes is absent";
  }
  PartSettings settings;
  settings.shape = PartSettings::Shape::kMesh;
  settings.file = mesh_folder() / "stanford-bunny.obj";
  EXPECT_THAT(text_thrown_by<ConfigError>([&] { build_part(settings); }),
              ::testing::HasSubstr("is the file in m? The unit \"m\""));
}

}  // namespace
}  // namespace glint

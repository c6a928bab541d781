// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/part/defect_files.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "core/rng.h"
#include "simulator/geometry/mesh_file/mesh_io.h"
#include "simulator/geometry/mesh_file/mesh_write.h"
#include "tests/simulator/geometry/geometry_fixtures.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

struct LabelledMesh {
  TriangleMesh mesh;
  std::vector<std::int32_t> labels;  ///< one a face
};

LabelledMesh read_labelled_ply(const std::filesystem::path& path) {
  LabelledMesh result;
  result.mesh = read_ply_with_values(path, "defect_id", result.labels);
  return result;
}

/// 334 separate triangles with random corners and ids, 1002 vertices.
LabelledMesh random_labelled_mesh() {
  LabelledMesh part;
  Rng rng(5, Stream::kTest, 0);
  for (int i = 0; i < 334; ++i) {
    for (int k = 0; k < 3; ++k) {
      part.mesh.vertices_mm.push_back(random_point(rng, 1e3));
    }
    part.mesh.triangles.push_back({3 * i, 3 * i + 2, 3 * i + 1});
    part.labels.push_back(static_cast<std::int32_t>(rng.next_u32() >> 1));
  }
  return part;
}

TEST(WriteLabelledPly, ReadsBackBitForBit) {
  const TemporaryFolder folder;
  const LabelledMesh part = random_labelled_mesh();
  write_labelled_ply(folder / "a.ply", part.mesh, part.labels);
  const LabelledMesh back = read_labelled_ply(folder / "a.ply");
  EXPECT_EQ(back.mesh.vertices_mm, part.mesh.vertices_mm);
  EXPECT_EQ(back.mesh.triangles, part.mesh.triangles);
  EXPECT_EQ(back.labels, part.labels);
  EXPECT_EQ(folder.count(), 1);
}

// 3 doubles a vertex; 1 + 3 * 4 + 4 bytes a face.
TEST(WriteLabelledPly, HoldsDoublesAndOneIntAFace) {
  const TemporaryFolder folder;
  const TriangleMesh cube = cube_mesh(1.0);
  write_labelled_ply(folder / "a.ply", cube, std::vector<std::int32_t>(12, 7));
  const std::string bytes = read_file(folder / "a.ply");
  const std::size_t head = bytes.find("end_header\n") + 11;
  EXPECT_EQ(bytes.size() - head, 8U * 24U + 12U * 17U);
  EXPECT_THAT(bytes.substr(0, head), HasSubstr("property double z\n"));
  EXPECT_THAT(bytes.substr(0, head), HasSubstr("property int defect_id\n"));
  EXPECT_EQ(bytes[bytes.size() - 4], 7);
  EXPECT_EQ(read_mesh(folder / "a.ply").num_triangles(), 12U);
}

TEST(ReadPlyWithValues, GivesAPolygonsIdToAllItsTriangles) {
  const TemporaryFolder folder;
  write_file(folder / "a.ply",
             "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
             "property float z\nelement face 2\nproperty uchar red\n"
             "property list uchar int vertex_indices\nproperty short defect_id\nend_header\n"
             "0 0 0\n1 0 0\n1 1 0\n0 1 0\n255 4 0 1 2 3 5\n0 3 0 1 2 -1\n");
  EXPECT_THAT(read_labelled_ply(folder / "a.ply").labels, ::testing::ElementsAre(5, 5, -1));
}

TEST(ReadPlyWithValues, SaysWhatIsMissing) {
  const TemporaryFolder folder;
  write_mesh(folder / "plain.ply", cube_mesh(1.0));
  write_mesh(folder / "no.off", cube_mesh(1.0));
  write_labelled_ply(folder / "cut.ply", cube_mesh(1.0), std::vector<std::int32_t>(12, 7));
  const std::string whole = read_file(folder / "cut.ply");
  write_file(folder / "cut.ply", std::string_view(whole).substr(0, whole.size() - 2));
  EXPECT_THAT([&] { read_labelled_ply(folder / "plain.ply"); },
              ThrowsMessage<ConfigError>(HasSubstr("no defect_id")));
  EXPECT_THAT([&] { read_labelled_ply(folder / "no.off"); },
              ThrowsMessage<ConfigError>(HasSubstr("does not begin")));
  EXPECT_THAT([&] { read_labelled_ply(folder / "cut.ply"); },
              ThrowsMessage<ConfigError>(HasSubstr("ends in the middle of face 11")));
  EXPECT_THROW(read_labelled_ply(folder / "none.ply"), IoError);
}

TEST(WriteDefectMap, DefectsAreWhiteAndTheRestIsBlack) {
  const TemporaryFolder folder;
  std::vector<std::int32_t> labels(12, 0);
  labels[3] = 1;
  labels[4] = 2;
  write_defect_map(folder / "map.obj", cube_mesh(0.1), labels);
  const std::string obj = read_file(folder / "map.obj");
  EXPECT_THAT(obj, HasSubstr("mtllib map.mtl\nv -0.1 -0.1 -0.1\n"));
  // Faces 0 to 2 black, 3 and 4 white, the other seven black.
  EXPECT_THAT(obj, HasSubstr("usemtl part\nf 1 3 4\nf 1 4 2\nf 5 6 8\nusemtl defect\nf 5 8 7\n"));
  EXPECT_THAT(obj, HasSubstr("f 1 2 6\nusemtl part\nf 1 6 5\n"));
  EXPECT_EQ(std::ranges::count(obj, 'u'), 4);  // three usemtl, and "unit"
  const std::string mtl = read_file(folder / "map.mtl");
  EXPECT_THAT(mtl, HasSubstr("newmtl part\nKa 0 0 0\nKd 0 0 0\n"));
  EXPECT_THAT(mtl, HasSubstr("newmtl defect\nKa 1 1 1\nKd 1 1 1\n"));
  const TriangleMesh back = read_mesh(folder / "map.obj");
  EXPECT_EQ(back.vertices_mm, cube_mesh(0.1).vertices_mm);
  EXPECT_EQ(back.triangles, cube_mesh(0.1).triangles);
}

TEST(WriteStl, TellsNothingWhenFloatIsEnough) {
  const TemporaryFolder folder;
  const FloatLoss loss = write_stl(folder / "a.stl", cube_mesh(1.0 / 3.0));
  EXPECT_TRUE(loss.none());
  EXPECT_EQ(loss.warning(), "");
  EXPECT_EQ(std::filesystem::file_size(folder / "a.stl"), 84U + 12U * 50U);
}

// At 1e5 mm neighbouring floats are 2^-7 mm apart: a cube of 2 um becomes a point, 7 of its 8
// vertices fall onto the first.
TEST(WriteStl, WarnsWhenAPartIsTooFarFromTheOrigin) {
  const TemporaryFolder folder;
  TriangleMesh far = cube_mesh(1e-3);
  transform(far, {.translation_mm = Vector3d::Constant(1e5)});
  const FloatLoss loss = write_stl(folder / "a.stl", far);
  EXPECT_EQ(loss.merged_vertices, 7);
  EXPECT_EQ(loss.collapsed_faces, 12);
  EXPECT_THAT(loss.warning(), HasSubstr("7 vertices fall together and 12 triangles"));
}

TEST(WriteStl, EqualVerticesAreNoLoss) {
  TriangleMesh twice = cube_mesh(1.0);
  const std::vector<Vector3d> once = twice.vertices_mm;
  twice.vertices_mm.insert(twice.vertices_mm.end(), once.begin(), once.end());
  EXPECT_TRUE(float_loss(twice).none());
}

TEST(DefectFiles, LeaveNothingBehindWhenTheyCannotBeWritten) {
  const TriangleMesh cube = cube_mesh(1.0);
  const std::vector<std::int32_t> labels(12, 0);
  EXPECT_THROW(write_stl("/nonexistent/a.stl", cube), IoError);
  EXPECT_THROW(write_labelled_ply("/nonexistent/a.ply", cube, labels), IoError);
  EXPECT_THROW(write_defect_map("/nonexistent/a.obj", cube, labels), IoError);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/mesh_file/mesh_io.h"

#include <array>
#include <bit>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/file.h"
#include "simulator/geometry/mesh_file/mesh_write.h"
#include "tests/simulator/geometry/geometry_fixtures.h"
#include "tests/support/temporary_folder.h"

namespace glint {
namespace {

using Eigen::Vector3d;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// A mesh whose coordinates need all digits of a double.
TriangleMesh odd_mesh() {
  TriangleMesh mesh = cube_mesh(1.0 / 3.0);
  transform(mesh, {.translation_mm = Vector3d(0.1, -1e-7, 12345.678901234567)});
  return mesh;
}

TEST(WriteMesh, RoundTripsExactlyInDoubleFormats) {
  const TemporaryFolder folder;
  for (const char* name : {"a.ply", "a.obj", "a.off"}) {
    SCOPED_TRACE(name);
    write_mesh(folder / name, odd_mesh());
    const TriangleMesh mesh = read_mesh(folder / name);
    EXPECT_EQ(mesh.vertices_mm, odd_mesh().vertices_mm);
    EXPECT_EQ(mesh.triangles, odd_mesh().triangles);
  }
  EXPECT_EQ(folder.count(), 3);
}

TEST(WriteMesh, RoundTripsThroughBinaryStlInFloat) {
  const TemporaryFolder folder;
  write_mesh(folder / "a.stl", cube_mesh(1.0 / 3.0));
  EXPECT_EQ(std::filesystem::file_size(folder / "a.stl"), 84U + 12U * 50U);
  const TriangleMesh mesh = read_mesh(folder / "a.stl");
  EXPECT_EQ(mesh.vertices_mm.size(), 8U);
  EXPECT_EQ(mesh.num_triangles(), 12U);
  EXPECT_NEAR(enclosed_volume_mm3(mesh), 8.0 / 27.0, 1e-7);
}

TEST(WriteMesh, RefusesAnUnknownExtension) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { write_mesh(folder / "a.step", cube_mesh(1.0)); },
              ThrowsMessage<ConfigError>(HasSubstr("allowed: .stl, .ply, .obj, .off")));
  EXPECT_EQ(folder.count(), 0);
}

TEST(WriteMesh, LeavesNothingBehindOnAFullDisk) {
  const TemporaryFolder folder;
  fill_disk_under(folder / "a.ply");
  EXPECT_THROW(write_mesh(folder / "a.ply", cube_mesh(1.0)), IoError);
  EXPECT_EQ(folder.count(), 0);
}

TEST(ReadMesh, NamesAMissingFile) {
  EXPECT_THAT([] { read_mesh("no/such/part.stl"); },
              ThrowsMessage<IoError>(HasSubstr("no/such/part.stl")));
}

constexpr const char* kAsciiStl =
    "solid two facets\n"
    " facet normal 0 0 1\n  outer loop\n"
    "   vertex 0 0 0\n   vertex 1e0 0 0\n   vertex 0 +1 0\n  endloop\n endfacet\n"
    " FACET NORMAL nan nan nan\n  OUTER LOOP\n"
    "   VERTEX 1 0 0\n   VERTEX 1.0 1.0 0\n   VERTEX 0 1 0\n  ENDLOOP\n ENDFACET\n"
    "endsolid two facets\n";

TEST(ParseMesh, ReadsAsciiStlAndWeldsIt) {
  const TriangleMesh mesh = parse_mesh(kAsciiStl, "a.stl");
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}));
  EXPECT_DOUBLE_EQ(surface_area_mm2(mesh), 1.0);
}

TEST(ParseMesh, TellsABinaryStlByItsSizeEvenIfItBeginsWithSolid) {
  std::string bytes = "solid but binary\nfacet";
  bytes.resize(80, ' ');
  bytes.append("\1\0\0\0", 4).append(12, '\0');
  for (const float value : {0.F, 0.F, 0.F, 2.F, 0.F, 0.F, 0.F, 2.F, 0.F}) {
    const auto raw = std::bit_cast<std::array<char, 4>>(value);
    bytes.append(raw.data(), 4);
  }
  bytes.append(2, '\0');
  EXPECT_DOUBLE_EQ(surface_area_mm2(parse_mesh(bytes, "x")), 2.0);
}

TEST(ParseMesh, CutsObjPolygonsIntoFansAndCountsBackwards) {
  const TriangleMesh mesh = parse_mesh(
      "# a square and a triangle\nmtllib x.mtl\nv 0 0 0\nv 1 0 0 1.0\nv 1 1 0\nv 0 1 0\n"
      "vt 0 0\nvn 0 0 1\nusemtl steel\nf 1/1/1 2//1 3/1 \\\n 4\nv 2 0 0\nf -1 3 -4\n",
      "part.obj");
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{4, 2, 1}));
}

TEST(ParseMesh, ReadsAnObjFaceThatComesBeforeItsVertices) {
  EXPECT_EQ(parse_mesh("f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n", "a.obj").num_triangles(), 1U);
}

TEST(ParseMesh, ReadsOffWithCommentsColoursAndAnyName) {
  const TriangleMesh mesh = parse_mesh(
      "OFF # head\n# counts\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\n", "noname");
  EXPECT_EQ(mesh.num_triangles(), 2U);
  const TriangleMesh coloured =
      parse_mesh("COFF\n3 1 0\n0 0 0 1 1 1 1\n1 0 0 1 1 1 1\n0 1 0 1 1 1 1\n3 0 1 2\n", "a.off");
  EXPECT_EQ(coloured.num_triangles(), 1U);
}

// A model of ViSP's trackers: points, lines that are read over, faces by points with a name behind.
TEST(ParseMesh, ReadsCaoModels) {
  const TriangleMesh mesh = parse_mesh(
      "# a roof\nV1\n4 # points\n0 0 0\n1 0 0 # second\n1 1 0\n0 1 0.5\n"
      "1\n0 1\n0\n2\n4 0 1 2 3 name=\"floor\" minPolygonAreaThreshold=5\n3 0 2 3\n0\n0\n",
      "roof.cao");
  EXPECT_EQ(mesh.vertices_mm.size(), 4U);
  EXPECT_EQ(mesh.triangles.size(), 3U);
  EXPECT_EQ(mesh.vertices_mm[3], Eigen::Vector3d(0, 1, 0.5));
}

TEST(ParseMesh, ReadsAsciiPlyWithOtherElementsAndProperties) {
  const TriangleMesh mesh = parse_mesh(
      "ply\r\nformat ascii 1.0\r\ncomment x\r\nelement vertex 4\r\nproperty float x\r\n"
      "property float y\r\nproperty float z\r\nproperty uchar red\r\n"
      "element camera 1\r\nproperty list uchar float view\r\n"
      "element face 1\r\nproperty uchar flags\r\nproperty list uchar int vertex_index\r\n"
      "end_header\r\n0 0 0 9\r\n1 0 0 9\r\n1 1 0 9\r\n0 1 0 9\r\n2 0.5 0.5\r\n7 4 0 1 2 3\r\n",
      "a.ply");
  EXPECT_EQ(mesh.num_triangles(), 2U);
  EXPECT_DOUBLE_EQ(surface_area_mm2(mesh), 1.0);
}

template <class T>
void append_swapped(std::string& out, T value) {
  std::array<char, sizeof(T)> raw = {};
  std::memcpy(raw.data(), &value, sizeof value);
  out.append(raw.rbegin(), raw.rend());
}

TEST(ParseMesh, ReadsBigEndianPly) {
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty float x\nproperty double y\n"
      "property short z\nelement face 1\nproperty list uchar uint vertex_indices\nend_header\n";
  for (const Vector3d& p : {Vector3d(0, 0, 3), Vector3d(2, 0, 3), Vector3d(0, 2, 3)}) {
    append_swapped(bytes, static_cast<float>(p.x()));
    append_swapped(bytes, p.y());
    append_swapped(bytes, static_cast<std::int16_t>(p.z()));
  }
  bytes += '\3';
  for (const std::uint32_t corner : {0U, 1U, 2U}) {
    append_swapped(bytes, corner);
  }
  const TriangleMesh mesh = parse_mesh(bytes, "a.ply");
  EXPECT_DOUBLE_EQ(surface_area_mm2(mesh), 2.0);
  EXPECT_EQ(mesh.vertices_mm[2], Vector3d(0, 2, 3));
}

}  // namespace
}  // namespace glint

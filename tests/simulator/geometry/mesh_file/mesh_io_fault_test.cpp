// SPDX-License-Identifier: GPL-3.0-or-later
//
// What must not get through: every fault has one clear error, and no bytes crash the readers.
#include <string>

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

using ::testing::HasSubstr;
using ::testing::StartsWith;

std::string fault_of(const std::string& bytes, const std::string& name) {
  return text_thrown_by<ConfigError>([&] { parse_mesh(bytes, name); });
}

TEST(MeshFaults, InTextFilesNameLineAndColumn) {
  EXPECT_THAT(fault_of("v 0 0 0\nv 1 zero 0\n", "a.obj"),
              StartsWith("a.obj:2:5: y is no number: \"zero\""));
  EXPECT_THAT(fault_of("v 0 0 0\nv 1 0\n", "a.obj"), StartsWith("a.obj:2:6: z is missing"));
  EXPECT_THAT(
      fault_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 7\n", "a.obj"),
      StartsWith("a.obj:4:1: face 0 names vertex 6 (counted from 0), but there are only 3"));
  EXPECT_THAT(fault_of("v 0 0 0\nf 1 -2 1\n", "a.obj"),
              StartsWith("a.obj:2:5: a face names vertex -2"));
  EXPECT_THAT(fault_of("v 0 0 0\nv 1 0 0\nf 1 2\n", "a.obj"),
              StartsWith("a.obj:3:1: face 0 has 2 corners; allowed: 3 or more"));
  EXPECT_THAT(fault_of("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", "a.off"),
              StartsWith("a.off:6:1: face 0 names vertex 3 (counted from 0)"));
  EXPECT_THAT(fault_of("solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvortex\n", "a.stl"),
              StartsWith("a.stl:5:1: \"vertex\" expected"));
}

TEST(MeshFaults, OfCaoModelsNameLineAndColumn) {
  const std::string points = "V1\n3\n0 0 0\n1 0 0\n0 1 0\n";
  EXPECT_THAT(fault_of(points + "0\n1\n2 0 1\n1\n3 0 1 2\n", "a.cao"),
              HasSubstr("a.cao:7:1: faces given by lines are not read"));
  EXPECT_THAT(fault_of(points + "0\n0\n1\n3 0 1 7\n", "a.cao"), HasSubstr("a.cao:9:"));
  EXPECT_THAT(fault_of(points + "0\n0\n1\n3 0 1 2\n2\n", "a.cao"),
              HasSubstr("a.cao:10:1: cylinders are not read"));
  EXPECT_THAT(fault_of("V1\n3000000000\n", "a.cao"), HasSubstr("a.cao:2:1"));
}

TEST(MeshFaults, NotFiniteCoordinatesNameTheVertex) {
  EXPECT_THAT(fault_of("v 0 0 0\nv 1 nan 0\nf 1 1 1\n", "a.obj"),
              StartsWith("a.obj:2:9: vertex 1 is not finite"));
  EXPECT_THAT(fault_of("OFF\n1 0 0\n0 inf 0\n", "a.off"),
              StartsWith("a.off:3:7: vertex 0 is not finite"));
  EXPECT_THAT(fault_of("v 0 1e999 0\n", "a.obj"), HasSubstr("y is no number"));
}

TEST(MeshFaults, NaNInABinaryStlNamesTheVertex) {
  const TemporaryFolder folder;
  write_mesh(folder / "a.stl", cube_mesh(1.0));
  std::string bytes = read_file(folder / "a.stl");
  bytes.replace(84 + 50 + 12, 4, "\xff\xff\xff\x7f");  // first vertex of the second facet
  EXPECT_EQ(fault_of(bytes, "a.stl"), "a.stl: vertex 3 is not finite (nan -1 -1)");
}

TEST(MeshFaults, EmptyAndPointlessFilesAreRefused) {
  EXPECT_EQ(fault_of("", "a.stl"), "a.stl: the file is empty");
  EXPECT_EQ(fault_of("solid nothing\nendsolid\n", "a.stl"), "a.stl: it holds no triangle");
  EXPECT_EQ(fault_of("v 0 0 0\n", "a.obj"), "a.obj: it holds no triangle");
  EXPECT_EQ(fault_of("OFF\n0 0 0\n", "a.off"), "a.off: it holds no triangle");
  EXPECT_EQ(fault_of("v 0 0 0\nv 1 0 0\nv 0 0 0\nf 1 2 3\n", "a.obj"),
            "a.obj: all its triangles are lines or points");
  EXPECT_EQ(fault_of("v 0 0 0\nv 30 10 0\nv 60 20 0\nf 1 2 3\n", "a.obj"),
            "a.obj: all its triangles are lines or points");
  EXPECT_NO_THROW(parse_mesh("v 0 0 0\nv 1e300 0 0\nv 0 0.001 0\nf 1 2 3\n", "a.obj"));
}

TEST(MeshFaults, UnknownContentNamesWhatIsAllowed) {
  EXPECT_THAT(fault_of("hello", "a.step"), HasSubstr("allowed: STL, PLY, OBJ, OFF"));
  EXPECT_THAT(fault_of("hello", "a.ply"), HasSubstr("does not begin as a .ply file must"));
  EXPECT_THAT(fault_of("hello", "a.stl"), HasSubstr("5 bytes are too few for an STL file"));
}

TEST(MeshFaults, TruncatedBinaryStlSaysWhatIsMissing) {
  const TemporaryFolder folder;
  write_mesh(folder / "a.stl", cube_mesh(1.0));
  const std::string bytes = read_file(folder / "a.stl");
  EXPECT_EQ(fault_of(bytes.substr(0, 500), "a.stl"),
            "a.stl: the file is truncated or no STL: its 12 triangles need 684 bytes, it has 500");
  EXPECT_THAT(fault_of(bytes + "x", "a.stl"), HasSubstr("damaged"));
}

TEST(MeshFaults, PromisesTheFileCannotKeepAskForNoMemory) {
  EXPECT_THAT(fault_of("OFF\n2000000000 1 0\n0 0 0\n", "a.off"),
              HasSubstr("2000000000 vertices are promised"));
  EXPECT_THAT(fault_of("OFF\n1 1 0\n0 0 0\n999999999 0 0 0\n", "a.off"),
              HasSubstr("999999999 corners are promised"));
  EXPECT_THAT(fault_of("OFF\n-1 1 0\n0 0 0\n", "a.off"), HasSubstr("-1 vertices"));
  EXPECT_THAT(fault_of("ply\nformat binary_little_endian 1.0\nelement vertex 9223372036854775807\n"
                       "property float x\nproperty float y\nproperty float z\nend_header\n",
                       "a.ply"),
              HasSubstr("are promised"));
}

TEST(MeshFaults, InPlyHeadersNameLineAndColumn) {
  EXPECT_THAT(
      fault_of("ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n", "a.ply"),
      StartsWith("a.ply:4:10: unknown type in the header"));
  EXPECT_THAT(fault_of("ply\nformat utf8 1.0\nend_header\n", "a.ply"),
              StartsWith("a.ply:2:8: unknown format"));
  EXPECT_THAT(fault_of("ply\nformat ascii 1.0\nelement vertex 1\n", "a.ply"),
              HasSubstr("\"end_header\" is missing"));
  EXPECT_THAT(fault_of("ply\nelement vertex 1\nend_header\n", "a.ply"),
              HasSubstr("names no format"));
  EXPECT_THAT(fault_of("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
                       "a.ply"),
              HasSubstr("no x, y and z"));
}

TEST(MeshFaults, BinaryPlyThatEndsEarlyNamesTheVertexOrFace) {
  const TemporaryFolder folder;
  write_mesh(folder / "a.ply", cube_mesh(1.0));
  const std::string bytes = read_file(folder / "a.ply");
  EXPECT_EQ(fault_of(bytes.substr(0, bytes.size() - 5), "a.ply"),
            "a.ply: the file ends in the middle of face 11");
}

/// One small file of each kind.
std::vector<std::pair<std::string, std::string>> seeds() {
  const TemporaryFolder folder;
  std::vector<std::pair<std::string, std::string>> files;
  for (const char* name : {"a.stl", "a.ply", "a.obj", "a.off"}) {
    write_mesh(folder / name, cube_mesh(1.0));
    files.emplace_back(name, read_file(folder / name));
  }
  files.emplace_back("b.stl",
                     "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n"
                     "vertex 0 1 0\nendloop\nendfacet\nendsolid x\n");
  files.emplace_back("b.ply",
                     "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
                     "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
                     "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  return files;
}

/// Reads or refuses; anything but an Error of ours ends the test.
bool survives(const std::string& bytes, const std::string& name) {
  try {
    return find_fault(parse_mesh(bytes, name)).empty();
  } catch (const ConfigError&) {
    return true;
  }
}

TEST(MeshFaults, AFileCutAnywhereIsReadOrRefused) {
  for (const auto& [name, bytes] : seeds()) {
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      ASSERT_TRUE(survives(bytes.substr(0, size), name)) << name << " cut to " << size;
    }
  }
}

TEST(MeshFaults, AFileWithChangedBytesIsReadOrRefused) {
  Rng rng(21, Stream::kTest, 0);
  for (const auto& [name, bytes] : seeds()) {
    for (int round = 0; round < 2000; ++round) {
      std::string changed = bytes;
      const int changes = 1 + static_cast<int>(rng.next_u32() % 6U);
      for (int i = 0; i < changes; ++i) {
        changed[rng.next_u32() % changed.size()] = static_cast<char>(rng.next_u32() & 0xffU);
      }
      ASSERT_TRUE(survives(changed, name)) << name << " round " << round;
    }
  }
}

TEST(MeshFaults, GarbageBehindEveryNameIsRefused) {
  Rng rng(22, Stream::kTest, 0);
  for (const char* name : {"a.stl", "a.ply", "a.obj", "a.off", "a"}) {
    for (int round = 0; round < 300; ++round) {
      std::string bytes(rng.next_u32() % 400U, ' ');
      for (char& c : bytes) {
        c = static_cast<char>(rng.next_u32() & 0xffU);
      }
      ASSERT_TRUE(survives(bytes, name));
    }
  }
}

/// Inputs that have brought mesh readers down: replayed for ever.
TEST(MeshFaults, NastyInputsAreReadOrRefused) {
  const std::vector<std::pair<std::string, std::string>> inputs = {
      {"a.obj", "f"},
      {"a.obj", "f 1/ 2/ 3/"},
      {"a.obj", "f / / /"},
      {"a.obj", "v + - ."},
      {"a.obj", "f 9223372036854775808 1 1"},
      {"a.obj", "f -9223372036854775808 1 1"},
      {"a.obj", "v 0 0 0\nf 1 1 1 \\"},
      {"a.off", "OFF"},
      {"a.off", "OFF BINARY\n"},
      {"a.off", "4OFF\n1 1 1\n"},
      {"a.off", "OFF 3 1"},
      {"a.off", "OFF\n3 1 0\n0 0 0 1 0 0 0 1 0\n3 0 1 -1\n"},
      {"a.ply", "ply\n"},
      {"a.ply", "ply\nformat ascii 1.0\nproperty float x\nend_header\n"},
      {"a.ply", "ply\nformat ascii 1.0\nelement face 1000000000\nend_header\n"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement face 1\nproperty list float float vertex_indices\n"
       "end_header\nnan nan nan"},
      {"a.ply",
       "ply\nformat ascii 1.0\nelement face 1\nproperty list int int vertex_indices\nend_header\n"
       "-3 0 1 2\n"},
      {"a.stl", std::string(84, '\xff')},
      {"a.stl", "solid\n\0facet"},
      {"a.stl", "solid x\nfacet\nouter loop\nvertex 0 0 0\nvertex 0 0 0\nvertex 0 0 0\n"}};
  for (const auto& [name, bytes] : inputs) {
    EXPECT_TRUE(survives(bytes, name)) << name << ": " << bytes;
    EXPECT_THROW(parse_mesh(bytes, name), ConfigError) << name << ": " << bytes;
  }
}

}  // namespace
}  // namespace glint

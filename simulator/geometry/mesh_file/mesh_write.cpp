// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/geometry/mesh_file/mesh_write.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "core/error.h"
#include "core/file.h"
#include "core/text.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// The bytes of a value as they lie in memory (little endian, checked in read_stl.cpp).
template <class T>
void append(std::string& out, const T& value) {
  std::array<char, sizeof(T)> raw = {};
  std::copy_n(reinterpret_cast<const char*>(&value), sizeof(T), raw.data());
  out.append(raw.data(), raw.size());
}

void append_float(std::string& out, const Vector3d& vector) {
  for (const double value : vector) {
    append(out, static_cast<float>(value));
  }
}

}  // namespace

std::string stl_bytes(const TriangleMesh& mesh) {
  std::string out = "binary STL, unit mm, written by Glint";
  out.resize(80, ' ');
  append(out, static_cast<std::uint32_t>(mesh.num_triangles()));
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    append_float(out, face_normal(mesh, i));
    for (std::size_t k = 0; k < 3; ++k) {
      append_float(out, mesh.vertex(i, k));
    }
    out.append(2, '\0');
  }
  return out;
}

std::string ply_bytes(const TriangleMesh& mesh,
                      const FaceValues& values,
                      std::span<const VertexColour> colours,
                      std::span<const FaceNumbers> numbers) {
  const bool has_values = !values.values.empty();
  GLINT_CHECK(!has_values || values.values.size() == mesh.num_triangles(), "one value a face");
  GLINT_CHECK(colours.empty() || colours.size() == mesh.vertices_mm.size(), "one colour a vertex");
  std::string properties = has_values ? fmt::format("property int {}\n", values.name) : "";
  for (const FaceNumbers& property : numbers) {
    GLINT_CHECK(property.values.size() == mesh.num_triangles(), "one number a face");
    properties += fmt::format("property float {}\n", property.name);
  }
  std::string out = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment unit mm, written by Glint\n"
      "element vertex {}\nproperty double x\nproperty double y\nproperty double z\n{}"
      "element face {}\nproperty list uchar int vertex_indices\n{}end_header\n",
      mesh.vertices_mm.size(),
      colours.empty() ? "" : "property uchar red\nproperty uchar green\nproperty uchar blue\n",
      mesh.num_triangles(),
      properties);
  for (std::size_t i = 0; i < mesh.vertices_mm.size(); ++i) {
    for (const double value : mesh.vertices_mm[i]) {
      append(out, value);
    }
    if (!colours.empty()) {
      append(out, colours[i]);
    }
  }
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    append(out, std::uint8_t{3});
    for (const std::int32_t vertex : mesh.triangles[i]) {
      append(out, vertex);
    }
    if (has_values) {
      append(out, values.values[i]);
    }
    for (const FaceNumbers& property : numbers) {
      append(out, property.values[i]);
    }
  }
  return out;
}

namespace {

void append_vertices(std::string& out, const TriangleMesh& mesh, std::string_view prefix) {
  for (const Vector3d& vertex : mesh.vertices_mm) {
    out += fmt::format(
        "{}{} {} {}\n", prefix, shortest(vertex.x()), shortest(vertex.y()), shortest(vertex.z()));
  }
}

}  // namespace

void append_obj_vertices(std::string& text, const TriangleMesh& mesh) {
  append_vertices(text, mesh, "v ");
}

void append_obj_face(std::string& text, const Triangle& triangle) {
  text += fmt::format("f {} {} {}\n", triangle[0] + 1, triangle[1] + 1, triangle[2] + 1);
}

namespace {

std::string obj_text(const TriangleMesh& mesh) {
  std::string out = "# unit mm, written by Glint\n";
  append_obj_vertices(out, mesh);
  for (const Triangle& triangle : mesh.triangles) {
    append_obj_face(out, triangle);
  }
  return out;
}

std::string off_text(const TriangleMesh& mesh) {
  std::string out = fmt::format("OFF\n{} {} 0\n", mesh.vertices_mm.size(), mesh.num_triangles());
  append_vertices(out, mesh, "");
  for (const Triangle& triangle : mesh.triangles) {
    out += fmt::format("3 {} {} {}\n", triangle[0], triangle[1], triangle[2]);
  }
  return out;
}

}  // namespace

void write_mesh(const std::filesystem::path& path, const TriangleMesh& mesh) {
  const std::string extension = path.extension().string();
  if (extension == ".stl") {
    write_file(path, stl_bytes(mesh));
  } else if (extension == ".ply") {
    write_file(path, ply_bytes(mesh));
  } else if (extension == ".obj") {
    write_file(path, obj_text(mesh));
  } else if (extension == ".off") {
    write_file(path, off_text(mesh));
  } else {
    throw ConfigError(fmt::format("{}: unknown mesh format \"{}\"; allowed: .stl, .ply, .obj, .off",
                                  path.string(),
                                  extension));
  }
}

}  // namespace glint

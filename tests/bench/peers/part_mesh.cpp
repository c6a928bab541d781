// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/peers/part_mesh.h"

#include <array>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "core/error.h"
#include "core/file.h"

namespace glint::peers {
namespace {

using Eigen::Vector3d;

constexpr int kQuadsAlong = 1400;
constexpr int kQuadsAcross = 350;
constexpr double kLength_mm = 200.0;
constexpr double kWidth_mm = 50.0;
constexpr double kRadiusAlong_mm = 1000.0;
constexpr double kRadiusAcross_mm = 60.0;
constexpr double kDentSigma_mm = 0.28;
constexpr double kDentDepth_mm = 0.010;

/// Centres of the dents (x, y) [mm].
constexpr std::array<std::array<double, 2>, 12> kDents = {{{-71.3, 8.4},
                                                           {66.2, -17.1},
                                                           {49.5, 3.7},
                                                           {-49.4, 15.9},
                                                           {-36.0, -9.6},
                                                           {67.3, 18.2},
                                                           {-89.0, -2.3},
                                                           {58.2, 11.0},
                                                           {53.6, -13.5},
                                                           {-6.8, 6.1},
                                                           {14.9, -5.2},
                                                           {-44.7, -18.8}}};

double height_mm(double x, double y) {
  double z = -x * x / (2.0 * kRadiusAlong_mm) - y * y / (2.0 * kRadiusAcross_mm);
  for (const auto& [centre_x, centre_y] : kDents) {
    const double r2 = (x - centre_x) * (x - centre_x) + (y - centre_y) * (y - centre_y);
    z -= kDentDepth_mm * std::exp(-r2 / (2.0 * kDentSigma_mm * kDentSigma_mm));
  }
  return z;
}

double as_float(double value) {
  return static_cast<double>(static_cast<float>(value));
}

template <class T>
void append(std::string& out, const T& value) {
  out.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

void append_raw_mesh(std::string& out, const TriangleMesh& mesh) {
  append(out, static_cast<std::int32_t>(mesh.vertices_mm.size()));
  append(out, static_cast<std::int32_t>(mesh.num_triangles()));
  for (const Vector3d& vertex : mesh.vertices_mm) {
    for (const double value : vertex) {
      append(out, static_cast<float>(value));
    }
  }
  for (const Triangle& triangle : mesh.triangles) {
    append(out, triangle);
  }
}

}  // namespace

TriangleMesh make_part_mesh() {
  TriangleMesh mesh;
  for (int j = 0; j <= kQuadsAcross; ++j) {
    const double y = as_float(kWidth_mm * (static_cast<double>(j) / kQuadsAcross - 0.5));
    for (int i = 0; i <= kQuadsAlong; ++i) {
      const double x = as_float(kLength_mm * (static_cast<double>(i) / kQuadsAlong - 0.5));
      mesh.vertices_mm.emplace_back(x, y, as_float(height_mm(x, y)));
    }
  }
  constexpr int kRow = kQuadsAlong + 1;
  for (int j = 0; j < kQuadsAcross; ++j) {
    for (int i = 0; i < kQuadsAlong; ++i) {
      const int corner = j * kRow + i;
      mesh.triangles.push_back({corner, corner + 1, corner + kRow + 1});
      mesh.triangles.push_back({corner, corner + kRow + 1, corner + kRow});
    }
  }
  return mesh;
}

void write_raw_meshes(const std::filesystem::path& path, std::span<const TriangleMesh> meshes) {
  std::string out;
  for (const TriangleMesh& mesh : meshes) {
    append_raw_mesh(out, mesh);
  }
  write_file(path, out);
}

void write_povray_mesh(const std::filesystem::path& path, const TriangleMesh& mesh) {
  std::vector<Vector3d> normals(mesh.vertices_mm.size(), Vector3d::Zero());
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      Vector3d& normal = normals[static_cast<std::size_t>(mesh.triangles[i][k])];
      GLINT_CHECK(normal.isZero() || normal == mesh.normal(i, k), "the mesh is smooth everywhere");
      normal = mesh.normal(i, k);
    }
  }
  std::string out;
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "mesh2 {{\nvertex_vectors {{{},\n", mesh.vertices_mm.size());
  for (const Vector3d& v : mesh.vertices_mm) {
    fmt::format_to(to, "<{:.9g},{:.9g},{:.9g}>,\n", v.x(), v.y(), v.z());
  }
  fmt::format_to(to, "}}\nnormal_vectors {{{},\n", normals.size());
  for (const Vector3d& n : normals) {
    fmt::format_to(to, "<{:.9g},{:.9g},{:.9g}>,\n", n.x(), n.y(), n.z());
  }
  fmt::format_to(to, "}}\nface_indices {{{},\n", mesh.num_triangles());
  for (const Triangle& t : mesh.triangles) {
    fmt::format_to(to, "<{},{},{}>,\n", t[0], t[1], t[2]);
  }
  out +=
      "}\ntexture { pigment { rgb 0 }\n"
      "  finish { ambient 0 diffuse 0 specular 0 reflection { 1 } } }\n}\n";
  write_file(path, out);
}

}  // namespace glint::peers

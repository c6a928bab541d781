// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/part/defect_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "core/error.h"
#include "core/file.h"
#include "simulator/geometry/mesh_file/mesh_write.h"

namespace glint {
namespace {

using FloatPoint = std::array<float, 3>;

std::vector<FloatPoint> rounded(const TriangleMesh& mesh) {
  std::vector<FloatPoint> points;
  points.reserve(mesh.vertices_mm.size());
  for (const Eigen::Vector3d& p : mesh.vertices_mm) {
    // -0 becomes +0, for the two are one place.
    points.push_back({static_cast<float>(p.x()) + 0.0F,
                      static_cast<float>(p.y()) + 0.0F,
                      static_cast<float>(p.z()) + 0.0F});
  }
  return points;
}

bool has_lost_area(const FloatPoint& a, const FloatPoint& b, const FloatPoint& c) {
  const auto vector = [](const FloatPoint& p) {
    return Eigen::Vector3f(p[0], p[1], p[2]).cast<double>().eval();
  };
  const Eigen::Vector3d u = vector(b) - vector(a);
  const Eigen::Vector3d v = vector(c) - vector(a);
  return std::abs(u.y() * v.z() - u.z() * v.y()) + std::abs(u.z() * v.x() - u.x() * v.z()) +
             std::abs(u.x() * v.y() - u.y() * v.x()) ==
         0.0;
}

}  // namespace

std::string FloatLoss::warning() const {
  if (none()) {
    return "";
  }
  return fmt::format(
      "in the single precision of STL {} vertices fall together and {} triangles lose their area: "
      "the part is far from the origin for its detail; use the PLY, or move the part",
      merged_vertices,
      collapsed_faces);
}

FloatLoss float_loss(const TriangleMesh& mesh) {
  const std::vector<FloatPoint> points = rounded(mesh);
  std::vector<std::int32_t> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto at = [](std::int32_t i) { return static_cast<std::size_t>(i); };
  std::ranges::sort(order, [&](std::int32_t a, std::int32_t b) {
    return points[at(a)] != points[at(b)] ? points[at(a)] < points[at(b)] : a < b;
  });
  FloatLoss loss;
  for (std::size_t i = 1; i < order.size(); ++i) {
    const std::size_t a = at(order[i - 1]);
    const std::size_t b = at(order[i]);
    loss.merged_vertices +=
        points[a] == points[b] && mesh.vertices_mm[a] != mesh.vertices_mm[b] ? 1 : 0;
  }
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    const Triangle& t = mesh.triangles[i];
    loss.collapsed_faces += has_lost_area(points[at(t[0])], points[at(t[1])], points[at(t[2])]) &&
                                    area_vector(mesh, i).norm() > 0.0
                                ? 1
                                : 0;
  }
  return loss;
}

FloatLoss write_stl(const std::filesystem::path& path, const TriangleMesh& mesh) {
  write_file(path, stl_bytes(mesh));
  return float_loss(mesh);
}

void write_labelled_ply(const std::filesystem::path& path,
                        const TriangleMesh& mesh,
                        std::span<const std::int32_t> labels) {
  GLINT_CHECK(labels.size() == mesh.num_triangles(), "one label a face");
  write_file(path, ply_bytes(mesh, {.name = "defect_id", .values = labels}));
}

void write_defect_map(const std::filesystem::path& obj_path,
                      const TriangleMesh& mesh,
                      std::span<const std::int32_t> labels) {
  GLINT_CHECK(labels.size() == mesh.num_triangles(), "one label a face");
  std::filesystem::path mtl_path = obj_path;
  mtl_path.replace_extension(".mtl");
  // Without light (illum 0) a viewer shows the plain colour.
  write_file(mtl_path,
             "# written by Glint\n"
             "newmtl part\nKa 0 0 0\nKd 0 0 0\nKs 0 0 0\nillum 0\n\n"
             "newmtl defect\nKa 1 1 1\nKd 1 1 1\nKs 0 0 0\nillum 0\n");
  std::string text = fmt::format("# defect map, unit mm, written by Glint\nmtllib {}\n",
                                 mtl_path.filename().string());
  append_obj_vertices(text, mesh);
  for (std::size_t i = 0; i < mesh.num_triangles(); ++i) {
    if (i == 0 || (labels[i] > 0) != (labels[i - 1] > 0)) {
      text += labels[i] > 0 ? "usemtl defect\n" : "usemtl part\n";
    }
    append_obj_face(text, mesh.triangles[i]);
  }
  write_file(obj_path, text);
}

}  // namespace glint

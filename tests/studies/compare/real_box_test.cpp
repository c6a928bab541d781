// SPDX-License-Identifier: GPL-3.0-or-later
//
// A photograph of a box by others, its model and four points marked by eye: the pose refined by its
// edges lays the model's edges on the photographed ones.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>
#include <Eigen/Geometry>

#include "core/image/image_io.h"
#include "metrics/overlap/edge_location.h"
#include "simulator/geometry/mesh_file/mesh_io.h"
#include "simulator/geometry/mesh_file/mesh_write.h"
#include "studies/compare/fit/cause_fit.h"

namespace glint {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector2d;
using Eigen::Vector3d;

const fs::path kPhotograph = fs::path(GLINT_SHARED_DIR) / "data/field/teabox/teabox.png";

/// 165 x 68 x 80 mm, corners numbered as in the model's file.
const std::array<Vector3d, 8> kCorners = {Vector3d(0, 0, 0),
                                          Vector3d(0, 0, -80),
                                          Vector3d(165, 0, -80),
                                          Vector3d(165, 0, 0),
                                          Vector3d(165, 68, 0),
                                          Vector3d(165, 68, -80),
                                          Vector3d(0, 68, -80),
                                          Vector3d(0, 68, 0)};
constexpr std::array<std::array<std::size_t, 4>, 6> kFaces = {
    {{0, 1, 2, 3}, {1, 6, 5, 2}, {4, 5, 6, 7}, {0, 3, 4, 7}, {5, 4, 3, 2}, {0, 7, 6, 1}}};

/// Marked by eye, by corner.
struct MarkedCorner {
  std::size_t corner;
  Vector2d at_px;
};

const std::array<MarkedCorner, 4> kMarked = {
    {{0, {56, 44}}, {3, {155, 110}}, {2, {153, 208}}, {5, {212, 175}}}};

/// Where the photograph has been drawn upon in red.
const std::array<Vector2d, 4> kDrawnUpon = {
    Vector2d(45, 43), Vector2d(149, 108), Vector2d(139, 207), Vector2d(226, 175)};

/// Half of the calibration for 640 x 480, with the corner of the first pixel at (0, 0).
PinholeIntrinsics box_camera() {
  return {.width_px = 320,
          .height_px = 240,
          .focal_px = {0.5 * 839.21470, 0.5 * 839.44555},
          .center_px = {0.5 * (325.66776 + 0.5), 0.5 * (243.69727 + 0.5)}};
}

Vector2d pixel_of(const Eigen::Isometry3d& camera_from_box, const Vector3d& point_mm) {
  return changed_pixel(box_camera(), Vector3d::UnitZ(), CauseVector{}, camera_from_box * point_mm);
}

double marked_misfit(const Eigen::Isometry3d& camera_from_box) {
  double sum = 0.0;
  for (const MarkedCorner& marked : kMarked) {
    const Vector3d at = camera_from_box * kCorners[marked.corner];
    sum += at.z() > 50.0
               ? (pixel_of(camera_from_box, kCorners[marked.corner]) - marked.at_px).squaredNorm()
               : 1e9;
  }
  return sum;
}

Eigen::Isometry3d stepped(const Eigen::Isometry3d& pose, const Eigen::Matrix<double, 6, 1>& step) {
  const Vector3d turn = step.head<3>();
  const Eigen::AngleAxisd rotation(
      turn.norm(), turn.norm() > 0 ? Vector3d(turn.normalized()) : Vector3d(Vector3d::UnitX()));
  Eigen::Isometry3d result = pose;
  result.linear() = rotation.toRotationMatrix() * pose.linear();
  result.translation() += step.tail<3>();
  return result;
}

/// From many starts, Gauss-Newton by differences over the four marked corners.
Eigen::Isometry3d marked_pose() {
  Eigen::Isometry3d best = Eigen::Isometry3d::Identity();
  double best_misfit = 1e300;
  for (int start = 0; start < 64; ++start) {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    const int tilt = start / 8;
    pose.linear() = (Eigen::AngleAxisd(0.785 * (start % 8), Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(0.785 * tilt, Vector3d::UnitX()))
                        .toRotationMatrix();
    pose.translation() = Vector3d(0, 0, 500) - pose.linear() * Vector3d(82, 34, -40);
    double damping = 1e-2;
    for (int i = 0; i < 100; ++i) {
      Eigen::Matrix<double, 8, 6> slopes;
      Eigen::Matrix<double, 8, 1> rest;
      for (std::size_t k = 0; k < 4; ++k) {
        const Vector3d& corner = kCorners[kMarked[k].corner];
        const auto row = static_cast<Eigen::Index>(2 * k);
        rest.segment<2>(row) = kMarked[k].at_px - pixel_of(pose, corner);
        for (Eigen::Index c = 0; c < 6; ++c) {
          Eigen::Matrix<double, 6, 1> step = Eigen::Matrix<double, 6, 1>::Zero();
          step[c] = c < 3 ? 1e-5 : 1e-3;
          slopes.block<2, 1>(row, c) =
              (pixel_of(stepped(pose, step), corner) - pixel_of(pose, corner)) / step[c];
        }
      }
      Eigen::Matrix<double, 6, 6> normal = slopes.transpose() * slopes;
      normal.diagonal() *= 1.0 + damping;
      normal.diagonal().array() += 1e-9;
      const Eigen::Isometry3d next = stepped(pose, normal.ldlt().solve(slopes.transpose() * rest));
      const bool is_better = marked_misfit(next) < marked_misfit(pose);
      damping *= is_better ? 0.3 : 5.0;
      pose = is_better ? next : pose;
    }
    if (marked_misfit(pose) < best_misfit) {
      best_misfit = marked_misfit(pose);
      best = pose;
    }
  }
  return best;
}

bool is_visible(const Eigen::Isometry3d& pose, const std::array<std::size_t, 4>& face) {
  Vector3d middle = Vector3d::Zero();
  for (const std::size_t corner : face) {
    middle += 0.25 * kCorners[corner];
  }
  const Vector3d outward = middle - Vector3d(82.5, 34.0, -40.0);
  return (pose.linear() * outward).dot(pose * middle) < 0.0;
}

struct BoxEdges {
  std::vector<Boundary> lines;
  std::vector<std::vector<Vector3d>> in_camera_mm;
};

/// The outline, a point a pixel, away from corners and from what was drawn upon. Edges between two
/// visible faces lie in print.
BoxEdges visible_edges(const Eigen::Isometry3d& pose) {
  BoxEdges edges;
  for (std::size_t a = 0; a < 8; ++a) {
    for (std::size_t b = a + 1; b < 8; ++b) {
      int sides = 0;
      int visible = 0;
      for (const auto& face : kFaces) {
        const bool has = std::ranges::count(face, a) > 0 && std::ranges::count(face, b) > 0;
        sides += has ? 1 : 0;
        visible += has && is_visible(pose, face) ? 1 : 0;
      }
      if (sides != 2 || visible != 1) {
        continue;
      }
      const Vector2d from = pixel_of(pose, kCorners[a]);
      const Vector2d to = pixel_of(pose, kCorners[b]);
      const Vector2d along = (to - from).normalized();
      Boundary line;
      std::vector<Vector3d> points;
      const int count = static_cast<int>((to - from).norm());
      for (int i = 6; i + 6 < count; ++i) {
        const Vector3d at_mm = kCorners[a] + (kCorners[b] - kCorners[a]) * i / count;
        const Vector2d at_px = pixel_of(pose, at_mm);
        const bool is_drawn_upon = std::ranges::any_of(
            kDrawnUpon, [&](const Vector2d& mark) { return (mark - at_px).norm() < 15.0; });
        if (!is_drawn_upon) {
          line.points.push_back({.at_px = at_px, .normal = Vector2d(along.y(), -along.x())});
          points.push_back(pose * at_mm);
        }
      }
      edges.lines.push_back(std::move(line));
      edges.in_camera_mm.push_back(std::move(points));
    }
  }
  return edges;
}

std::vector<SpaceEdge> found_edges(const ImageF& photograph,
                                   const BoxEdges& edges,
                                   double reach_px) {
  std::vector<SpaceEdge> found;
  for (const LocatedEdge& edge :
       locate_edges(photograph, edges.lines, {.reach_px = reach_px, .min_contrast = 0.05})) {
    found.push_back({.in_camera_mm = edges.in_camera_mm[edge.boundary][edge.point],
                     .normal = edge.edge.normal,
                     .offset_px = edge.moved_px});
  }
  return found;
}

double mean_distance(const std::vector<SpaceEdge>& edges) {
  double sum = 0.0;
  for (const SpaceEdge& edge : edges) {
    sum += std::abs(edge.offset_px);
  }
  return sum / static_cast<double>(edges.size());
}

// The model's file, in metres, read and written as PLY: the corners above.
TEST(RealBox, IsTheModelsFileInMillimetres) {
  const fs::path model = kPhotograph.parent_path() / "teabox.cao";
  if (!fs::exists(model)) {
    GTEST_SKIP() << model << " is not there";
  }
  TriangleMesh mesh = read_mesh(model);
  for (Vector3d& vertex : mesh.vertices_mm) {
    vertex *= 1000.0;
  }
  const fs::path ply = fs::temp_directory_path() / fmt::format("glint_teabox_{}.ply", ::getpid());
  write_mesh(ply, mesh);
  const TriangleMesh box = read_mesh(ply);
  fs::remove(ply);
  EXPECT_EQ(box.triangles.size(), 12U);
  ASSERT_EQ(box.vertices_mm.size(), kCorners.size());
  for (const Vector3d& corner : kCorners) {
    EXPECT_TRUE(std::ranges::any_of(box.vertices_mm, [&](const Vector3d& vertex) {
      return (vertex - corner).norm() < 1e-9;
    })) << corner.transpose();
  }
}

TEST(RealBox, EdgesOfTheRefinedModelLieOnThePhotographedOnes) {
  if (!fs::exists(kPhotograph)) {
    GTEST_SKIP() << kPhotograph << " is not there";
  }
  const ImageF photograph = linear_values(read_picture(kPhotograph).pixels);
  Eigen::Isometry3d pose = marked_pose();
  ASSERT_LT(std::sqrt(marked_misfit(pose) / 4.0), 6.0);
  const Vector3d inside(82.5, 34.0, -40.0);
  for (int pass = 0; pass < 6; ++pass) {
    const Vector3d middle = pose * inside;
    const auto edges = found_edges(photograph, visible_edges(pose), pass < 3 ? 8.0 : 5.0);
    const CauseFit fit = fit_causes(edges, box_camera(), middle, true);
    const Vector3d turn(fit.changes[0], fit.changes[1], fit.changes[2]);
    const Vector3d shift(fit.changes[3], fit.changes[4], fit.changes[5]);
    if (turn.norm() > 0.0) {
      const Eigen::AngleAxisd rotation(turn.norm(), turn.normalized());
      pose = Eigen::Translation3d(middle) * rotation * Eigen::Translation3d(-middle) * pose;
    }
    pose = Eigen::Translation3d(shift) * pose;
  }
  const auto edges = found_edges(photograph, visible_edges(pose), 5.0);
  ASSERT_GT(edges.size(), 150U);
  RecordProperty("mean_px", fmt::format("{:.2f}", mean_distance(edges)));
  EXPECT_LE(mean_distance(edges), 1.5);
}

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/cover/cover_pictures.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>

#include "core/units.h"
#include "simulator/camera/viewpoint_set.h"
#include "simulator/geometry/mesh_file/mesh_write.h"
#include "simulator/render/preview/preview.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kPictureSide_px = 640;
constexpr ScreenColour kBackground = {255, 255, 255};

/// What an uninspected or inspected cell counts as in the legend.
enum class Kind { kUnseen, kPoorView, kPoorLight, kOne, kTwo, kMany };

constexpr int kKinds = 6;
constexpr std::array<ScreenColour, kKinds> kColours = {
    {{178, 24, 43}, {239, 138, 98}, {246, 196, 66}, {158, 202, 225}, {66, 146, 198}, {8, 69, 148}}};
constexpr std::array<std::string_view, kKinds> kNames = {
    "seen by no view",
    "seen too obliquely, coarsely or unsharply",
    "hidden by a light, unlit, dark or clipped",
    "inspected by one view",
    "by two views",
    "by three or more"};

Kind kind_of(const CellCoverage& cell) {
  if (cell.views > 0) {
    return cell.views == 1 ? Kind::kOne : cell.views == 2 ? Kind::kTwo : Kind::kMany;
  }
  if (cell.state == CellState::kUnseen) {
    return Kind::kUnseen;
  }
  return cell.state <= CellState::kBlurred ? Kind::kPoorView : Kind::kPoorLight;
}

class Painter {
 public:
  Painter(const SceneCoverage& covered, ThreadPool& pool)
      : covered_(covered), bvh_(covered.cells.mesh), pool_(pool) {}

  ImageRgb draw(const PreviewView& view) const {
    const BuiltPart& built = *covered_.part;
    const SurfaceDetail no_detail;
    const std::vector<std::int32_t> no_labels;
    const ImageF shade =
        draw_preview(
            {.mesh = built.part.mesh, .bvh = *built.bvh, .labels = no_labels, .detail = no_detail},
            view,
            pool_)
            .image;
    const PinholeCamera camera(view.intrinsics);
    const RigidTransform world_from_camera = inverse(view.camera_from_world);
    ImageRgb image(view.intrinsics.width_px, view.intrinsics.height_px, kBackground);
    pool_.for_each(image.height(), [&](std::int64_t row) {
      const int y = static_cast<int>(row);
      for (int x = 0; x < image.width(); ++x) {
        image(x, y) = pixel(camera, world_from_camera, x, y, shade(x, y));
      }
    });
    return image;
  }

 private:
  /// The mean of four rays, shaded.
  ScreenColour pixel(const PinholeCamera& camera,
                     const RigidTransform& world_from_camera,
                     int x,
                     int y,
                     float shade) const {
    constexpr int kSide = 2;
    constexpr double kDimmest = 0.45;
    const double light =
        kDimmest + (1.0 - kDimmest) * std::clamp(1.3 * static_cast<double>(shade), 0.0, 1.0);
    std::array<double, 3> sum = {};
    for (int i = 0; i < kSide * kSide; ++i) {
      const int row = i / kSide;
      const Vector2d at(x + (i % kSide + 0.5) / kSide, y + (row + 0.5) / kSide);
      const auto ray = camera.ray_through(at);
      const Hit hit = ray ? bvh_.intersect(world_from_camera.translation_mm,
                                           world_from_camera.rotation * *ray,
                                           0.0,
                                           kFar_mm)
                          : Hit{};
      const ScreenColour colour =
          hit ? coverage_colour(covered_.of_cell[static_cast<std::size_t>(hit.triangle)])
              : kBackground;
      for (std::size_t c = 0; c < 3; ++c) {
        sum[c] += (hit ? light : 1.0) * colour[c] / (kSide * kSide);
      }
    }
    ScreenColour mean = {};
    std::ranges::transform(sum, mean.begin(), [](double value) {
      return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
    });
    return mean;
  }

  static constexpr double kFar_mm = 1e6;

  const SceneCoverage& covered_;
  Bvh bvh_;  ///< of the cells
  ThreadPool& pool_;
};

/// Of directions all around the one from which most of the gap is seen: the way to look.
Vector3d towards_gap(const SceneCoverage& covered, const Bvh& bvh) {
  constexpr double kFar_mm = 1e5;
  constexpr double kOff_mm = 1e-3;
  ViewpointSettings around;
  around.count = 60;
  around.polar_min_rad = 0.1;  // pictures have z upwards
  around.polar_max_rad = kPi - 0.1;
  Vector3d best(0.62, 0.58, -0.53);  // where none shows any of it
  double max_mm2 = 0.0;
  for (const Viewpoint& viewpoint : sphere_viewpoints(around, 1.0)) {
    const Vector3d towards(viewpoint.direction[0], viewpoint.direction[1], viewpoint.direction[2]);
    double seen_mm2 = 0.0;
    for (const std::size_t i : covered.gap.cells) {
      const double cosine = -covered.cells.normals[i].dot(towards);
      const Vector3d start_mm = covered.cells.points_mm[i] + kOff_mm * covered.cells.normals[i];
      if (cosine > 0.0 && !bvh.occluded(start_mm, -towards, 0.0, kFar_mm)) {
        seen_mm2 += cosine * covered.cells.areas_mm2[i];
      }
    }
    if (seen_mm2 > max_mm2) {
      max_mm2 = seen_mm2;
      best = towards;
    }
  }
  return best;
}

/// A number of each cell, in another unit.
std::vector<float> column_of(const SceneCoverage& covered,
                             float CellCoverage::*number,
                             double factor) {
  std::vector<float> column;
  std::ranges::transform(
      covered.of_cell, std::back_inserter(column), [&](const CellCoverage& cell) {
        return cell.*number * static_cast<float>(factor);
      });
  return column;
}

}  // namespace

ScreenColour coverage_colour(const CellCoverage& cell) {
  return kColours[static_cast<std::size_t>(kind_of(cell))];
}

std::vector<LegendEntry> coverage_legend(const SceneCoverage& covered) {
  std::vector<LegendEntry> all;
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    all.push_back({.name = std::string(kNames[i]), .colour = kColours[i]});
  }
  for (std::size_t i = 0; i < covered.of_cell.size(); ++i) {
    all[static_cast<std::size_t>(kind_of(covered.of_cell[i]))].share +=
        covered.cells.areas_mm2[i] / covered.area_mm2;
  }
  std::erase_if(all, [](const LegendEntry& entry) { return entry.share == 0.0; });
  return all;
}

std::string css_colour(const ScreenColour& colour) {
  return fmt::format("#{:02x}{:02x}{:02x}", colour[0], colour[1], colour[2]);
}

std::vector<CoveragePicture> draw_coverage(const SceneCoverage& covered, ThreadPool& pool) {
  const Painter painter(covered, pool);
  const TriangleMesh& mesh = covered.part->part.mesh;
  const auto draw = [&](std::string caption, const Vector3d& towards) {
    return CoveragePicture{.caption = std::move(caption),
                           .image = painter.draw(fitted_view(mesh, towards, kPictureSide_px))};
  };
  std::vector<CoveragePicture> pictures = {draw("from above, -x side", {0.62, 0.58, -0.53}),
                                           draw("from above, +x side", {-0.62, -0.58, -0.53}),
                                           draw("from below, -x side", {0.62, -0.58, 0.53}),
                                           draw("from below, +x side", {-0.62, 0.58, 0.53})};
  if (covered.gap.area_mm2 > 0.0) {
    pictures.push_back(draw("towards the largest gap", towards_gap(covered, *covered.part->bvh)));
  }
  return pictures;
}

std::string coverage_ply(const SceneCoverage& covered, std::span<const float> smallest_um) {
  const TriangleMesh& cells = covered.cells.mesh;
  TriangleMesh mesh;
  std::vector<std::int32_t> views;
  std::vector<VertexColour> colours;
  for (std::size_t i = 0; i < cells.num_triangles(); ++i) {
    const auto first = static_cast<std::int32_t>(mesh.vertices_mm.size());
    mesh.triangles.push_back({first, first + 1, first + 2});
    for (std::size_t corner = 0; corner < 3; ++corner) {
      mesh.vertices_mm.push_back(cells.vertex(i, corner));
      colours.push_back(coverage_colour(covered.of_cell[i]));
    }
    views.push_back(covered.of_cell[i].views);
  }
  const std::vector<float> incidence_deg =
      column_of(covered, &CellCoverage::incidence_rad, kDegPerRad);
  const std::vector<float> lit_shares = column_of(covered, &CellCoverage::lit_share, 1.0);
  const std::vector<float> pixel_um = column_of(covered, &CellCoverage::pixel_mm, 1e3);
  const std::array<FaceNumbers, 4> numbers = {
      {{.name = "smallest_defect_um", .values = smallest_um},
       {.name = "incidence_deg", .values = incidence_deg},
       {.name = "lit_share", .values = lit_shares},
       {.name = "pixel_um", .values = pixel_um}}};
  return ply_bytes(mesh, {.name = "views", .values = views}, colours, numbers);
}

}  // namespace glint

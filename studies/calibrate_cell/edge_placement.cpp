// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/calibrate_cell/edge_placement.h"

#include <algorithm>

#include "core/file.h"
#include "studies/calibrate/place_run.h"
#include "studies/calibrate_cell/part_views.h"
#include "studies/calibrate_cell/round_pictures.h"
#include "studies/cell/pose_numbers.h"
#include "studies/validate/view_edges.h"

namespace glint::calibrate_cell_detail {
namespace {

using Eigen::Isometry3d;

constexpr std::size_t kMinPictures = 2;
constexpr std::size_t kMinEdges = 20;
constexpr int kMaxPasses = 4;
constexpr double kSettled_px = 0.1;  ///< the part moved less: rendering it again tells nothing new

using EdgesOfPictures = std::vector<std::vector<SeenEdge>>;

/// Writes the files that place_part() reads. @return edges of each picture that shows the part
EdgesOfPictures edges_at(const Isometry3d& base_from_part,
                         const EdgePlacing& placing,
                         const EdgeFiles& files) {
  SceneSettings scene = placing.scene;
  scene.cell->base_from_part->pose = pose_settings(
      {.rotation = base_from_part.linear(), .translation_mm = base_from_part.translation()});
  std::vector<PictureOfView> pictures;
  for (const PartPhoto& photo : placing.photos) {
    pictures.push_back(
        {.file = photo.file, .viewpoint = viewpoint_at(scene, photo.base_from_flange)});
  }
  std::filesystem::remove_all(files.simulated);
  const auto edges = edges_in_pictures(scene, pictures, files.simulated, placing.threads);
  std::string rows = edge_header();
  std::string poses = pose_convention_toml();
  EdgesOfPictures all;
  for (std::size_t i = 0; i < edges.size(); ++i) {
    auto seen = seen_edges(scene, pictures[i].viewpoint, edges[i]);
    if (seen.size() >= kMinEdges) {
      rows += edge_rows(placing.photos[i].name, seen);
      poses += pose_toml(placing.photos[i].name, placing.photos[i].base_from_flange);
      all.push_back(std::move(seen));
    }
  }
  write_file(files.edges, rows);
  write_file(files.poses, poses);
  return all;
}

double largest_move_px(const EdgesOfPictures& pictures,
                       const Isometry3d& before,
                       const Isometry3d& after) {
  double largest_px = 0.0;
  for (const auto& edges : pictures) {
    for (const SeenEdge& edge : edges) {
      const double moved_mm = (after * edge.part_mm - before * edge.part_mm).norm();
      largest_px = std::max(largest_px, edge.px_per_mm * moved_mm);
    }
  }
  return largest_px;
}

}  // namespace

EdgePlacement place_by_edges(const EdgePlacing& placing, const EdgeFiles& files) {
  EdgePlacement result;
  const RigidTransform start = transform_of(placing.scene.cell->base_from_part->pose);
  Isometry3d place = Isometry3d::Identity();
  place.linear() = start.rotation;
  place.translation() = start.translation_mm;
  while (result.passes < kMaxPasses) {
    const EdgesOfPictures seen = edges_at(place, placing, files);
    result.pictures = static_cast<int>(seen.size());
    result.is_found = seen.size() >= kMinPictures;
    if (!result.is_found) {
      break;
    }
    result.place = place_part({{.file = files.edges, .poses = {files.poses}}},
                              {.camera = placing.calibration,
                               .out = files.place,
                               .sets = placing.sets,
                               .threads = placing.threads});
    ++result.passes;
    const Isometry3d next = pose_of(result.place["base_from_part"]);
    const double moved_px = largest_move_px(seen, place, next);
    place = next;
    if (moved_px < kSettled_px) {
      break;
    }
  }
  return result;
}

}  // namespace glint::calibrate_cell_detail

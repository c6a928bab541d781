// SPDX-License-Identifier: GPL-3.0-or-later
//
// From where a part is photographed to find its place, and what the pictures tell. Private to the
// room.
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "studies/definition/scene.h"
#include "studies/validate/view_edges.h"

namespace glint::calibrate_cell_detail {

/// The scene with camera and hand-eye of a calibration, and at least three viewpoints listed: its
/// own, and where they are fewer four around the first one, tilted by 20 degrees about the point
/// that it looks at.
/// @param file         of the scene
/// @param calibration  folder of a calibration
/// @throws ConfigError where the scene does not tell about where the part lies, or the camera is
///         not on the flange; IoError
SceneSettings part_scene(const std::filesystem::path& file,
                         const std::filesystem::path& calibration);

/// Four views around one.
std::vector<Viewpoint> tilted_views(const Viewpoint& viewpoint, double distance_mm);

/// The viewpoint of the scene's camera when the flange is there.
Viewpoint viewpoint_at(const SceneSettings& scene, const Eigen::Isometry3d& base_from_flange);

/// A point on an edge of the part, and where a picture has it.
struct SeenEdge {
  Eigen::Vector3d part_mm = Eigen::Vector3d::Zero();
  Eigen::Vector2d pixel_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  ///< unit; only the distance along it is known
  double px_per_mm = 0.0;                             ///< across the view
};

/// Neighbouring edges share their errors: at most so many are taken of a picture, evenly.
inline constexpr std::size_t kMaxEdges = 120;

/// How far the part may lie from where it was rendered.
struct PlaceDoubt {
  double mm = 0.0;
  double rad = 0.0;  ///< about the part's origin
};

/// Where another edge is as near as the part may be off, as above and below a side face, one may be
/// taken for the other: these are left out.
std::vector<SeenEdge> seen_edges(const SceneSettings& scene,
                                 const Viewpoint& viewpoint,
                                 std::span<const SpaceEdge> edges,
                                 const PlaceDoubt& doubt);

/// Rows of a file of seen points (studies/calibrate/place_file.h).
std::string edge_rows(const std::string& picture, std::span<const SeenEdge> edges);
std::string edge_header();

}  // namespace glint::calibrate_cell_detail

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What one view makes of each cell of a surface: whether it sees it, how finely and how sharply.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "core/thread_pool.h"
#include "metrics/coverage/coverage_settings.h"
#include "simulator/camera/lens_settings.h"
#include "simulator/geometry/bvh/bvh.h"
#include "studies/coverage/surface_cells.h"

namespace glint {

/// How far a view comes with a cell; each presupposes those before. A cell that several views
/// look at is said to be what the best of them makes of it.
enum class CellState : std::uint8_t {
  kUnseen,   ///< beside the picture, turned away, or behind the part
  kOblique,  ///< looked at from too far aside
  kCoarse,   ///< too much of the surface in a pixel
  kBlurred,  ///< out of focus
  kHidden,   ///< behind a light
  kUnlit,    ///< a mirror that shows no light
  kDark,
  kClipped,
  kInspected
};

inline constexpr int kCellStates = 9;

/// "unseen", "oblique", ...
std::string_view state_name(CellState state);

/// A cell that a view sees well by geometry alone.
struct ViewCell {
  CellState state = CellState::kUnseen;
  float pixel_mm = 0.0F;   ///< of the surface in one pixel, the longer way
  float lit_share = 0.0F;  ///< PlaceLight::lit_share; 0: light was not looked at
  Eigen::Vector2f pixel_px = Eigen::Vector2f::Zero();
};

/// One camera at one place.
struct CoverageView {
  PinholeCamera camera;
  LensGeometry lens;
  RigidTransform camera_from_world;
};

/// @throws ConfigError as the camera's and lens' own
CoverageView coverage_view(const CameraSettings& camera,
                           const LensSettings& lens,
                           const Viewpoint& viewpoint);

/// The stretch of a plane in one pixel, the longer way [mm].
/// @param point_mm, normal  of the plane, in the camera's frame; normal . point != 0
double pixel_on_plane_mm(const PinholeIntrinsics& intrinsics,
                         const Eigen::Vector3d& point_mm,
                         const Eigen::Vector3d& normal);

/// One for each cell; cells that pass by geometry are kInspected. One ray for each cell that is in
/// the picture and turned towards the camera. The same for any number of threads.
/// @param bvh   of the part's own mesh
/// @param rays  grows by the number of rays that were traced
std::vector<ViewCell> view_cells(const SurfaceCells& cells,
                                 const Bvh& bvh,
                                 const CoverageView& view,
                                 const CoverageSettings& settings,
                                 ThreadPool& pool,
                                 std::int64_t& rays);

}  // namespace glint

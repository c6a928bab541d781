// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which part of its surface a scene's views inspect. docs/coverage.md
#pragma once

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "metrics/coverage/coverage.h"
#include "metrics/coverage/patches.h"
#include "metrics/coverage/view_choice.h"
#include "metrics/scores.h"
#include "studies/coverage/surface_cells.h"
#include "studies/coverage/view_cells.h"
#include "studies/definition/scene.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// The largest connected piece of the surface that no view inspects.
struct CoverageGap {
  std::vector<std::size_t> cells = {};  ///< ascending
  double area_mm2 = 0.0;
  double size_mm = 0.0;                                ///< between its two farthest ends, about
  Eigen::Vector3d place_mm = Eigen::Vector3d::Zero();  ///< on it, near its middle; scene frame
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  CellState state = CellState::kUnseen;  ///< why most of it is not inspected
};

/// What is known of one cell over all views in use.
struct CellCoverage {
  CellState state = CellState::kUnseen;  ///< of the best view
  std::int32_t views = 0;                ///< that inspect it
  std::int32_t separated = 0;            ///< of these from directions far enough apart
  float pixel_mm = 0.0F;                 ///< of the finest view that inspects it; 0: none does
  float incidence_rad = 0.0F;  ///< of the straightest view that inspects it; 0 where none does
  float lit_share = 0.0F;      ///< the largest PlaceLight::lit_share of all views; 0: no light
};

struct SceneCoverage {
  std::shared_ptr<const BuiltPart> part;  ///< without defects
  SurfaceCells cells;
  std::vector<Viewpoint> viewpoints;  ///< all of the scene
  Visibility visibility;              ///< of all viewpoints
  std::vector<std::size_t> used;      ///< viewpoints in use, in their order
  std::optional<ViewChoice> choice;   ///< how they were chosen; empty: all are in use
  Coverage coverage;                  ///< of those in use; ck with separated views
  std::vector<CellCoverage> of_cell;  ///< of those in use
  std::array<double, kCellStates> state_shares = {};  ///< of the area
  CoverageGap gap;
  double area_mm2 = 0.0;
  bool has_light = false;  ///< brightness was looked at
  std::int64_t rays = 0;   ///< from cells to cameras
};

/// Called before each viewpoint with how many are done, by the caller's thread.
using CoverageProgress = std::function<void(std::size_t done, std::size_t all)>;

/// Ck is told up to this k.
inline constexpr int kLargestK = 5;

/// The part without its defects; as [coverage] says. Light counts where the scene has any. The same
/// bytes for any number of threads.
/// @param largest_k  >= 1: Ck and CellCoverage::separated up to it
/// @throws ConfigError beginning with the key at fault, IoError
SceneCoverage cover_scene(SceneStore& store,
                          const SceneSettings& scene,
                          const CoverageProgress& progress = {},
                          int largest_k = kLargestK);

/// "coverage.c1" and the others of metrics/scores.h.
/// @throws ConfigError, IoError as cover_scene()
Scores coverage_scores(SceneStore& store, const SceneSettings& scene);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// A part ready to be met by rays, with and without its defects.
#pragma once

#include <memory>
#include <vector>

#include "defects/part/defective_part.h"
#include "simulator/geometry/bvh/bvh.h"
#include "simulator/geometry/part/part.h"
#include "simulator/geometry/surface/surface_detail.h"
#include "studies/definition/scene.h"

namespace glint {

/// A part with its BVH, and the outline that must fit into a tunnel.
struct BuiltPart {
  Part part;
  std::unique_ptr<Bvh> bvh;
  std::vector<Eigen::Vector2d> outline_yz_mm;  ///< convex hull of the part's projection along x
  double min_x_mm = 0.0;
  double max_x_mm = 0.0;
};

/// @throws ConfigError beginning with the key at fault, IoError
BuiltPart build_part_with_bvh(const PartSettings& settings);

/// A part with its defects.
struct BuiltDefects {
  std::shared_ptr<const BuiltPart> clean;  ///< without them
  std::shared_ptr<const BuiltPart> built;  ///< with imprints and displacements; clean without any
  DefectivePart made;                      ///< its mesh has moved to `built`
  SurfaceDetail detail;                    ///< the defects realised by their normals
};

/// How steep its defects are [rad], in the order of made.defects; see defects/part/defect_slope.h.
std::vector<double> defect_slopes_rad(const BuiltDefects& part);

/// What draws and realises a scene's defects, for any number of seeds.
/// @throws ConfigError beginning with the key at fault
DefectMaker defect_maker(const SceneSettings& scene, const std::shared_ptr<const BuiltPart>& clean);

/// The scene's part with the defects of one seed.
/// @param maker  of a scene with the same part, groups and [imprint]
/// @throws ConfigError as DefectMaker::make()
BuiltDefects build_defects(const SceneSettings& scene,
                           std::shared_ptr<const BuiltPart> clean,
                           const DefectMaker& maker,
                           std::uint64_t seed,
                           const std::function<void(int)>& progress = {});

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the edges of a part lie in real pictures, looked for where the same views, rendered, have
// them.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "studies/compare/fit/cause_fit.h"
#include "studies/definition/scene.h"
#include "studies/validate/geometry_fit.h"

namespace glint {

/// A real picture and from where it was taken.
struct PictureOfView {
  std::filesystem::path file;
  Viewpoint viewpoint;
};

/// The middle of all edges in the scene's frame; empty: there are none.
std::optional<Eigen::Vector3d> middle_of_edges(std::span<const ViewEdges> views);

/// Renders the views of the scene into a folder, which it makes, and compares.
/// @return of each picture its edges in the order of their boundaries; none where the part is not
///         found in it
/// @throws ConfigError, IoError
std::vector<std::vector<SpaceEdge>> edges_in_pictures(const SceneSettings& scene,
                                                      std::span<const PictureOfView> pictures,
                                                      const std::filesystem::path& folder,
                                                      int threads);

}  // namespace glint

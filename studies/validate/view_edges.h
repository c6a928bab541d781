// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where the edges of a part lie in real pictures, looked for where the same views, rendered, have
// them.
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "studies/compare/fit/cause_fit.h"
#include "studies/definition/scene.h"

namespace glint {

/// A real picture and from where it was taken.
struct PictureOfView {
  std::filesystem::path file;
  Viewpoint viewpoint;
};

/// Renders the views of the scene into a folder, which it makes, and compares.
/// @return of each picture its edges in the order of their boundaries; none where the part is not
///         found in it
/// @throws ConfigError, IoError
std::vector<std::vector<SpaceEdge>> edges_in_pictures(const SceneSettings& scene,
                                                      std::span<const PictureOfView> pictures,
                                                      const std::filesystem::path& folder,
                                                      int threads);

}  // namespace glint

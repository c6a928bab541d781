// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/validate/view_edges.h"

#include <algorithm>
#include <iterator>

#include "studies/compare/causes.h"
#include "studies/compare/compared_pair.h"
#include "studies/validate/compared_view.h"

namespace glint {

std::optional<Eigen::Vector3d> middle_of_edges(std::span<const ViewEdges> views) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0.0;
  for (const ViewEdges& view : views) {
    const RigidTransform scene_from_camera = inverse(view.camera_from_scene);
    for (const SpaceEdge& edge : view.edges) {
      sum += scene_from_camera * edge.in_camera_mm;
      count += 1.0;
    }
  }
  return count > 0.0 ? std::optional<Eigen::Vector3d>(sum / count) : std::nullopt;
}

std::vector<std::vector<SpaceEdge>> edges_in_pictures(const SceneSettings& scene,
                                                      std::span<const PictureOfView> pictures,
                                                      const std::filesystem::path& folder,
                                                      int threads) {
  std::vector<Viewpoint> viewpoints;
  std::ranges::transform(pictures, std::back_inserter(viewpoints), &PictureOfView::viewpoint);
  const auto sources = validate_detail::render_for(scene, viewpoints, folder, threads);
  std::vector<std::vector<SpaceEdge>> edges;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const ComparedPair pair = compare_pair(
        {.simulated = sources[i], .real = {.name = sources[i].name, .picture = pictures[i].file}},
        {});
    edges.push_back(space_edges(pair, validate_detail::with_views(scene, {viewpoints[i]})));
  }
  return edges;
}

}  // namespace glint

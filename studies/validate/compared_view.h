// SPDX-License-Identifier: GPL-3.0-or-later
//
// A real picture beside the same view, rendered: rendering, comparison, inspection. Private to the
// room.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/thread_pool.h"
#include "studies/compare/compared_pair.h"
#include "studies/validate/validated_designs.h"

namespace glint::validate_detail {

/// The scene with these viewpoints as listed ones, and without pictures to compare with.
SceneSettings with_views(SceneSettings scene, const std::vector<Viewpoint>& views);

/// Renders the views into a folder, which it makes. @return a source for each, in their order
std::vector<CompareSource> render_for(const SceneSettings& scene,
                                      const std::vector<Viewpoint>& views,
                                      const std::filesystem::path& folder,
                                      int threads);

/// Real minus simulated variance of the edges' blur [px^2], median; empty: no edges.
std::optional<double> blur_difference(const ComparedPair& pair);

/// Defects seen on both sides of a pair.
struct SeenContrasts {
  int seen = 0;
  int apart = 0;              ///< differ by more than the share, and beyond their intervals
  int defects = 0;            ///< known ones
  int defects_simulated = 0;  ///< of these not outside the simulated picture
  int defects_real = 0;       ///< of these not outside the photograph
  int found_simulated = 0;
  int found_real = 0;
  int right_simulated = 0;  ///< of those found there, of the class that the defect has
  int right_real = 0;
  int same_class = 0;  ///< of those found on both sides
  int found_both = 0;

  void add(const SeenContrasts& other);
};

/// Inspects both sides and puts "inspection" into the row. A part that cannot be inspected gets a
/// note.
SeenContrasts inspect_both(const ComparedPair& pair,
                           double contrast_share,
                           ThreadPool& pool,
                           nlohmann::ordered_json& row);

/// overlay.png, simulated.png, difference.exr. @throws IoError
void write_pair(const ComparedPair& pair, const std::filesystem::path& folder);

}  // namespace glint::validate_detail

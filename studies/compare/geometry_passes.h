// SPDX-License-Identifier: GPL-3.0-or-later
//
// Geometry of views whose folder has none, as those of `glint run`: rendered when it is needed.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>

#include "studies/compare/compared_pair.h"
#include "studies/imaging/scene_store.h"
#include "studies/output/scratch_folder.h"

namespace glint {

/// Renders each view once, however often it is compared, and keeps its file until it has been.
class GeometryPasses {
 public:
  /// @param store  keeps the part, which is that of all designs of a run
  /// @param pairs  that will be completed and released
  GeometryPasses(SceneStore& store, std::span<const ComparePair> pairs);

  /// Gives a view that has a scene but no geometry that of one pass of camera rays, where edges
  /// were located in both pictures: without, there is nothing that it could name or explain.
  /// @returns what is missing where that cannot be had, as a sentence; empty: nothing
  std::string complete(ComparedPair& pair);

  /// The pair's geometry has been read. Removes the file after the last pair of a view.
  void release(ComparedPair& pair);

  double render_s() const { return render_s_; }  ///< spent so far

 private:
  struct Made {
    std::filesystem::path file;  ///< empty: could not be rendered
    std::string missing;         ///< why
  };

  Made make(const ComparedPicture& picture);
  std::filesystem::path render(const std::filesystem::path& scene);

  SceneStore& store_;
  std::optional<ScratchFolder> folder_;
  std::map<std::filesystem::path, int>
      to_come_;                                 ///< pairs of views without geometry, by scene.toml
  std::map<std::filesystem::path, Made> made_;  ///< by scene.toml
  int num_rendered_ = 0;
  double render_s_ = 0.0;
};

}  // namespace glint

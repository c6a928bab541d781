// SPDX-License-Identifier: GPL-3.0-or-later
//
// Geometry of views whose folder has none, as those of `glint run`: rendered when it is needed.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "core/thread_pool.h"
#include "studies/compare/compared_picture.h"
#include "studies/output/scratch_folder.h"

namespace glint {

/// Renders each view once, however often it is compared. Its files go with it.
class GeometryPasses {
 public:
  explicit GeometryPasses(ThreadPool& pool) : pool_(pool) {}

  /// Gives a view that has a scene but no geometry that of one pass of camera rays.
  /// @returns what is missing where that cannot be had, as a sentence; empty: nothing
  std::string complete(ComparedPicture& picture);

  double render_s() const { return render_s_; }  ///< spent so far

 private:
  struct Made {
    std::filesystem::path file;  ///< empty: could not be rendered
    std::string missing;         ///< why
  };

  Made make(const ComparedPicture& picture);
  std::filesystem::path render(const std::filesystem::path& scene);

  ThreadPool& pool_;
  std::optional<ScratchFolder> folder_;
  std::map<std::filesystem::path, Made> made_;  ///< by scene.toml
  double render_s_ = 0.0;
};

}  // namespace glint

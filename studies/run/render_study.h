// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint render` of a scene with one viewpoint: the frames of its scan in a folder.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "studies/definition/study.h"

namespace glint {

/// Asks whether `glint render` may write there. @throws ConfigError: also where another study's
/// rendering is
void check_render_folder(const Study& study, const std::filesystem::path& out);

/// Removes the folders that an earlier rendering of other views left in a folder: those of the
/// names that views are written to, and nothing else.
/// @param kept  names of the folders of the views that are there now; empty: nothing is removed
void remove_other_views(const std::filesystem::path& out, const std::vector<std::string>& kept);

/// Renders the study's own scene into a folder; no search. Of scenes with allows_many_viewpoints()
/// render_views() shows more.
nlohmann::ordered_json render_study(const Study& study,
                                    const std::filesystem::path& out,
                                    int threads);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint render` of a scene with one viewpoint: the frames of its scan in a folder.
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "studies/definition/study.h"

namespace glint {

/// Asks whether `glint render` may write there. @throws ConfigError
void check_render_folder(const Study& study, const std::filesystem::path& out);

/// Renders the study's own scene into a folder; no search. Of scenes with allows_many_viewpoints()
/// render_views() shows more.
nlohmann::ordered_json render_study(const Study& study,
                                    const std::filesystem::path& out,
                                    int threads);

}  // namespace glint

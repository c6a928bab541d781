// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint render`: the pictures of a scene in a folder.
#pragma once

#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "studies/definition/study.h"

namespace glint {

/// Renders the study's own scene into a folder; no search. Scenes that need paths go to
/// render_views().
nlohmann::ordered_json render_study(const Study& study,
                                    const std::filesystem::path& out,
                                    int threads);

}  // namespace glint

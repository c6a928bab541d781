// SPDX-License-Identifier: GPL-3.0-or-later
//
// The folder of `glint frontier`: each of its charts has files of its own, which lie side by side,
// also beside those of a run.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "studies/definition/study.h"

namespace glint {

/// Of the progress bar of a chart, whose work is a share from 0 to 1.
inline constexpr int kProgressSteps = 1000;

/// @throws ConfigError when the folder holds something else, results of another study, or what the
///         study is made of
void check_frontier_folder(const Study& study, const std::filesystem::path& out);

/// Writes a chart's files, and run.json where the folder is no run's.
/// @param files    { name, content }
/// @param origin   what run.json tells beside the program: "threads", "timings"
/// @throws IoError
void write_frontier_folder(const Study& study,
                           const std::filesystem::path& out,
                           const std::vector<std::pair<std::string, std::string>>& files,
                           const nlohmann::ordered_json& origin);

/// null where there is none.
nlohmann::ordered_json optional_json(const std::optional<double>& value);

/// The page of a chart: a report with one sentence on top.
/// @param key   of the chart's object in the page: "frontier"
std::string frontier_page_html(const Study& study,
                               const std::string& subtitle,
                               const std::string& sentence,
                               const std::string& key,
                               const nlohmann::ordered_json& json,
                               const std::vector<std::string>& notes);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "optimizer/storage/storage.h"
#include "studies/definition/study.h"

namespace glint {

/// What the report of one run directory, or of several side by side, shows, completed with its
/// verdict (studies/report/report.h). @throws IoError when a folder is no run directory
nlohmann::ordered_json report_data(const std::vector<std::filesystem::path>& runs);

/// The report of one run directory in depth, or of several side by side, made from their files.
/// @throws IoError when a folder is no run directory
std::string report_html(const std::vector<std::filesystem::path>& runs);

/// What the derivatives of a search leave out: the distinct remarks of its trials, each with the
/// range of its count and the number of evaluations it was made in. Empty without
/// derivatives.
std::vector<std::string> derivative_remarks(const Storage& storage);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// A study beside the one that a run directory was begun with.
#pragma once

#include <string>
#include <vector>

#include "studies/definition/study.h"

namespace glint {

/// The study with the title of a recorded one; the title changes no result.
/// @param recorded  resolved_text() of that study, also by an earlier program
/// @throws ConfigError for a text that is none
Study with_title_of(Study study, const std::string& recorded);

/// "scan.positions is 12, was 24": every key in which the study differs from the recorded one, but
/// for title and budget, in the order of the study's tables. @throws ConfigError as above
std::vector<std::string> changed_keys(const Study& study, const std::string& recorded);

}  // namespace glint

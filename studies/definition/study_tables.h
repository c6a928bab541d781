// SPDX-License-Identifier: GPL-3.0-or-later
//
// The tables that make a study out of a scene: [variables] [objective] [constraints] [search]
// [budget] [sorting] [pod]. Used by study.cpp only.
#pragma once

#include "studies/definition/study.h"

namespace glint {

void read_study_tables(Study& study, std::vector<std::string>& errors);

/// Adds [search] and [budget], and [sorting] and [pod] where there are any, with every key present.
void write_study_tables(const Study& study, ConfigNode& root);

/// The sentence for a path that the scene does not have, with the nearest one.
std::string unknown_path(const Study& study, const std::string& path, const Place& place);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The tables that make a study out of a scene: [variables] [objective] [constraints] [search]
// [budget] [accuracy] [sorting] [pod]. Read and written by study.cpp only; the rows of their keys
// are for all.
#pragma once

#include <string>
#include <vector>

#include "core/config/config.h"
#include "core/config/key_writer.h"
#include "core/config/keys.h"
#include "studies/definition/study.h"

namespace glint {

void read_study_tables(Study& study, std::vector<Problem>& errors);

/// Adds [search] and [budget], and [accuracy], [sorting] and [pod] where there are any, with every
/// key present.
void write_study_tables(const Study& study, ConfigNode& root);

/// Rows of the key table for the tables that only a study has.
std::vector<KeyRow> study_keys();

/// The sentence for a path that the scene does not have, with the nearest one.
Problem unknown_path(const Study& study, const std::string& path, const Place& place);

}  // namespace glint

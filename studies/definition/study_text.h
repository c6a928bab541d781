// SPDX-License-Identifier: GPL-3.0-or-later
//
// A study as text: whole, for readers elsewhere, and as a hash.
#pragma once

#include <string>

#include "studies/definition/study.h"

namespace glint {

/// The whole study with every key present, as TOML; load_study() of it gives the same study.
std::string resolved_text(const Study& study);

/// The same for readers elsewhere: files by their names, without their folders.
std::string shown_text(const Study& study);

/// A text without the folders of the files that the study names by their full paths.
std::string without_folders(std::string text, const Study& study);

/// Hash of everything that changes results; the budget is left out.
std::string config_hash(const Study& study);

}  // namespace glint

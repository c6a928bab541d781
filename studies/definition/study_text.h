// SPDX-License-Identifier: GPL-3.0-or-later
//
// A study as text: whole, for readers elsewhere, as a hash, and what differs from a recorded one.
#pragma once

#include <string>
#include <vector>

#include "studies/definition/study.h"

namespace glint {

/// The whole study with every key present, as TOML; load_study() of it gives the same study.
std::string resolved_text(const Study& study);

/// The same for readers elsewhere: files by their names, without their folders.
std::string shown_text(const Study& study);

/// A text without the folders of the files that the study names by their full paths.
std::string without_folders(std::string text, const Study& study);

/// Hash of everything that changes recorded results. The budget is left out, and so are prototypes,
/// which each run scores anew, unless [accuracy], [sorting] or [pod] keep what depends on them.
std::string config_hash(const Study& study);

/// Whether a study was recorded by this hash, perhaps under another title, with other prototypes or
/// by an earlier program. @param recorded  its resolved_text() then
/// @throws ConfigError for a text that is none
bool is_recorded_as(const Study& study, const std::string& hash, const std::string& recorded);

/// The study with the title of a recorded one; the title changes no result.
/// @param recorded  resolved_text() of that study, also by an earlier program
/// @throws ConfigError for a text that is none
Study with_title_of(Study study, const std::string& recorded);

/// "scan.positions is 12, was 24": every key in which the study differs from the recorded one, but
/// for what its hash leaves out and the title, in the order of the study's tables. @throws
/// ConfigError as above
std::vector<std::string> changed_keys(const Study& study, const std::string& recorded);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// A study as text: whole, for readers elsewhere, as a hash, and what differs from a recorded one.
#pragma once

#include <optional>
#include <span>
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

/// A key in which a study differs from a recorded one. Values are texts as in a file.
struct ChangedKey {
  std::string path;                ///< "scan.positions", "objective.0.reference"
  std::optional<std::string> is;   ///< none: the key is gone
  std::optional<std::string> was;  ///< none: the key was not there

  bool operator==(const ChangedKey&) const = default;
};

/// Every key in which the study differs from the recorded one, but for what its hash leaves out and
/// the title, in the order of the study's tables. @throws ConfigError as above
std::vector<ChangedKey> changed_keys(const Study& study, const std::string& recorded);

/// For people: "scan.positions is 12, was 24".
std::vector<std::string> change_texts(std::span<const ChangedKey> changes);

}  // namespace glint

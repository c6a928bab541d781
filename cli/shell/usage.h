// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the command line takes, as plain values: the one source of help, man pages and completions.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace glint {

/// An option, or an argument without one.
struct OptionUsage {
  std::string name;   ///< "--jobs"; of an argument "STUDY.toml"
  std::string value;  ///< what follows the name: "N", "DIR", "mm|cm"; empty for a flag
  std::string what;
  std::string allowed;       ///< "1 to 1024"; empty: see what
  std::string default_text;  ///< empty: none
  bool is_argument = false;
  bool is_required = false;
  bool is_repeated = false;

  /// The words that a value is one of; none where it is anything else.
  std::vector<std::string> words() const;
};

struct VerbUsage {
  std::string name;  ///< "run"
  std::string what;
  std::string example;  ///< one command a line
  std::vector<OptionUsage> options;
};

struct ProgramUsage {
  std::string name;
  std::string what;
  std::vector<VerbUsage> verbs;

  /// nullptr when there is no such verb.
  const VerbUsage* find(const std::string& verb) const;
  std::vector<std::string> verb_names() const;
};

/// "glint run STUDY.toml [OPTION]..."
std::string synopsis(const ProgramUsage& program, const VerbUsage& verb);

/// "--jobs N", "STUDY.toml"
std::string shown_name(const OptionUsage& option);

/// What it does, what is allowed, what holds without it.
std::string shown_meaning(const OptionUsage& option);

/// All verbs, a line each.
std::string help_text(const ProgramUsage& program);

/// One verb with its options and an example.
std::string help_text(const ProgramUsage& program, const VerbUsage& verb);

/// One line: what no verb of that name is told, with the nearest.
std::string unknown_verb(const ProgramUsage& program, const std::string& name);

/// One line: what is wrong with a command line that the parser refuses.
/// @param words     of the command line, without the program's name
/// @param unparsed  what the parser made nothing of
/// @param verb      nullptr: none was found
/// @param problem   what the parser says
std::string usage_problem(const ProgramUsage& program,
                          std::span<const std::string> words,
                          std::span<const std::string> unparsed,
                          const VerbUsage* verb,
                          const std::string& problem);

}  // namespace glint

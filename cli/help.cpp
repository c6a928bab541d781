// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <iostream>

#include <fmt/format.h>

#include "cli/commands.h"
#include "cli/shell/completion.h"
#include "cli/shell/man_page.h"
#include "cli/shell/usage.h"
#include "studies/definition/key_table.h"
#include "studies/output/provenance.h"

namespace glint {
namespace {

/// Those that a shell can offer as they are.
std::vector<std::string> plain_keys() {
  std::vector<std::string> keys;
  for (const KeyRow& row : all_keys()) {
    if (row.path.find_first_of("\"<") == std::string::npos) {
      keys.push_back(row.path);
    }
  }
  return keys;
}

std::string completion_of(const ProgramUsage& program, const std::string& shell) {
  const std::vector<std::string> keys = plain_keys();
  if (shell == "bash") {
    return bash_completion(program, keys);
  }
  if (shell == "zsh") {
    return zsh_completion(program, keys);
  }
  if (shell == "fish") {
    return fish_completion(program, keys);
  }
  throw ConfigError(fmt::format("--completion {}: must be bash, zsh or fish", shell));
}

std::string asked_for(const ProgramUsage& program, const HelpArguments& arguments) {
  if (!arguments.shell.empty()) {
    return completion_of(program, arguments.shell);
  }
  if (arguments.verb.empty()) {
    return arguments.is_man ? man_page(program, program_version()) : help_text(program);
  }
  const VerbUsage* verb = program.find(arguments.verb);
  if (verb == nullptr) {
    throw ConfigError(unknown_verb(program, arguments.verb));
  }
  return arguments.is_man ? man_page(program, *verb, program_version()) : help_text(program, *verb);
}

}  // namespace

int help_command(const ProgramUsage& program, const HelpArguments& arguments) {
  std::cout << asked_for(program, arguments) << std::flush;
  if (!std::cout) {
    throw IoError("stdout: cannot be written");
  }
  return kExitDone;
}

}  // namespace glint

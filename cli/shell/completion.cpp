// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/shell/completion.h"

#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/text.h"

namespace glint {
namespace {

/// What is offered for a value.
enum class Offer { kNothing, kWords, kKeys, kAssignments, kVerbs, kFolders, kFiles };

Offer offer_of(const OptionUsage& option) {
  const std::string& value = option.value;
  if (!option.words().empty()) {
    return Offer::kWords;
  }
  if (value == "KEY") {
    return Offer::kKeys;
  }
  if (value == "KEY=VALUE") {
    return Offer::kAssignments;
  }
  if (value == "VERB") {
    return Offer::kVerbs;
  }
  if (value == "DIR") {
    return Offer::kFolders;
  }
  return value.find("FILE") != std::string::npos ? Offer::kFiles : Offer::kNothing;
}

std::string replaced(std::string text, std::string_view what, std::string_view by) {
  for (std::size_t at = text.find(what); at != std::string::npos;
       at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
  return text;
}

/// In single quotes, for every one of the three shells.
std::string quoted(const std::string& text) {
  return "'" + replaced(text, "'", "'\\''") + "'";
}

/// fish takes \' within quotes, and no other way of leaving them.
std::string fish_quoted(const std::string& text) {
  return "'" + replaced(replaced(text, "\\", "\\\\"), "'", "\\'") + "'";
}

std::string bash_offer(const OptionUsage& option) {
  switch (offer_of(option)) {
    case Offer::kNothing:
      return "COMPREPLY=()";
    case Offer::kWords:
      return fmt::format("COMPREPLY=($(compgen -W {} -- \"$cur\"))",
                         quoted(join(option.words(), " ")));
    case Offer::kKeys:
      return R"(COMPREPLY=($(compgen -W "$keys" -- "$cur")))";
    case Offer::kAssignments:
      return R"(COMPREPLY=($(compgen -S = -W "$keys" -- "$cur")); compopt -o nospace)";
    case Offer::kVerbs:
      return R"(COMPREPLY=($(compgen -W "$verbs" -- "$cur")))";
    case Offer::kFolders:
      return "COMPREPLY=($(compgen -d -- \"$cur\"))";
    case Offer::kFiles:
      break;
  }
  return "COMPREPLY=($(compgen -f -- \"$cur\"))";
}

/// What is offered for arguments: those of the last kind, before them words where the first is one.
std::string bash_arguments(const VerbUsage& verb) {
  std::string first;
  std::string last = "COMPREPLY=()";
  for (const OptionUsage& option : verb.options) {
    if (option.is_argument) {
      first = first.empty() && !option.words().empty() ? bash_offer(option) : first;
      last = bash_offer(option);
    }
  }
  return first.empty() || first == last
             ? last
             : fmt::format("if ((COMP_CWORD == 2)); then {}; else {}; fi", first, last);
}

/// The branch of a verb: values of options, then names of options, then arguments.
std::string bash_verb(const VerbUsage& verb) {
  std::string values;
  std::vector<std::string> names;
  for (const OptionUsage& option : verb.options) {
    if (option.is_argument) {
      continue;
    }
    names.push_back(option.name);
    if (!option.value.empty()) {
      values += fmt::format("        {}) {}; return ;;\n", option.name, bash_offer(option));
    }
  }
  const std::string choice =
      values.empty() ? "" : fmt::format("      case $prev in\n{}      esac\n", values);
  return fmt::format(
      "    {})\n{}      if [[ $cur == -* ]]; then\n"
      "        COMPREPLY=($(compgen -W '{}' -- \"$cur\"))\n"
      "      else\n        {}\n      fi\n      ;;\n",
      verb.name,
      choice,
      join(names, " "),
      bash_arguments(verb));
}

std::string zsh_escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (c == '[' || c == ']' || c == ':' || c == '\\') {
      result += '\\';
    }
    result += c;
  }
  return result;
}

std::string zsh_action(const OptionUsage& option) {
  switch (offer_of(option)) {
    case Offer::kNothing:
      return " ";
    case Offer::kWords:
      return "(" + join(option.words(), " ") + ")";
    case Offer::kKeys:
      return "compadd -a keys";
    case Offer::kAssignments:
      return "compadd -S = -a keys";
    case Offer::kVerbs:
      return "compadd -a names";
    case Offer::kFolders:
      return "_files -/";
    case Offer::kFiles:
      break;
  }
  return "_files";
}

std::string zsh_verb(const VerbUsage& verb) {
  std::string rows;
  int position = 1;
  for (const OptionUsage& option : verb.options) {
    std::string spec;
    if (option.is_argument) {
      const std::string place = option.is_repeated ? "*" : fmt::format("{}", position++);
      spec = fmt::format("{}:{}:{}", place, zsh_escaped(option.name), zsh_action(option));
    } else {
      spec = fmt::format(
          "{}{}[{}]", option.is_repeated ? "*" : "", option.name, zsh_escaped(option.what));
      spec += option.value.empty()
                  ? ""
                  : fmt::format(":{}:{}", zsh_escaped(option.value), zsh_action(option));
    }
    rows += " \\\n        " + quoted(spec);
  }
  return fmt::format("    {})\n      _arguments{}\n      ;;\n", verb.name, rows);
}

std::string fish_option(const std::string& program,
                        const VerbUsage& verb,
                        const OptionUsage& option) {
  const std::string words = join(option.words(), " ");
  const std::string before =  // an argument of words is the first one
      option.is_argument && !words.empty() ? "; and not __fish_seen_subcommand_from " + words : "";
  std::string line = fmt::format(
      "complete -c {} -n '__fish_seen_subcommand_from {}{}'", program, verb.name, before);
  if (!option.is_argument) {
    line += fmt::format(" -l {}{}", option.name.substr(2), option.value.empty() ? "" : " -r");
  }
  switch (offer_of(option)) {
    case Offer::kNothing:
      line += option.value.empty() ? "" : " -f";
      break;
    case Offer::kWords:
      line += " -f -a " + fish_quoted(words);
      break;
    case Offer::kKeys:
      line += fmt::format(" -f -a '$__{}_keys'", program);
      break;
    case Offer::kAssignments:
      line += fmt::format(" -f -a '$__{}_keys='", program);
      break;
    case Offer::kVerbs:
      line += fmt::format(" -f -a '$__{}_verbs'", program);
      break;
    case Offer::kFolders:
      line += " -f -a '(__fish_complete_directories)'";
      break;
    case Offer::kFiles:
      line += " -F";
      break;
  }
  return line + (option.is_argument ? "" : " -d " + fish_quoted(option.what)) + "\n";
}

}  // namespace

std::string bash_completion(const ProgramUsage& program, std::span<const std::string> keys) {
  std::string branches;
  for (const VerbUsage& verb : program.verbs) {
    branches += bash_verb(verb);
  }
  return fmt::format(
      "# bash completion of {0}\n_{0}() {{\n"
      "  local cur=${{COMP_WORDS[COMP_CWORD]}} prev=${{COMP_WORDS[COMP_CWORD - 1]}}\n"
      "  local verbs='{1}'\n  local keys='{2}'\n"
      "  if ((COMP_CWORD == 1)); then\n"
      "    COMPREPLY=($(compgen -W \"$verbs --help --version\" -- \"$cur\"))\n    return\n  fi\n"
      "  case ${{COMP_WORDS[1]}} in\n{3}  esac\n}}\ncomplete -o filenames -F _{0} {0}\n",
      program.name,
      join(program.verb_names(), " "),
      join(keys, " "),
      branches);
}

std::string zsh_completion(const ProgramUsage& program, std::span<const std::string> keys) {
  std::string verbs;
  std::string branches;
  for (const VerbUsage& verb : program.verbs) {
    verbs += "    " + quoted(zsh_escaped(verb.name) + ":" + verb.what) + "\n";
    branches += zsh_verb(verb);
  }
  return fmt::format(
      "#compdef {0}\n_{0}() {{\n  local -a verbs names keys\n  verbs=(\n{1}  )\n"
      "  names=({2})\n  keys=({3})\n"
      "  if (( CURRENT == 2 )); then\n    _describe verb verbs\n    return\n  fi\n"
      "  local verb=$words[2]\n  shift words\n  (( CURRENT-- ))\n"
      "  case $verb in\n{4}  esac\n}}\n_{0} \"$@\"\n",
      program.name,
      verbs,
      join(program.verb_names(), " "),
      join(keys, " "),
      branches);
}

std::string fish_completion(const ProgramUsage& program, std::span<const std::string> keys) {
  std::string text = fmt::format(
      "# fish completion of {0}\nset -g __{0}_verbs {1}\nset -g __{0}_keys {2}\n"
      "complete -c {0} -f\n",
      program.name,
      join(program.verb_names(), " "),
      join(keys, " "));
  for (const VerbUsage& verb : program.verbs) {
    text += fmt::format("complete -c {} -n __fish_use_subcommand -a {} -d {}\n",
                        program.name,
                        verb.name,
                        fish_quoted(verb.what));
    for (const OptionUsage& option : verb.options) {
      text += fish_option(program.name, verb, option);
    }
  }
  return text;
}

}  // namespace glint

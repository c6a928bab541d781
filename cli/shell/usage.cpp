// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/shell/usage.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/text.h"

namespace glint {
namespace {

constexpr std::size_t kWidth = 100;
constexpr std::size_t kIndent = 27;

/// A name and its meaning side by side, the meaning broken at blanks.
std::string help_row(const std::string& name, const std::string& meaning) {
  std::string text = "  " + name;
  std::size_t column = text.size();
  if (column + 2 > kIndent) {
    text += "\n";
    column = 0;
  }
  text += std::string(kIndent - column, ' ');
  column = kIndent;
  for (const std::string& word : split(meaning, ' ')) {
    const bool is_first = column == kIndent;
    if (!is_first && column + 1 + word.size() > kWidth) {
      text += "\n" + std::string(kIndent, ' ');
      column = kIndent;
    } else if (!is_first) {
      text += ' ';
      ++column;
    }
    text += word;
    column += word.size();
  }
  return text + "\n";
}

}  // namespace

std::vector<std::string> OptionUsage::words() const {
  const bool is_kind =  // of value: "FILE|KEYS"
      std::ranges::any_of(value, [](char c) { return c >= 'A' && c <= 'Z'; });
  const bool is_choice = value.find('|') != std::string::npos && !is_kind;
  return is_choice ? split(value, '|') : std::vector<std::string>{};
}

const VerbUsage* ProgramUsage::find(const std::string& verb) const {
  const auto found = std::ranges::find(verbs, verb, &VerbUsage::name);
  return found == verbs.end() ? nullptr : &*found;
}

std::vector<std::string> ProgramUsage::verb_names() const {
  std::vector<std::string> names;
  for (const VerbUsage& verb : verbs) {
    names.push_back(verb.name);
  }
  return names;
}

std::string synopsis(const ProgramUsage& program, const VerbUsage& verb) {
  std::string text = fmt::format("{} {}", program.name, verb.name);
  for (const OptionUsage& option : verb.options) {
    if (option.is_argument) {
      const std::string name = option.name + (option.is_repeated ? "..." : "");
      text += option.is_required ? " " + name : fmt::format(" [{}]", name);
    } else if (option.is_required) {
      text += " " + shown_name(option);
    }
  }
  return text + " [OPTION]...";
}

std::string shown_name(const OptionUsage& option) {
  return option.is_argument || option.value.empty() ? option.name
                                                    : option.name + " " + option.value;
}

std::string shown_meaning(const OptionUsage& option) {
  std::vector<std::string> remarks;
  if (!option.allowed.empty()) {
    remarks.push_back(option.allowed);
  }
  if (option.is_argument && !option.words().empty()) {
    remarks.push_back(join(option.words(), ", "));
  }
  if (!option.default_text.empty()) {
    remarks.push_back("default " + option.default_text);
  }
  if (option.is_repeated && !option.is_argument) {
    remarks.emplace_back("may be repeated");
  }
  return remarks.empty() ? option.what : fmt::format("{} ({})", option.what, join(remarks, "; "));
}

std::string help_text(const ProgramUsage& program) {
  std::string text = fmt::format(
      "{0}\n\nUsage: {1} VERB [ARGUMENT]... [OPTION]...\n\nVerbs:\n", program.what, program.name);
  for (const VerbUsage& verb : program.verbs) {
    text += help_row(verb.name, verb.what);
  }
  text += "\nOptions:\n" + help_row("-h, --help", "print this text; after a verb, its options") +
          help_row("-V, --version", "print version, compiler and libraries");
  return text +
         fmt::format("\n{} help VERB shows the options of a verb and an example.\n", program.name);
}

std::string help_text(const ProgramUsage& program, const VerbUsage& verb) {
  std::string text = fmt::format(
      "{} {}: {}\n\nUsage: {}\n", program.name, verb.name, verb.what, synopsis(program, verb));
  for (const bool is_argument : {true, false}) {
    std::string rows;
    for (const OptionUsage& option : verb.options) {
      if (option.is_argument == is_argument) {
        rows += help_row(shown_name(option), shown_meaning(option));
      }
    }
    if (!rows.empty()) {
      text += fmt::format("\n{}:\n{}", is_argument ? "Arguments" : "Options", rows);
    }
  }
  return text + fmt::format("\nExample:\n  {}\n", verb.example);
}

std::string unknown_verb(const ProgramUsage& program, const std::string& name) {
  return fmt::format("{} {}: no such verb, the nearest is {}",
                     program.name,
                     name,
                     nearest(name, program.verb_names()));
}

std::string usage_problem(const ProgramUsage& program,
                          std::span<const std::string> words,
                          std::span<const std::string> unparsed,
                          const VerbUsage* verb,
                          const std::string& problem) {
  if (verb == nullptr) {
    const std::string first = words.empty() ? "" : words.front();
    return first.empty() || first.starts_with("-")
               ? fmt::format(
                     "{}: a verb is needed: {}", program.name, join(program.verb_names(), ", "))
               : unknown_verb(program, first);
  }
  std::vector<std::string> names;
  for (const OptionUsage& option : verb->options) {
    names.push_back(option.name);
  }
  for (const std::string& extra : unparsed) {
    if (extra.starts_with("-")) {
      return fmt::format("{} {}: {}: no such option, the nearest is {}",
                         program.name,
                         verb->name,
                         extra,
                         nearest(extra, names));
    }
  }
  return fmt::format("{} {}: {}", program.name, verb->name, problem);
}

}  // namespace glint

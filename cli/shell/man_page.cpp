// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/shell/man_page.h"

#include <array>
#include <cctype>

#include <fmt/format.h>

#include "cli/shell/exit_codes.h"
#include "core/text.h"

namespace glint {
namespace {

/// Text as groff takes it: hyphens that are typed, no line that begins with a control character.
std::string escaped(const std::string& text) {
  std::string result;
  for (const char c : text) {
    if (result.empty() && (c == '.' || c == '\'')) {
      result += "\\&";
    }
    switch (c) {
      case '\\':
        result += "\\e";
        break;
      case '-':
        result += "\\-";
        break;
      case '\'':
        result += "\\(aq";
        break;
      case '"':
        result += "\\(dq";
        break;
      case '~':
        result += "\\(ti";
        break;
      case '^':
        result += "\\(ha";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string upper(std::string text) {
  for (char& c : text) {
    c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  return text;
}

std::string head(const std::string& page, const std::string& what, const std::string& version) {
  return fmt::format(".TH {} 1 \"\" \"Glint {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n",
                     upper(escaped(page)),
                     version,
                     escaped(page),
                     escaped(what));
}

/// A term with its meaning below it.
std::string entry(const std::string& term, const std::string& meaning) {
  return fmt::format(".TP\n.B {}\n{}\n", escaped(term), escaped(meaning));
}

std::string exit_codes() {
  struct Code {
    int number;
    const char* meaning;
  };

  constexpr std::array kCodes = {
      Code{kExitDone, "done, also when the budget ended the run"},
      Code{kExitNegative, "ran, but the outcome is negative: no feasible design, part rejected"},
      Code{kExitUsage, "wrong usage or wrong input"},
      Code{kExitIo, "a file or folder cannot be read or written"},
      Code{kExitInternal, "a mistake of the program"},
      Code{kExitInterrupted, "interrupted; the same command resumes"}};
  std::string text = ".SH EXIT STATUS\n";
  for (const Code& code : kCodes) {
    text += entry(fmt::format("{}", code.number), code.meaning);
  }
  return text;
}

std::string page_name(const ProgramUsage& program, const VerbUsage& verb) {
  return program.name + "-" + verb.name;
}

}  // namespace

std::string man_page(const ProgramUsage& program, const std::string& version) {
  std::string text =
      head(program.name, "find the lighting under which surface defects show", version);
  text += fmt::format(".SH SYNOPSIS\n.B {}\n.I VERB\n[\\fIARGUMENT\\fR]... [\\fIOPTION\\fR]...\n",
                      program.name);
  text += fmt::format(".SH DESCRIPTION\n{}\n.SH VERBS\n", escaped(program.what));
  for (const VerbUsage& verb : program.verbs) {
    text += entry(verb.name, fmt::format("{}; {}(1)", verb.what, page_name(program, verb)));
  }
  text += ".SH OPTIONS\n" + entry("-h, --help", "print the verbs; after a verb, its options") +
          entry("-V, --version", "print version, compiler and libraries");
  text += exit_codes();
  std::vector<std::string> pages;
  for (const VerbUsage& verb : program.verbs) {
    pages.push_back(fmt::format(".BR {} (1)", escaped(page_name(program, verb))));
  }
  return text + ".SH SEE ALSO\n" + join(pages, ",\n") + "\n";
}

std::string man_page(const ProgramUsage& program,
                     const VerbUsage& verb,
                     const std::string& version) {
  std::string text = head(page_name(program, verb), verb.what, version);
  text += fmt::format(".SH SYNOPSIS\n{}\n.SH OPTIONS\n", escaped(synopsis(program, verb)));
  for (const OptionUsage& option : verb.options) {
    text += entry(shown_name(option), shown_meaning(option));
  }
  text += ".SH EXAMPLES\n.nf\n";
  for (const std::string& line : split(verb.example, '\n')) {
    text += escaped(line.substr(line.find_first_not_of(' '))) + "\n";
  }
  text += ".fi\n" + exit_codes();
  return text + fmt::format(".SH SEE ALSO\n.BR {} (1)\n", program.name);
}

}  // namespace glint

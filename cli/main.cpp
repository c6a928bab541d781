// SPDX-License-Identifier: GPL-3.0-or-later
#include <malloc.h>

#include <algorithm>
#include <csignal>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "cli/command_line.h"
#include "cli/commands.h"
#include "cli/shell/usage.h"
#include "core/log.h"
#include "core/thread_pool.h"
#include "studies/output/provenance.h"

namespace glint {
namespace {

OptionUsage usage_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();  // "N:1 to 1024": of the value, of its check
  const std::size_t colon = type.find(':');
  return {.name = option.get_name(),
          .value = option.get_items_expected_max() > 0 ? type.substr(0, colon) : "",
          .what = option.get_description(),
          .allowed = colon == std::string::npos ? "" : type.substr(colon + 1),
          .default_text = option.get_default_str(),
          .is_argument = option.get_positional(),
          .is_required = option.get_required(),
          .is_repeated = option.get_expected_max() > 1};
}

/// Not one of add_common().
bool is_of_verb(const OptionUsage& option) {
  return option.name != "--json" && option.name != "--quiet" && option.name != "--threads" &&
         option.name != "--log";
}

ProgramUsage usage_of(const CLI::App& app) {
  ProgramUsage program = {.name = app.get_name(), .what = app.get_description(), .verbs = {}};
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    program.verbs.push_back({.name = verb->get_name(),
                             .what = verb->get_description(),
                             .example = verb->get_footer(),
                             .options = {}});
    for (const CLI::Option* option : verb->get_options()) {
      if (option != verb->get_help_ptr()) {
        program.verbs.back().options.push_back(usage_of(*option));
      }
    }
    std::vector<OptionUsage>& options = program.verbs.back().options;
    std::stable_partition(options.begin(), options.end(), is_of_verb);
  }
  return program;
}

void add_help_verb(CLI::App& app, CommandLine& line) {
  HelpArguments& arguments = line.help;
  CLI::App* help = app.add_subcommand("help", "show the options of a verb and an example");
  help->callback([&app, &line] {
    line.command = [&app](const CommandLine& given) {
      return help_command(usage_of(app), given.help);
    };
  });
  help->footer("glint help run\n  glint help --completion bash > ~/.glint_completion");
  help->add_option("VERB", arguments.verb, "without it the verbs are listed")->type_name("VERB");
  help->add_flag("--man", arguments.is_man, "the manual page instead, as source of man");
  help->add_option("--completion", arguments.shell, "completion of the command line for a shell")
      ->type_name("bash|zsh|fish");
}

int run_verb(const CommandLine& line) {
  LogSettings log = {.to_stderr = !line.common.is_quiet};
  if (!line.common.log_file.empty()) {
    check_log_file(line.common.log_file);
    log.files.push_back(line.common.log_file);
  }
  configure_log(log);
  return line.command(line);
}

/// The verb that was given; nullptr: none.
const VerbUsage* chosen_verb(const CLI::App& app, const ProgramUsage& program) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  return chosen.empty() ? nullptr : program.find(chosen.front()->get_name());
}

/// Help and version, which the parser throws, and what it refuses.
int answer(CLI::App& app, const CLI::ParseError& error, std::span<char* const> words) {
  const ProgramUsage program = usage_of(app);
  const VerbUsage* verb = chosen_verb(app, program);
  if (dynamic_cast<const CLI::CallForHelp*>(&error) != nullptr) {
    std::cout << (verb == nullptr ? help_text(program) : help_text(program, *verb));
    return kExitDone;
  }
  if (dynamic_cast<const CLI::CallForVersion*>(&error) != nullptr) {
    std::cout << version_text();
    return kExitDone;
  }
  const std::vector<std::string> texts(words.begin(), words.end());
  std::cerr << usage_problem(program, texts, app.remaining(true), verb, error.what()) << "\n";
  return kExitUsage;
}

/// Results are JSON and TOML, which are UTF-8; names of files need not be.
bool is_utf8(const std::string& text) {
  try {
    return !nlohmann::json(text).dump().empty();
  } catch (const nlohmann::json::type_error&) {
    return false;
  }
}

/// The first word of the command line, or else the current folder, that is no UTF-8; "": none.
std::string word_beyond_utf8(std::span<char* const> words) {
  for (const char* word : words) {
    if (!is_utf8(word)) {
      return word;
    }
  }
  std::error_code ignored;
  const std::string folder = std::filesystem::current_path(ignored).string();
  return is_utf8(folder) ? "" : folder;
}

int run_program(int argc, char** argv) {
  const std::span<char* const> words(argv + std::min(argc, 1), argv + argc);
  if (const std::string word = word_beyond_utf8(words); !word.empty()) {
    std::cerr << "glint: " << word << ": is no UTF-8 text, as all names must be\n";
    return kExitUsage;
  }
  CLI::App app("Glint finds the lighting under which surface defects show.", "glint");
  app.set_version_flag("-V,--version", version_text());
  app.require_subcommand(1);
  CommandLine line;
  line.common.threads = hardware_threads();
  add_verbs(app, line);
  add_help_verb(app, line);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return answer(app, error, words);
  }
  try {
    return run_verb(line);
  } catch (const ConfigError& error) {
    std::cerr << error.what() << "\n";
    return kExitUsage;
  } catch (const IoError& error) {
    std::string text = error.what();  // one problem; what SQLite says may have several lines
    std::ranges::replace(text, '\n', ' ');
    std::cerr << text << "\n";
    return kExitIo;
  } catch (const std::bad_alloc&) {
    std::cerr
        << "out of memory: this takes more than the machine, or a limit on this program, has; "
           "fewer pixels, --jobs or --threads need less\n";
    return kExitIo;
  } catch (const nlohmann::json::type_error& error) {
    constexpr int kInvalidUtf8 = 316;
    const bool is_name = error.id == kInvalidUtf8;
    std::cerr << (is_name ? "a file has a name that is no UTF-8 text, as all names must be: "
                          : "internal error: ")
              << error.what() << "\n";
    return is_name ? kExitUsage : kExitInternal;
  } catch (const std::exception& error) {
    std::cerr << "internal error: " << error.what() << "\n";
    return kExitInternal;
  }
}

}  // namespace
}  // namespace glint

int main(int argc, char** argv) {
  // A file beyond the system's limit shall be an error that names it, not the program's death.
  std::signal(SIGXFSZ, SIG_IGN);
  // Every candidate makes pictures of the same sizes: kept by the process instead of given back to
  // the system and cleared anew, which would take as long as evaluating the candidate.
  mallopt(M_MMAP_THRESHOLD, 1 << 28);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  return glint::run_program(argc, argv);
}

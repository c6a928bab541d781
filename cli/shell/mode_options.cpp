// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/shell/mode_options.h"

#include <algorithm>

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include "core/error.h"

namespace glint {
namespace {

bool takes_option(const OptionMode& mode, std::string_view option) {
  return std::ranges::find(mode.takes, option) != mode.takes.end();
}

/// "--sensor", "--check or --plan": the modes that an option belongs to.
std::string owners_text(std::string_view option, std::span<const OptionMode> modes) {
  std::string text;
  for (const OptionMode& mode : modes) {
    if (takes_option(mode, option)) {
      text += fmt::format("{}{}", text.empty() ? "" : " or ", mode.option);
    }
  }
  return text;
}

}  // namespace

std::vector<std::string> given_options(const CLI::App& verb) {
  std::vector<std::string> names;
  for (const CLI::Option* option : verb.get_options()) {
    if (option->count() > 0) {
      names.push_back(option->get_name());
    }
  }
  return names;
}

void check_mode_options(std::span<const std::string> given, std::span<const OptionMode> modes) {
  const auto is_given = [&](std::string_view option) {
    return std::ranges::find(given, option) != given.end();
  };
  const auto found =
      std::ranges::find_if(modes, [&](const OptionMode& mode) { return is_given(mode.option); });
  const OptionMode& mode = found == modes.end() ? modes.back() : *found;
  for (const std::string& option : given) {
    const bool is_known = std::ranges::any_of(modes, [&](const OptionMode& other) {
      return other.option == option || takes_option(other, option);
    });
    if (!is_known || option == mode.option || takes_option(mode, option)) {
      continue;
    }
    throw ConfigError(mode.option.empty()
                          ? fmt::format("{}: needs {}", option, owners_text(option, modes))
                          : fmt::format("{} takes no {}", mode.option, option));
  }
}

}  // namespace glint

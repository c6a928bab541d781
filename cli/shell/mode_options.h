// SPDX-License-Identifier: GPL-3.0-or-later
//
// Verbs with modes: which options each takes.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace CLI {
class App;
}  // namespace CLI

namespace glint {

/// A mode that one option asks for.
struct OptionMode {
  std::string_view option;              ///< "--check"; empty: the verb without any mode's option
  std::vector<std::string_view> takes;  ///< beside it and the options that all verbs have
};

/// Names of the options that were given: "PICTURES", "--poses".
std::vector<std::string> given_options(const CLI::App& verb);

/// The mode is the first whose option is given; the last one stands for none.
/// @param given  given_options(); those that no mode knows are left alone
/// @throws ConfigError naming an option that the mode does not take
void check_mode_options(std::span<const std::string> given, std::span<const OptionMode> modes);

}  // namespace glint

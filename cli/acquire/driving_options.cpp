// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/acquire/driving_options.h"

#include <CLI/CLI.hpp>

#include "cli/shell/options.h"

namespace glint {

void add_driving_options(CLI::App& verb, AcquireArguments& arguments, const std::string& when) {
  verb.add_flag("--move",
                arguments.is_move,
                when + "let the robot move: only when nobody is within reach of the arm");
  verb.add_option("--twin", arguments.twin, when + "ports of this ready file instead of the cell's")
      ->type_name("FILE")
      ->check(not_empty());
  verb.add_option("--speed_share", arguments.speed_share, when + "of the cell's limits of speed")
      ->type_name("SHARE")
      ->capture_default_str()
      ->check(between(0.01, 1.0));
  verb.add_option("--confirmed",
                  arguments.confirmed,
                  when +
                      "manual lights that are as they should be; others are asked for at the "
                      "terminal")
      ->type_name("NAME")
      ->allow_extra_args(false);
}

void add_mounted_option(CLI::App& verb, AcquireArguments& arguments, const std::string& when) {
  CLI::Option* mounted =
      verb.add_option("--mounted",
                      arguments.mounted,
                      when +
                          "design of the run whose prototype is in the cell; others are asked for "
                          "at the terminal")
          ->type_name("NAME")
          ->allow_extra_args(false);
  if (!when.empty()) {
    mounted->needs(verb.get_option("--cell"));
  }
}

}  // namespace glint

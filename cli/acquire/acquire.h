// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint acquire`: its arguments, and what is told of its result.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace glint {

struct AcquireArguments {
  std::filesystem::path source;  ///< scene, plan.json or their folder; empty: the cell's views
  std::filesystem::path cell;
  std::filesystem::path out;
  std::filesystem::path twin;  ///< ready file whose ports take the place of the cell's
  bool is_move = false;        ///< --move: a person in front of the robot lets it move
  bool is_dry_run = false;
  double speed_share = 0.5;
  std::vector<std::string> confirmed;  ///< manual lights that a person has set
  std::vector<std::string> mounted;    ///< designs whose prototypes a person has mounted
};

struct AcquireAnswer {
  nlohmann::ordered_json json;
  std::string text;
  int exit_code = 0;
};

/// What acquire_pictures() returned, told.
/// @param again  the command that goes on, with --mounted or --confirmed, where a person is waited
///               for
AcquireAnswer acquire_answer(const nlohmann::ordered_json& result,
                             const std::string& again = "the same command");

/// What a person has to do before `again` goes on with --mounted or --confirmed.
/// @param next  acquire_pictures()'s
std::string waiting_text(const nlohmann::ordered_json& next, const std::string& again);

/// @param is_silent  no progress bar
/// @throws ConfigError without --move, before any file is read and any address is looked up
AcquireAnswer run_acquire(const AcquireArguments& arguments, bool is_silent);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "cli/commands.h"

namespace glint {

/// What `glint cell ACTION` does.
struct CellAction {
  std::string_view name;
  bool may_move;  ///< refused without --move before anything else happens
  int (*run)(const CellArguments& arguments, const CommonArguments& common);
};

/// All of them; whoever adds one says whether it may move.
std::span<const CellAction> cell_actions();

/// The one word after the action. @throws ConfigError naming what is needed
std::filesystem::path the_word(const CellArguments& arguments, const std::string& what);

}  // namespace glint

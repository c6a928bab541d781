// SPDX-License-Identifier: GPL-3.0-or-later
//
// The charts of glint frontier beside that of the rendering methods.
#pragma once

#include <string>
#include <vector>

#include "cli/commands.h"

namespace glint {

/// Which chart: neither of both flags, methods of rendering.
struct FrontierArguments {
  bool is_inspector = false;
  bool is_search = false;
  int seeds = 10;                    ///< of a search
  std::vector<std::string> methods;  ///< algorithms of a search; empty: the study's own
};

/// The chart that is asked for.
int frontier_chart_command(const StudyArguments& arguments,
                           const FrontierArguments& chart,
                           const CommonArguments& common);

}  // namespace glint

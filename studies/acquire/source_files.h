// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is named on a command line as that of which pictures are taken: which files that are, and
// where its scene comes from.
#pragma once

#include <filesystem>

#include "studies/plan/plan_file.h"

namespace glint {

struct SourceFiles {
  std::filesystem::path plan;   ///< plan.json; empty: none
  std::filesystem::path scene;  ///< whose lights shine; empty: the cell's own
};

/// @param source  a scene, plan.json, or a folder that holds plan.json or scene.toml; empty: none
SourceFiles files_of(const std::filesystem::path& source);

/// The scene that a source was made from, and the run whose designs it is one of: of a planned
/// scene what the plan beside it tells, else the scene itself and the run that it lies in, or that
/// it lies in where links lead. All with full paths; empty: not known, none.
/// @throws ConfigError for a plan of an earlier program, which does not tell, where it lies in no
/// run
PlanOrigin origin_of(const std::filesystem::path& source);

}  // namespace glint

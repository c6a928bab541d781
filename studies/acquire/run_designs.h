// SPDX-License-Identifier: GPL-3.0-or-later
//
// The designs of a run by their lights, and which of them a scene is. Private to the room.
#pragma once

#include <filesystem>
#include <vector>

#include "studies/acquire/mounted_prototypes.h"
#include "studies/plan/plan_file.h"

namespace glint::acquire_detail {

/// RUN/NAME without the slash that may end it.
std::filesystem::path without_slash(const std::filesystem::path& folder);

/// RUN/NAME of RUN/NAME/scene.toml, RUN/NAME and RUN/NAME/; empty: none is named.
std::filesystem::path design_folder(const std::filesystem::path& scene);

/// Of RUN/NAME, RUN/front/NAME, and FOLDER/NAME where the folder lies in the run, in no design of
/// it.
std::vector<MountedPrototypes::Design> designs_in(const std::filesystem::path& run,
                                                  const std::filesystem::path& folder);

/// Which design a scene is. One that is not the scene.toml of a design is the design that has its
/// lights, of several the one in whose folder it lies, else one more design. Where the run is not
/// there any more nobody knows how its designs differ: its lights count as not read.
/// @param held    the file that is taken; empty: none, its lights are not known
/// @param origin  where it comes from; lies in a run
MountedPrototypes::Design design_of(const std::filesystem::path& held,
                                    const PlanOrigin& origin,
                                    const std::vector<MountedPrototypes::Design>& designs);

}  // namespace glint::acquire_detail

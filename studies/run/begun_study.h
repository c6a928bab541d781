// SPDX-License-Identifier: GPL-3.0-or-later
//
// What may change of a study whose run has begun: title, budget, prototypes and, without
// [accuracy], a space that becomes wider. Its trials are designs of the wider space, too, and a new
// epoch of the search begins with them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "optimizer/storage/storage.h"
#include "studies/definition/study.h"

namespace glint {

/// The designs that `glint report --analyse --evaluate` added to a run, in a file of their own
/// beside study.sqlite.
inline constexpr const char* kAddedDesigns = "analysis.sqlite";

/// The point of this space that is the same design as one of another space with variables of the
/// same names; nothing where it is none.
std::optional<Point> point_here(const SearchSpace& here, const SearchSpace& there, const Point& at);

/// Lets a run go on with a study that is the one of its folder but for what may change. Where the
/// space has become wider, trials become points of it, by the names of variables and choices, and
/// an epoch is appended to the log; designs as built are dropped, as they are made about another
/// winner.
/// @param identity  of the study now; gets the hash that the folder knows it by
/// @return what became wider: "lighting.ring.height_mm: max is 60, was 40"; empty: nothing
/// @throws ConfigError that says what differs and may not, with nothing changed; IoError
std::string adopt_begun_study(const Study& study,
                              StudyIdentity& identity,
                              const std::filesystem::path& run);

}  // namespace glint

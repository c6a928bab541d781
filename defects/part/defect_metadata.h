// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/pose.h"
#include "defects/definition/defect_settings.h"
#include "defects/part/defective_part.h"

namespace glint {

/// Everything about a part's defects: the tables they were given by, with the keys of the scene
/// file, and for each defect what was drawn, what it was made by and what came of it. Free of
/// times, so that the same scene and seed give the same bytes.
///
/// { "schema": 1, "seed", "imprint": {table}, "groups": {name: {table}}, "made", "given_up",
///   "removed_volume_mm3", "limited_vertices", "refusals", "defects": [{...}] }
///
/// Places and axes are in the scene frame, `part_mm` in the part's. A wall that was not met is
/// null. What is told of a defect that was given up is its last attempt, and why; its place is null
/// where none was found. `limited_vertices` moved less than the processing's noise or smoothing
/// asked for.
/// `removed_volume_mm3` is negative where material was added.
///
/// @param groups  the tables the defects came from
/// @param seed    of this sample; settings.seed for the scene itself
nlohmann::ordered_json defects_json(const DefectivePart& part,
                                    const std::vector<NamedGroup>& groups,
                                    const ImprintSettings& settings,
                                    std::uint64_t seed,
                                    const RigidTransform& scene_from_part = {});

/// A sentence about the defects that the wall below them made shallower than they were drawn; empty
/// when there are none.
std::string shallow_note(const DefectivePart& part);

}  // namespace glint

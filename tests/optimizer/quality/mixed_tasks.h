// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tasks of one objective over choices, integers and variables that are active for some choices
// only.
#pragma once

#include "core/rng.h"
#include "tests/optimizer/quality/tasks.h"

namespace glint::quality {

/// Three kinds of light, each with two variables of its own; a number of rings and a height.
SearchSpace kinds_space();

/// A lens only for a narrow source, a tilt for two of the lenses, a focus for one.
SearchSpace nested_space();

/// Of value 0 at a random design of the space. Each choice that is not the best costs something of
/// its own, and the best place of a number that is active is a little other for each choice.
Task mixed_task(const SearchSpace& space, Rng& rng);

}  // namespace glint::quality

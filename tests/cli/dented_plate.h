// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "tests/cli/ring_or_bar.h"

namespace glint::test {

/// The plate with a dent under a ring.
inline const std::string kDentedPlate = "schema = 1\n" + kMetalPlate + R"([render.paths]
samples = 64
max_reflections = 1
[lighting.ring]
mount = "camera"
)" + kDent;

}  // namespace glint::test

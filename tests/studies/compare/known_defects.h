// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "core/file.h"
#include "studies/compare/compared_pair.h"
#include "tests/studies/compare/compare_fixture.h"

namespace glint {

/// Two pictures of a blade, whose simulated side knows its mask and its defects.
class KnownDefects : public CompareFiles {
 protected:
  /// @param defects  of defects.json; 0.1 mm a pixel from the picture's middle
  ComparedPair compared_with(const std::string& defects) const {
    write_file(folder() / "scene.toml",
               "[camera]\nwidth_px = 200\nheight_px = 160\nobject_pixel_mm = 0.1\n"
               "working_distance_mm = 500\n");
    write_file(folder() / "defects.json", R"({"schema": 1, "defects": [)" + defects + "]}");
    ImageF mask = drawn_blade({.noise = 0.0});
    for (float& grey : mask.values()) {
      grey = grey > 0.25F ? 1.0F : 0.0F;
    }
    return compare_pair(
        {.simulated = {.name = "s",
                       .picture = write("s.png", drawn_blade()),
                       .mask = write("part_mask.png", mask),
                       .scene = folder() / "scene.toml",
                       .truth = folder() / "defects.json"},
         .real = {.name = "r", .picture = write("r.png", drawn_blade({.index = 1}))}},
        {});
  }
};

}  // namespace glint

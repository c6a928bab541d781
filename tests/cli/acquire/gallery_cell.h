// SPDX-License-Identifier: GPL-3.0-or-later
//
// The gallery's twin_cell for tests: small pictures, and an arm that moves 20 times as fast.
#pragma once

#include <filesystem>
#include <string>

#include "core/file.h"
#include "tests/cli/program.h"

namespace glint::test {

inline const std::filesystem::path kGalleryCell =
    std::filesystem::path(GLINT_SOURCE_DIR) / "studies/gallery/twin_cell";

/// A scene of it in pictures of 306 x 256 pixels.
inline std::string with_three_quarters(const std::string& scene) {
  return edited(scene,
                {{"width_px = 408", "width_px = 306"},
                 {"height_px = 342", "height_px = 256"},
                 {"pixel_um = 10.35", "pixel_um = 13.8"},
                 {"object_pixel_mm = 0.15", "object_pixel_mm = 0.2"}});
}

/// Its truth in pictures of 204 x 171 pixels, with half the samples.
inline std::string small_truth() {
  return edited(read_file(kGalleryCell / "truth.toml"),
                {{"width_px = 408", "width_px = 204"},
                 {"height_px = 342", "height_px = 171"},
                 {"pixel_um = 10.35", "pixel_um = 20.7"},
                 {"object_pixel_mm = 0.15", "object_pixel_mm = 0.3"},
                 {"samples = 8", "samples = 4"}});
}

/// Its cell file. @param truth  the file of the truth
inline std::string fast_cell(const std::string& truth = "truth.toml") {
  return edited(read_file(kGalleryCell / "cell.toml"),
                {{"truth = \"truth.toml\"", "truth = \"" + truth + "\"\nmotion_speedup = 20"}});
}

/// A verb that drives the twins of cell.toml at full speed, its ring mounted.
inline Arguments driving(Arguments verb) {
  for (const char* word : {"--cell",
                           "cell.toml",
                           "--twin",
                           "twin.json",
                           "--confirmed",
                           "ring",
                           "--speed_share",
                           "1",
                           "--json",
                           "--move"}) {
    verb.emplace_back(word);
  }
  return verb;
}

}  // namespace glint::test

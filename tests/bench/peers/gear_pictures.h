// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures of the gear under a ring light by Glint's path tracer and by Blender's Cycles.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "tests/bench/gear_scene.h"

namespace glint::peers {

/// What is asked for.
struct GearOrder {
  int samples = 16;
  int seed = 1;
};

/// One picture: luminance (0.2126 R + 0.7152 G + 0.0722 B), and the CPU seconds of one thread.
struct GearPicture {
  GearOrder order;
  double cpu_s = 0.0;
  ImageF luminance;
};

/// What one renderer made.
struct GearRun {
  std::vector<GearPicture> pictures;
  double first_s = 0.0;  ///< CPU seconds of what is done once: BVH; Cycles: reading the scene too
  std::vector<std::string> settings;  ///< in words, one a line
};

/// @param threads  of the pool; times are CPU seconds of all
GearRun render_by_glint(const bench::GearScene& gear,
                        const std::vector<GearOrder>& orders,
                        int threads);

/// @param script  cycles_gear.py @param name  of the files in the folder
/// @throws Error when Blender fails
GearRun render_by_cycles(const bench::GearScene& gear,
                         const std::vector<GearOrder>& orders,
                         const std::filesystem::path& script,
                         const std::filesystem::path& folder,
                         const std::string& name);

/// The scene as text: a reference picture holds while this stays the same.
std::string description_of(const bench::GearScene& gear);

}  // namespace glint::peers

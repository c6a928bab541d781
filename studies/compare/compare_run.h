// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint compare`: how far simulated pictures and photographs agree.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/progress.h"
#include "studies/compare/compare_sources.h"

namespace glint {

struct CompareOptions {
  CompareInputs inputs;
  std::filesystem::path out;    ///< empty: out/<name_within_run() of the simulated side>/compare
  std::filesystem::path mask;   ///< of the real part; empty: it is found
  std::filesystem::path scene;  ///< of simulated pictures that come without one; empty: none
  std::string outline = "auto";
  bool has_offset = false;            ///< exposures differ by an offset too
  bool is_lens_known = false;         ///< calibrated: only pose and gain may differ
  std::filesystem::path calibration;  ///< of the real camera; empty: the scene's camera is meant
  bool has_roughness = false;         ///< roughness may be a cause: scenes are rendered again
  bool is_refining = false;           ///< writes the scene with the causes put in
  int threads = 1;
  Progress::Style progress = Progress::Style::kAuto;
};

/// Writes result.json, report.html, run.json and a folder of pictures for each pair: overlay.png,
/// simulated.png, difference.exr, and refined.toml where that is wanted and causes were found;
/// refined.toml of all pairs beside them, where they are several views of one scene.
/// @return what result.json holds, and "folder", "report", "timings" (this_run_s, of that render_s
///         and compare_s)
/// @throws ConfigError, IoError; nothing is left behind
nlohmann::ordered_json compare_pictures(const CompareOptions& options);

}  // namespace glint

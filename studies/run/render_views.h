// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint render` of path-traced scenes: all viewpoints as pictures, masks and geometry.
//
//   OUT/baseline/ (one viewpoint) or OUT/view_01/ ...   render_files.h; the first view has also
//                                                       the files of design_files.h when it scores
//   OUT/contact_sheet.png                               of several views
//   OUT/preview.png                                     of the view in the making, after each pass
//   OUT/result.json  report.html  run.json  study.resolved.toml
#pragma once

#include <atomic>
#include <filesystem>

#include <nlohmann/json_fwd.hpp>

#include "core/progress.h"
#include "studies/definition/study.h"

namespace glint {

struct RenderOptions {
  std::filesystem::path out;
  int threads = 1;
  bool has_light = true;  ///< false: masks and geometry alone; no light is sampled
  Progress::Style progress = Progress::Style::kAuto;
  const std::atomic<int>* interrupt = nullptr;  ///< how often the user interrupted
};

/// Renders the scene of a study, whatever it searches. At an interrupt the view in the making is
/// written as far as it has come, and no further one.
/// @return { schema, status: "done" | "interrupted", width_px, height_px, views: [ { folder,
///         viewpoint, samples, mean_samples, rays: { camera, shadow, bounce }, relative_error (null
///         of a sum of light, which has no noise), defects_seen (those of at least one pixel),
///         cpu_s } ], scores, notes, folder, report }; result.json is the same without times and
///         with paths below OUT
/// @throws ConfigError, IoError; nothing is left behind by a scene that is refused
nlohmann::ordered_json render_views(const Study& study, const RenderOptions& options);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The plain way for pictures whose rays do not fit into memory: horizontal bands of pixel rows are
// traced and rendered one after the other, each by the camera with its principal point shifted.
// The radiance is that of simulator/render, pixel by pixel; the scores are those of evaluate().
#pragma once

#include <functional>
#include <vector>

#include "metrics/aspect_image/defect_scores.h"
#include "metrics/scores.h"
#include "studies/imaging/traced_scene.h"

namespace glint {

struct BandedSettings {
  std::int64_t max_rays = std::int64_t{1} << 22;  ///< in a band, >= one row: 150 MB
  int repeats = 1;                                ///< of what is timed, >= 1
  std::function<void(int rows_done)> on_band;     ///< may be empty
};

/// All frames of a scan before the sensor.
struct BandedScan {
  RayCache seen;                 ///< coverage and seen points of the whole picture, without rays
  std::vector<ImageF> radiance;  ///< one a position
  Mask lit;                      ///< 1: every ray meets the luminous wall at every position
  double trace_cpu_s = 0.0;      ///< of all threads
  double render_cpu_s = 0.0;     ///< of one thread: light met and all frames made, rays kept
};

/// Plain sampling with scene.render.rays_per_axis. Memory: the frames and one band of rays.
/// @param detail  what of the scene's defects is on the part
BandedScan scan_in_bands(const BuiltPart& built,
                         const SurfaceDetail& detail,
                         const PinholeIntrinsics& camera,
                         const SceneSettings& scene,
                         ThreadPool& pool,
                         const BandedSettings& settings = {});

/// What a scan scores, as evaluate() has it.
struct ScoredScan {
  double h_rms = 0.0;
  Scores scores;  ///< all that this one and evaluate() both have
  Mask region;    ///< of interest for homogeneity
  std::vector<DefectScores> defects;
  double cpu_s = 0.0;       ///< warm: rays kept, one thread
  double cold_cpu_s = 0.0;  ///< the same and tracing, all threads
  BandedScan scan;
};

/// Scans the scene in bands and scores it through its sensor.
ScoredScan evaluate_in_bands(const BuiltDefects& part,
                             const SceneSettings& scene,
                             ThreadPool& pool,
                             const BandedSettings& settings = {});

}  // namespace glint

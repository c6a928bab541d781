// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/image/image.h"

namespace glint::peers {

/// What one tool with one setting costs, in CPU seconds of one thread.
struct Result {
  std::string tool;
  std::string setting;
  double frame_s = 0.0;  ///< one more frame of a candidate; as the next two, 0: does not apply
  double warm_s = 0.0;   ///< a candidate's frames, everything prepared that can be kept
  double cold_s = 0.0;   ///< a candidate from nothing but the mesh
  ImageF frame;          ///< the candidate's first frame; empty: the same as the row above
  std::string notes;     ///< what was measured and what is extended
  std::vector<std::string> settings;  ///< of the tool, one a line
  std::vector<double> samples_s;      ///< the single measurements behind warm_s
};

/// How far a frame is from the reference.
struct FrameError {
  double rmse = 0.0;
  double rmse_inside = 0.0;  ///< pixels away from the slot's edges
  double mean = 0.0;         ///< of the frame
};

/// What frames are compared with.
struct Reference {
  int rays_per_pixel = 0;
  ImageF frame;
  Mask inside;  ///< 1 for pixels away from the edges of slot and tunnel
};

FrameError compare(const ImageF& frame, const Reference& reference);

/// The table for a terminal. Ratios are to the first row.
std::string to_table(const std::vector<Result>& results, const Reference& reference);

/// The same and more as JSON. @throws IoError
void write_json(const std::filesystem::path& path,
                const std::vector<Result>& results,
                const Reference& reference);

}  // namespace glint::peers

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What was found on a simulated part, beside what is on it.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "metrics/inspection/match_detections.h"

namespace glint {

/// A defect that is on a part, as the camera sees it: a line (of no length where it is round) with
/// everything that is nearer to it than the radius.
struct KnownDefect {
  int id = 0;
  std::string label;
  std::string kind;  ///< "dent", "scratch", ...
  Eigen::Vector2d from_px = Eigen::Vector2d::Zero();
  Eigen::Vector2d to_px = Eigen::Vector2d::Zero();
  double radius_px = 0.0;  ///< > 0

  Eigen::Vector2d middle_px() const { return 0.5 * (from_px + to_px); }

  /// Scratches and gouges; all others are round.
  bool is_line() const;

  /// Distance of a point from the line.
  double distance_px(const Eigen::Vector2d& point) const;
};

/// The defects that the camera can see, from a design's files.
/// @param defects  defects.json
/// @param scene    scene.toml: camera and viewpoint
/// @throws ConfigError, IoError
std::vector<KnownDefect> read_known_defects(const std::filesystem::path& defects,
                                            const std::filesystem::path& scene);

/// A blob is within reach of a defect whose line lies within hit_radii of its radii, and the slack,
/// of the blob's middle.
DetectionMatches match_detections(std::span<const FoundDefect> found,
                                  std::span<const KnownDefect> known,
                                  const TrialSettings& settings);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which of the blobs that were found belong to which of the defects that are there.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "metrics/inspection/inspector.h"

namespace glint {

struct DetectionMatches {
  std::vector<int> blob_of_defect;  ///< the nearest one that finds it; -1: missed
  std::vector<int> defect_of_blob;  ///< found, or echoed; -1: a false alarm

  bool is_found(std::size_t defect) const { return blob_of_defect[defect] >= 0; }

  int found() const;         ///< defects
  int false_alarms() const;  ///< blobs
};

/// How far a blob's middle is from a defect, in the defect's radii.
/// @param slack_px  how much farther it may be than the radii that count as a hit
/// @return empty: too far
using DefectDistance = std::function<std::optional<double>(
    const FoundDefect& blob, std::size_t defect, double slack_px)>;

/// A blob belongs to the nearest defect (the first of those at equal distance) within reach, with a
/// slack of 1.5 px, and finds it. One that is farther by at most echo_px is a side lobe of the
/// filter: it belongs to the defect, but finds nothing. All others are false alarms.
/// @param echo_px  >= 0
DetectionMatches match_detections(std::span<const FoundDefect> found,
                                  std::size_t num_defects,
                                  double echo_px,
                                  const DefectDistance& distance);

}  // namespace glint

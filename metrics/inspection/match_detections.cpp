// SPDX-License-Identifier: GPL-3.0-or-later
#include "metrics/inspection/match_detections.h"

#include <algorithm>

namespace glint {
namespace {

constexpr double kSlack_px = 1.5;  ///< a blob's middle is no better known

struct Nearest {
  int defect = -1;  ///< -1: none
  double distance = 0.0;
};

Nearest nearest_to(const FoundDefect& blob,
                   std::size_t num_defects,
                   double slack_px,
                   const DefectDistance& distance) {
  Nearest nearest;
  for (std::size_t i = 0; i < num_defects; ++i) {
    const std::optional<double> radii = distance(blob, i, slack_px);
    if (radii && (nearest.defect < 0 || *radii < nearest.distance)) {
      nearest = {.defect = static_cast<int>(i), .distance = *radii};
    }
  }
  return nearest;
}

}  // namespace

int DetectionMatches::found() const {
  return static_cast<int>(std::ranges::count_if(blob_of_defect, [](int i) { return i >= 0; }));
}

int DetectionMatches::false_alarms() const {
  return static_cast<int>(std::ranges::count(defect_of_blob, -1));
}

DetectionMatches match_detections(std::span<const FoundDefect> found,
                                  std::size_t num_defects,
                                  double echo_px,
                                  const DefectDistance& distance) {
  DetectionMatches matches = {.blob_of_defect = std::vector<int>(num_defects, -1),
                              .defect_of_blob = {}};
  std::vector<double> nearest(num_defects);  // blob to defect
  for (std::size_t blob = 0; blob < found.size(); ++blob) {
    const Nearest hit = nearest_to(found[blob], num_defects, kSlack_px, distance);
    if (hit.defect < 0) {
      matches.defect_of_blob.push_back(
          nearest_to(found[blob], num_defects, kSlack_px + echo_px, distance).defect);
      continue;
    }
    matches.defect_of_blob.push_back(hit.defect);
    const auto i = static_cast<std::size_t>(hit.defect);
    if (!matches.is_found(i) || hit.distance < nearest[i]) {
      matches.blob_of_defect[i] = static_cast<int>(blob);
      nearest[i] = hit.distance;
    }
  }
  return matches;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// One part's way through `glint inspect`: pictures, mask, response, list of defects.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/thread_pool.h"
#include "metrics/inspection/grading.h"
#include "metrics/inspection/phase.h"
#include "studies/inspect/inspect_marks.h"
#include "studies/inspect/inspect_sources.h"
#include "studies/inspect/inspect_truth.h"
#include "studies/inspect/picture_sequence.h"

namespace glint {

/// How often a response has which size, over the region.
struct ResponseHistogram {
  double reach = 0.0;          ///< > 0; bins lie evenly from -reach to reach
  std::vector<double> counts;  ///< the first and last bin also hold what lies beyond
};

struct InspectedPart {
  PicturedPart source;
  int width_px = 0;
  int height_px = 0;
  int bits = 8;
  bool is_float = false;
  int channels = 1;
  std::string mask_from;  ///< "file", "reference", "design", "silhouette" or "picture"
  std::size_t region_px = 0;
  double bright_share =
      0.0;  ///< of the pixels from PreparedPart::bright_from on, that are inspected
  Inspection inspection;
  DefectSizes holes;
  DefectSizes scratches;
  std::optional<Grade> grade;  ///< empty: no limits are set
  std::optional<Grade> label;  ///< of a person; empty: none
  std::vector<KnownDefect> known;
  std::optional<DetectionMatches> comparison;  ///< empty: the truth is not known
  ResponseHistogram histogram;
  std::vector<std::string> notes;
  /// Pictures are given up once their files are written.
  ImageF aspect;
  ImageF response;                  ///< 0 outside the region
  std::optional<PhaseMaps> phases;  ///< of filter phase
  Mask region;
};

/// Where parts are in their pictures, and what a whole run knows.
struct PartMasks {
  std::filesystem::path mask;       ///< for all parts; empty: none
  std::filesystem::path reference;  ///< laid onto each part's silhouette; empty: none
  const Mask* placed = nullptr;     ///< in the pictures' pixels, before all others; nullptr: none
};

/// A part's pictures with its mask, ready to be inspected.
struct PreparedPart {
  PictureSequence sequence;
  ImageF aspect;
  Mask mask;
  std::string mask_from;
  double bright_from = 0.0;  ///< the silhouette's threshold; 0 where none can be told
  std::vector<std::string> notes;
};

/// @throws ConfigError, IoError
PreparedPart prepare_part(const PicturedPart& source, const PartMasks& masks, ThreadPool& pool);

/// What the inspector's filter makes of a part. @throws ConfigError
ImageF response_of(const Inspector& inspector, const PreparedPart& part, ThreadPool& pool);

/// The whole way; not graded yet.
/// @param looked_at   pixels outside are not looked at; nullptr: all of the mask is
/// @param calibrated  of threshold = "false_alarms"
/// @throws ConfigError, IoError
InspectedPart inspect_part(const PicturedPart& source,
                           PreparedPart part,
                           const InspectionSettings& settings,
                           const Mask* looked_at,
                           std::optional<double> calibrated,
                           ThreadPool& pool);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What was found and what was missed, drawn over a part's aspect image.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/image/image_io.h"
#include "studies/inspect/inspect_truth.h"

namespace glint {

/// A closed outline about a defect, in pixels of the picture.
struct DefectMark {
  enum class Kind { kHole, kScratch, kMissed };

  Kind kind = Kind::kHole;
  std::vector<Eigen::Vector2d> outline;
  int number = 0;  ///< of the defect in its list, from 1
};

/// An ellipse about each hole, a rectangle about each scratch, with some space between.
std::vector<DefectMark> marks_of(std::span<const FoundDefect> found);

/// An ellipse about each defect that was missed.
std::vector<DefectMark> missed_marks(std::span<const KnownDefect> known,
                                     const DetectionMatches& comparison);

/// The aspect image with the grey values of the region spread over the whole scale, darker outside
/// the region.
ImageF shown_aspect(const ImageF& aspect, const Mask& region);

/// A picture with its marks; small pictures are enlarged by a whole factor. Missed defects have
/// broken lines.
ImageRgb overlay(const ImageF& shown, std::span<const DefectMark> marks);

}  // namespace glint

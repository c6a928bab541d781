// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/stability/note_coverage.h"

#include <algorithm>

namespace glint::stability {
namespace {

constexpr std::string_view kHPoints = "h_points";
constexpr std::string_view kContrast = "contrast_percent";
constexpr std::string_view kPicture = "picture";
constexpr std::string_view kMean = "mean";

}  // namespace

const std::vector<NoteCoverage>& note_coverages() {
  static const std::vector<NoteCoverage> coverages = {
      {NoteKind::kRipple, {kHPoints, kPicture, kMean}},
      {NoteKind::kOccluded, {kHPoints, kPicture, kMean}},
      {NoteKind::kSaturated, {kHPoints, kContrast}},
      {NoteKind::kRepeatedBorder, {kHPoints, kContrast, kPicture, kMean}},
      {NoteKind::kCoarseCells, {kHPoints, kContrast, kPicture, kMean}},
      {NoteKind::kFrameNoise, {kContrast}},
      {NoteKind::kFineStripes, {kContrast}},
      {NoteKind::kDefectStripes, {kContrast}},
      {NoteKind::kNarrowDefect, {kContrast}},
  };
  return coverages;
}

std::vector<std::string> told_of(std::string_view quantity, std::span<const SceneNote> notes) {
  std::vector<std::string> told;
  for (const SceneNote& note : notes) {
    const bool is_covered =
        std::ranges::any_of(note_coverages(), [&](const NoteCoverage& coverage) {
          return coverage.kind == note.kind &&
                 std::ranges::find(coverage.quantities, quantity) != coverage.quantities.end();
        });
    if (is_covered) {
      told.push_back(note.text);
    }
  }
  return told;
}

}  // namespace glint::stability

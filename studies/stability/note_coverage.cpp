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
      {"the flawless surface itself shows a ripple", {kHPoints, kPicture, kMean}},
      {"occluded pixels are dark", {kHPoints, kPicture, kMean}},
      {"no defect can show there, and h counts it as even", {kHPoints, kContrast}},
      {"the border's pixels are repeated", {kHPoints, kContrast, kPicture, kMean}},
      {"a smoother mesh is rendered more exactly", {kHPoints, kContrast, kPicture, kMean}},
      {"the change of a defect in its best frame holds this noise", {kContrast}},
      {"what changes in them by a defect are uncertain", {kContrast}},
      {"what changes in frames by these defects is uncertain", {kContrast}},
      {"Scores of such a defect depend on where the pixels happen to lie", {kContrast}},
  };
  return coverages;
}

std::string told_of(std::string_view quantity, std::span<const std::string> notes) {
  std::string told;
  for (const std::string& note : notes) {
    const bool is_covered =
        std::ranges::any_of(note_coverages(), [&](const NoteCoverage& coverage) {
          return note.find(coverage.words) != std::string::npos &&
                 std::ranges::find(coverage.quantities, quantity) != coverage.quantities.end();
        });
    if (is_covered) {
      told += (told.empty() ? "" : " ") + note;
    }
  }
  return told;
}

}  // namespace glint::stability

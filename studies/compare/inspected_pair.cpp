// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/inspected_pair.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "studies/inspect/defect_contrast.h"
#include "studies/inspect/inspect_rules.h"
#include "studies/inspect/inspected_part.h"

namespace glint {
namespace {

InspectedSide side_of(const ComparedPicture& picture,
                      const ComparedPair& pair,
                      const InspectionSettings& settings,
                      std::vector<KnownDefect>& known,
                      ThreadPool& pool) {
  const CompareSource& simulated = pair.simulated.source;
  const PicturedPart source = {.name = picture.source.name,
                               .pictures = {picture.source.picture},
                               .mask = simulated.mask,
                               .scene = simulated.scene,
                               .truth = simulated.truth};
  const InspectedPart part =
      inspect_part(source, prepare_part(source, {}, pool), settings, nullptr, std::nullopt, pool);
  InspectedSide side;
  known = part.known;
  if (!part.comparison) {
    return side;
  }
  side.found = part.comparison->found();
  side.missed = static_cast<int>(known.size()) - side.found;
  side.false_alarms = part.comparison->false_alarms();
  for (std::size_t i = 0; i < known.size(); ++i) {
    const int blob = part.comparison->blob_of_defect[i];
    SeenDefect seen = {.is_found = blob >= 0};
    if (blob >= 0) {
      seen.found_as = kind_name(part.inspection.defects[static_cast<std::size_t>(blob)].kind);
    }
    seen.contrast = defect_contrast(picture.grey, pair.region, known[i]);
    side.defects.push_back(std::move(seen));
  }
  return side;
}

/// How far the part lies from where the simulated picture has it.
double aside_px(const PairGeometry& geometry) {
  return std::max(middle_shift_px(geometry.outlines).norm(), geometry.distance.mean_px);
}

/// Mask and places are those of the simulated picture: they must be the photograph's too.
void note_aside(const ComparedPair& pair, InspectedPair& result) {
  constexpr double kFar_px = 2.0;
  const double smallest_px =
      std::ranges::min_element(result.known, {}, &KnownDefect::radius_px)->radius_px;
  const double off_px = aside_px(pair.geometry);
  if (off_px > std::min(kFar_px, 0.5 * smallest_px)) {
    result.notes.push_back(fmt::format(
        "In the photograph the part lies {:.1f} px elsewhere, and is inspected where the simulated "
        "picture has it: its found, missed and contrasts may be of other places.",
        off_px));
  }
}

}  // namespace

std::optional<InspectedPair> inspect_pair(const ComparedPair& pair, ThreadPool& pool) {
  const CompareSource& simulated = pair.simulated.source;
  if (simulated.truth.empty() || simulated.scene.empty() || simulated.mask.empty()) {
    return std::nullopt;
  }
  InspectionSettings settings =
      read_inspection_rules(InspectionSettings{}, simulated.scene, {}, {}).settings;
  InspectedPair result;
  if (settings.threshold == InspectionSettings::Threshold::kFalseAlarms) {
    settings.threshold = InspectionSettings::Threshold::kNoise;
    result.notes.emplace_back("Inspected with threshold = \"noise\": there are no flawless parts.");
  }
  result.simulated = side_of(pair.simulated, pair, settings, result.known, pool);
  if (result.known.empty()) {
    return std::nullopt;
  }
  result.real = side_of(pair.real, pair, settings, result.known, pool);
  note_aside(pair, result);
  return result;
}

}  // namespace glint

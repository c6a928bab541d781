// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/inspected_pair.h"

#include <utility>

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
  return result;
}

}  // namespace glint

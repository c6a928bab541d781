// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/inspected_pair.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Core>

#include "studies/inspect/inspect_rules.h"
#include "studies/inspect/inspected_part.h"

namespace glint {
namespace {

constexpr double kInnerRing = 1.5;  ///< of the surroundings, in radii from the defect
constexpr double kOuterRing = 3.0;
constexpr double kLeastPixels = 4.0;

/// Sums of one kind of pixels.
struct Sums {
  double count = 0.0;
  double sum = 0.0;
  double squares = 0.0;

  void add(double grey) {
    count += 1.0;
    sum += grey;
    squares += grey * grey;
  }

  double mean() const { return sum / count; }

  /// Of the mean.
  double variance() const {
    return std::max(squares / count - mean() * mean(), 0.0) / std::max(count - 1.0, 1.0);
  }
};

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

std::optional<Estimate> defect_contrast(const ImageF& picture,
                                        const Mask& region,
                                        const KnownDefect& defect) {
  const double reach = kOuterRing * defect.radius_px;
  const Eigen::Vector2d low = defect.from_px.cwiseMin(defect.to_px).array() - reach;
  const Eigen::Vector2d high = defect.from_px.cwiseMax(defect.to_px).array() + reach;
  Sums inside;
  Sums around;
  for (int y = std::max(0, static_cast<int>(low.y()));
       y < std::min(picture.height(), static_cast<int>(high.y()) + 1);
       ++y) {
    for (int x = std::max(0, static_cast<int>(low.x()));
         x < std::min(picture.width(), static_cast<int>(high.x()) + 1);
         ++x) {
      if (!region.empty() && region(x, y) == 0) {
        continue;
      }
      const double radii = defect.distance_px({x + 0.5, y + 0.5}) / defect.radius_px;
      const auto grey = static_cast<double>(picture(x, y));
      if (radii <= 1.0) {
        inside.add(grey);
      } else if (radii >= kInnerRing && radii <= kOuterRing) {
        around.add(grey);
      }
    }
  }
  if (inside.count < kLeastPixels || around.count < kLeastPixels || around.mean() <= 0.0) {
    return std::nullopt;
  }
  const double contrast = inside.mean() / around.mean() - 1.0;
  const double ratio = inside.mean() / around.mean();
  const double deviation =
      std::sqrt(inside.variance() + ratio * ratio * around.variance()) / around.mean();
  return Estimate{
      .value = contrast, .low = contrast - 1.96 * deviation, .high = contrast + 1.96 * deviation};
}

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

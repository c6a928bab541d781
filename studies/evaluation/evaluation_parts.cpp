// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/evaluation/evaluation_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace glint {

double sigma_floor(const SensorSettings& sensor) {
  constexpr double kSmallest = 1e-4;
  return std::max(kSmallest, noise_floor(sensor));
}

DefectTotals totals_of(const DefectivePart& part) {
  DefectTotals totals;
  for (const RealisedDefect& made : part.defects) {
    if (made.is_made) {
      ++totals.made;
      totals.mean_depth_um += made.defect.depth_mm * 1e3;
      totals.removed_volume_mm3 += made.removed_volume_mm3;
    }
  }
  totals.mean_depth_um /= std::max(1, totals.made);
  return totals;
}

double change_threshold(const SceneSettings& scene) {
  const SensorSettings& sensor = scene.sensor;
  constexpr double kSigmas = 5.0;
  const double shot = sensor.full_well_e > 0.0 ? std::sqrt(sensor.gain / sensor.full_well_e) : 0.0;
  const double noise = std::hypot(noise_floor(sensor), shot);
  return std::max({scene.metrics.signature_floor, kSigmas * noise, sigma_floor(sensor)});
}

std::vector<DefectScores> scored_defects(const ImageF& aspect,
                                         std::span<const DefectPixels> defects,
                                         const BestFrames& best,
                                         const SceneSettings& scene) {
  std::vector<DefectScores> scored =
      defect_scores(aspect, defects, sigma_floor(scene.sensor), scene.metrics);
  for (std::size_t i = 0; i < scored.size(); ++i) {
    scored[i].best_frame = best.best()[i].difference;
    scored[i].change = best.best()[i].change;
    scored[i].union_area = best.best()[i].union_area;
    scored[i].frame = best.best()[i].frame;
    scored[i].change_frame = best.best()[i].change_frame;
  }
  return scored;
}

FamilyScales scales_of(const SceneSettings& scene,
                       std::span<const DefectPixels> defects,
                       const std::optional<FringeScores>& fringes) {
  FamilyScales scales;
  double largest_px = 0.0;
  for (const DefectPixels& defect : defects) {
    largest_px = std::max(largest_px, 2.0 * std::sqrt(defect.area_px / std::numbers::pi));
  }
  if (scene.metrics.defect_diameter_px > 0.0) {
    scales.defect_diameter_px = scene.metrics.defect_diameter_px;
  } else if (largest_px > 0.0) {
    scales.defect_diameter_px = largest_px;
  }
  scales.period_px = fringes ? fringes->period_px : 0.0;
  return scales;
}

}  // namespace glint

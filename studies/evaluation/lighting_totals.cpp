// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/evaluation/lighting_totals.h"

#include <optional>

#include <Eigen/Core>

#include "simulator/light/area/light_extent.h"
#include "studies/definition/scene_scores.h"

namespace glint {
namespace {

using Eigen::Vector3d;

/// Empty where an environment shines or nothing does.
std::optional<LightingTotals::Size> size_of(const SceneSettings& scene, const LightExtent& extent) {
  if (!shining_environment(scene).empty() || extent.box_mm.isEmpty()) {
    return std::nullopt;
  }
  const Vector3d sizes = extent.box_mm.sizes();
  return LightingTotals::Size{.length_mm = sizes.x(),
                              .width_mm = sizes.y(),
                              .height_mm = sizes.z(),
                              .area_mm2 = extent.area_mm2};
}

}  // namespace

LightingTotals lighting_totals(const SceneSettings& scene, const MeshLoader& load_mesh) {
  const StageScan stage = stage_scan(scene);
  const LightExtent extent = shining_extent(scene, load_mesh);
  LightingTotals totals = {
      .size = size_of(scene, extent), .leds = extent.leds, .frames = stage.positions};
  const CostSettings cost = scene.cost.value_or(CostSettings{});
  if (cost.exposure_s && (cost.move_s || totals.frames == 1)) {
    totals.scan_s =
        totals.frames * *cost.exposure_s + (totals.frames - 1) * cost.move_s.value_or(0.0);
  }
  const bool is_priced = cost.per_mm2 || cost.per_led || cost.per_frame;
  if (is_priced && (totals.size || !cost.per_mm2)) {
    const double area_mm2 = totals.size ? totals.size->area_mm2 : 0.0;
    totals.cost = cost.per_mm2.value_or(0.0) * area_mm2 + cost.per_led.value_or(0.0) * totals.leds +
                  cost.per_frame.value_or(0.0) * totals.frames;
  }
  return totals;
}

}  // namespace glint

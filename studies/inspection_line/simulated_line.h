// SPDX-License-Identifier: GPL-3.0-or-later
//
// A simulated inspection line: parts with defects drawn anew, and flawless ones, pass under one
// lighting; each is scanned once, with its own noise. Part and noise of one number are the same for
// every lighting, so that candidates differ in nothing else.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "metrics/inspection/inspector.h"
#include "metrics/inspection/match_detections.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// What a defect adds to the radiance, squared and summed over its pixels, and how much of that is
/// noise of the rendering; both 0 where rendering has none.
struct RenderedEnergy {
  double total = 0.0;
  double noise = 0.0;  ///< right on average
};

/// A defect as it was made, and as the camera sees it.
struct TrueDefect {
  Defect defect;
  HeightFeature outline;
  DefectView view;         ///< empty picture: the camera does not see its place
  bool is_masked = false;  ///< its middle lies outside the line's region
  RenderedEnergy rendering;
};

struct ScannedPart {
  ImageF aspect;    ///< one scan's; 0 outside the part
  ImageF response;  ///< the inspector's, 0 outside the line's region
  std::vector<TrueDefect> defects;
};

/// A blob is within reach of a defect whose middle lies within hit_radii of some pixel whose centre
/// is no farther from the blob's middle than the slack. Masked defects count as missed.
DetectionMatches match_detections(std::span<const FoundDefect> found,
                                  std::span<const TrueDefect> truth,
                                  const TrialSettings& settings);

/// Of a scene whose part the line inspects.
/// @throws ConfigError beginning with the key at fault when the inspector's rim leaves nothing of
///         the flawless part, IoError
void check_inspected_region(SceneStore& store, const SceneSettings& scene);

class SimulatedLine {
 public:
  /// Builds the part and traces its flawless surface. The defects are those of scene.defects, drawn
  /// with scene.imprint.seed + number.
  /// @param store, scene  store must outlive this object
  /// @throws ConfigError beginning with the key at fault, IoError
  SimulatedLine(SceneStore& store, const SceneSettings& scene);
  ~SimulatedLine();
  SimulatedLine(const SimulatedLine&) = delete;
  SimulatedLine& operator=(const SimulatedLine&) = delete;

  const SceneSettings& scene() const;
  const Inspector& inspector() const;

  /// Where it looks: the part without its rim, without dark pixels and those whose flawless
  /// response without noise is larger than inspection.trials.mask_grey.
  const Mask& region() const;

  /// Share of the part (without its rim) that the region covers.
  double region_share() const;

  /// Share of the rendering's noise in the variance of a flawless scan's response over the region:
  /// 0 for level 0, which has none. It is the same on all scans, as if it belonged to the part.
  double rendering_share() const;

  /// The flawless part without noise.
  const ImageF& expected_aspect() const;

  /// Scan of a flawless part. Safe to call from several threads, as are the others.
  ScannedPart flawless(std::int64_t number) const;

  /// Scan of part `number`.
  ScannedPart part(std::int64_t number) const;

  /// Scan of a part with given defects instead (of scene.defects' names); noise of `number`.
  ScannedPart part_with(const std::vector<NamedGroup>& defects, std::int64_t number) const;

  /// How steep the defects of that part are [rad]; see defects/part/defect_slope.h.
  std::vector<double> slopes_rad(const std::vector<NamedGroup>& defects, std::int64_t number) const;

  /// The inspector's list inside the line's region. @param threshold  of |response|
  std::vector<FoundDefect> inspect(const ScannedPart& part, double threshold) const;

  /// The threshold that the settings ask for; of false_alarms: from inspection.trials.flawless
  /// scans.
  double threshold() const;

 private:
  struct Data;
  std::unique_ptr<Data> data_;
};

}  // namespace glint

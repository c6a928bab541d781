// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a simulated inspection line needs of a camera: scans of the flawless part and of parts with
// defects. Like picture_of(), line_camera_of() alone asks which transport a scene needs.
#pragma once

#include <memory>
#include <vector>

#include "core/image/image.h"
#include "simulator/sensor/sensor.h"
#include "studies/imaging/built_part.h"
#include "studies/imaging/scene_store.h"
#include "studies/imaging/traced_scene.h"

namespace glint {

/// One scan of a part. Grey values; what lies outside the part is of no meaning.
struct LineScan {
  ImageF aspect;               ///< mean of the frames
  std::vector<ImageF> frames;  ///< of a line whose inspector looks at phases, else empty
  std::shared_ptr<const VisibilityBuffer> seen;  ///< what of the part each pixel sees
  /// Two independent renderings of the radiance that the defects add, mean of the frames; empty
  /// where rendering has no noise, and on flawless parts.
  std::vector<ImageF> changes;
};

/// The flawless part without the sensor's noise.
struct ExpectedLine {
  LineScan quiet;
  ImageF aspect;  ///< what noisy scans are on average, rounding included where that is known
  /// Two independent renderings whose mean is `quiet`; empty where rendering has no noise.
  std::vector<LineScan> renderings;
};

/// Safe to call from several threads; the same bytes for any number of them.
class LineCamera {
 public:
  LineCamera() = default;
  virtual ~LineCamera() = default;
  LineCamera(const LineCamera&) = delete;
  LineCamera& operator=(const LineCamera&) = delete;

  virtual ExpectedLine expected() const = 0;

  /// @param sensor  the scene's, with the seed of this scan's noise
  virtual LineScan flawless(const SensorSettings& sensor) const = 0;
  virtual LineScan part(const BuiltDefects& part, const SensorSettings& sensor) const = 0;
};

/// @param store   must outlive the camera
/// @param scene   from the viewpoint that is scored
/// @param traced  the flawless part, which fits into the tunnel if there is one
/// @throws ConfigError beginning with the key at fault, IoError
std::unique_ptr<LineCamera> line_camera_of(SceneStore& store,
                                           const SceneSettings& scene,
                                           std::shared_ptr<const TracedScene> traced);

}  // namespace glint

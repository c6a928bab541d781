// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mean of a scan by closed forms, with frames made only where they do not hold
// (docs/theory/clipped_mean.md):
//
//   floors  the sensor is linear for this light: the frames' mean is the blurred mean radiance, and
//           that over whole periods is again a square wave, of N times the frequency
//   table   the sensor clips: T(w) of clipped_mean.h where the phase is linear over the blur (of
//           shining_mean.h under dark stripes whose light depends on the place); frames for the
//           other pixels
//   frames  neither: stripes that do not complete a period, or an uneven light
#pragma once

#include <memory>

#include "core/image/image.h"
#include "core/image/spans.h"
#include "simulator/render/footprint/footprint_cells.h"
#include "simulator/render/scan/frame_pictures.h"
#include "simulator/render/scan/scan.h"
#include "simulator/render/scan/scan_plan.h"

namespace glint {

/// What a closed scan leaves. Images are right in the region and at the watched pixels.
struct ClosedScan {
  ImageF aspect;     ///< expected mean of the frames; as taken where they were rendered
  ImageF deviation;  ///< of the mean around it, by noise and few frames; empty: none
  Image<std::uint16_t> clipped_frames;  ///< closed forms: all or none; floors alone: empty
  ScanForm form;
  std::shared_ptr<const PixelCells> cells;  ///< of the frames; empty: none were rendered
};

/// @param consume  sees the frames' grey values, right at the watched pixels only; may be empty
/// @param pool     where pictures come from when few pixels are rendered; nullptr: new ones
ClosedScan scan_closed(const Footprints& footprints,
                       const Sensor& sensor,
                       const ScanPlan& plan,
                       const FrameConsumer& consume = {},
                       FramePicturePool* pool = nullptr);

/// Shows the frames of a scan, integrated, to `consume`.
/// @param where  pixels at which they are right: there they are those of scan_integrated()
void watch_integrated(const Footprints& footprints,
                      const Sensor& sensor,
                      const Spans& where,
                      const FrameConsumer& consume);

/// All frames of a scan, integrated; the whole picture.
ScanResult scan_integrated(const Footprints& footprints,
                           const Sensor& sensor,
                           const FrameConsumer& consume = {});

}  // namespace glint

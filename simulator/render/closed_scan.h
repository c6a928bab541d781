// SPDX-License-Identifier: GPL-3.0-or-later
//
// The mean of a scan by closed forms, with frames made only where they do not hold
// (docs/theory/clipped_mean.md):
//
//   floors  the sensor is linear for this light: the frames' mean is the blurred mean radiance, and
//           that over whole periods is again a square wave, of N times the frequency
//   table   the sensor clips: T(w) of clipped_mean.h where the phase is linear over the blur;
//   frames
//           for the other pixels
//   frames  neither: stripes that do not complete a period, an uneven light
#pragma once

#include <memory>
#include <string_view>

#include "core/image.h"
#include "simulator/render/clipped_mean.h"
#include "simulator/render/footprints.h"
#include "simulator/render/scan.h"

namespace glint {

/// How the mean of a scan came about.
struct ScanForm {
  enum class Kind { kFloors, kTable, kFrames };

  Kind kind = Kind::kFrames;
  int table_pixels = 0;  ///< of the region, from the table or wholly dark
  int frame_pixels = 0;  ///< rendered frame by frame
};

std::string_view form_name(ScanForm::Kind kind);

/// What a closed scan leaves. Images are right in the region and at the watched pixels.
struct ClosedScan {
  ImageF aspect;     ///< expected mean of the frames; as taken where they were rendered
  ImageF deviation;  ///< of the mean around it, by noise and few frames; empty: none
  Image<std::uint16_t> clipped_frames;  ///< closed forms: all or none; floors alone: empty
  ScanForm form;
  std::shared_ptr<const PixelCells> cells;  ///< of the frames; empty: none were rendered
};

/// The stripes as the table wants them.
StripeSettings stripes_of(const ScanPositions& positions, double reflectance);

/// Which closed form holds, boundaries of the light aside.
ScanForm::Kind form_of(const ScanPositions& positions,
                       const SensorSettings& sensor,
                       double reflectance);

/// Pixels sorted by what their mean needs. What remains of the region is dark in every frame.
struct ScanPlan {
  ScanForm form;
  Spans by_floors;  ///< from the mean radiance
  Mask by_table;    ///< from T(w); empty where it is not used
  Mask by_frames;   ///< and the watched pixels; empty: none
  ImageF width;     ///< w of T(w) [periods], where by_table
  double reflectance = 1.0;
  std::shared_ptr<const ClippedMean> table;  ///< T; empty where it is not used
};

/// @param region       pixels whose mean is wanted
/// @param watched      pixels that are wanted frame by frame, of the picture's size; empty: none
/// @param reflectance  of the part
ScanPlan plan_scan(const Footprints& footprints,
                   const Sensor& sensor,
                   const Region& region,
                   const Mask& watched,
                   double reflectance);

/// @param consume  sees the frames' grey values, right at the watched pixels only; may be empty
ClosedScan scan_closed(const Footprints& footprints,
                       const Sensor& sensor,
                       const ScanPlan& plan,
                       const FrameConsumer& consume = {});

/// All frames of a scan, integrated; the whole picture.
ScanResult scan_integrated(const Footprints& footprints,
                           const Sensor& sensor,
                           const FrameConsumer& consume = {});

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which closed form gives the mean of a scan, pixel by pixel (docs/theory/clipped_mean.md): floors,
// the table T(w), or frames. closed_scan.h carries the plan out.
#pragma once

#include <memory>
#include <string_view>

#include "core/image/image.h"
#include "core/image/spans.h"
#include "simulator/render/footprint/footprints.h"
#include "simulator/render/scan/clipped_mean.h"
#include "simulator/render/scan/shining_mean.h"
#include "simulator/render/scan/width_kernels.h"

namespace glint {

/// How the mean of a scan came about.
struct ScanForm {
  enum class Kind { kMeanRadiance, kTable, kFrames };

  Kind kind = Kind::kFrames;
  int table_pixels = 0;  ///< of the region, from the table or wholly dark
  int frame_pixels = 0;  ///< rendered frame by frame
};

std::string_view form_name(ScanForm::Kind kind);

/// The stripes as the table wants them.
StripeSettings stripes_of(const ScanPositions& positions, double reflectance);

/// Which closed form holds, boundaries of the light aside.
ScanForm::Kind form_of(const ScanPositions& positions,
                       const SensorSettings& sensor,
                       double reflectance);

/// How far from a pixel others count: beyond, less than a small share of the light, times the gain,
/// spreads to it from one side [px].
int reach_of(const Sensor& sensor, double reflectance);

/// Tiles of pixels that few frames are taken to disturb alike.
inline constexpr int kRippleTileWidth_px = footprint_kernels::kRun;
inline constexpr int kRippleTileHeight_px = 8;

/// Pixels sorted by what their mean needs. What remains of the region is dark in every frame.
struct ScanPlan {
  ScanForm form;
  Spans by_mean_radiance;  ///< from the mean radiance
  Mask by_table;           ///< from T(w); empty where it is not used
  Mask by_frames;          ///< and the watched pixels; empty: none
  ImageF width;            ///< w of T(w) [periods], where by_table
  ImageF ripple;           ///< deviation by few frames where by_table, tile by tile
  ImageF correction;       ///< of T(w) there, tile by tile: 1 where pixels are Gaussians
  double reflectance = 1.0;
  std::shared_ptr<const ClippedMean> table;  ///< T; empty where it is not used
  // Instead of `table` under dark stripes whose light depends on the place, else empty:
  std::shared_ptr<const ShiningMean> shining;
  ImageF dark;  ///< radiance of dark stripes, right where by_table
};

/// @param region       pixels whose mean is wanted
/// @param watched      pixels that are wanted frame by frame, of the picture's size; empty: none
/// @param reflectance  of the part
ScanPlan plan_scan(const Footprints& footprints,
                   const Sensor& sensor,
                   const Region& region,
                   const Mask& watched,
                   double reflectance);

/// The tables that a plan's pixels need: `table`, or `dark` and `shining`.
/// @param plan  with its reflectance and pixels by_table
void find_tables(const Footprints& footprints, const Sensor& sensor, ScanPlan& plan);

}  // namespace glint

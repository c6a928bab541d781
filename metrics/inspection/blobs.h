// SPDX-License-Identifier: GPL-3.0-or-later
//
// From a response to its blobs: 8-connected pixels of one sign beyond a threshold.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image/image.h"
#include "core/thread_pool.h"
#include "metrics/inspection/inspector.h"

namespace glint {

/// Exact sums over a blob's pixels, columns and rows counted from 0.
struct PixelSums {
  std::int64_t count = 0;
  std::int64_t x = 0;
  std::int64_t y = 0;
  std::int64_t xx = 0;
  std::int64_t xy = 0;
  std::int64_t yy = 0;

  void add(const PixelSums& other);
};

/// The sums over columns [begin, end) of row y, end > begin.
PixelSums sums_of_run(int y, int begin, int end);

/// Second central moments a pixel, each pixel's own extent included.
struct BlobMoments {
  double mu20 = 0.0;
  double mu11 = 0.0;
  double mu02 = 0.0;
};

BlobMoments moments_of(const PixelSums& sums);

/// Hole or scratch. The printed rule (equation 4 of the first seed) looks at the direction only and
/// is kept to show that.
DefectKind kind_of(const BlobMoments& moments, int area_px, const InspectionSettings& settings);

/// Blobs of at least min_area_px by their first pixel, row by row.
/// @param threshold  > 0, of |response|
std::vector<FoundDefect> find_blobs(const ImageF& response,
                                    double threshold,
                                    const InspectionSettings& settings,
                                    ThreadPool& pool);

}  // namespace glint

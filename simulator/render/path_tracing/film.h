// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/image/image.h"

namespace glint {

/// Rays traced through the part's triangles, and the seconds this took, summed over threads.
struct PathCounts {
  std::int64_t camera = 0;
  std::int64_t shadow = 0;
  std::int64_t bounce = 0;
  std::int64_t dropped = 0;  ///< contributions that were no finite number >= 0; should be 0
  double camera_s = 0.0;
  double shadow_s = 0.0;
  double bounce_s = 0.0;

  PathCounts& operator+=(const PathCounts& other);
};

/// Of one light group: for each channel the sum over the samples of a pixel, W / (m^2 sr), at
/// factor 1.
struct GroupSums {
  std::vector<ImageF> channels;
};

/// How many samples of a pixel see one defect.
struct DefectSums {
  std::int32_t id = 0;
  Image<std::uint16_t> samples;
};

/// What paths have brought so far; sums over the samples of each pixel. Linear in every group.
struct Film {
  int width_px = 0;
  int height_px = 0;
  Image<std::int32_t> samples;    ///< of each pixel
  std::vector<GroupSums> groups;  ///< as Lights::groups
  ImageF squares;                 ///< of the total at the groups' factors, mean of the channels

  // What the camera rays met first; lights do not hide the part here.
  Image<std::int32_t> part;         ///< samples on the part
  std::vector<DefectSums> defects;  ///< by id
  ImageF depth_mm;                  ///< along the camera's axis
  ImageF normal_x, normal_y, normal_z;
  ImageF x_mm, y_mm, z_mm;       ///< scene frame
  ImageF tilt;                   ///< 1 - cosine between normal and ray
  Image<std::int32_t> triangle;  ///< of the first sample on the part, -1: none
  Image<std::int32_t> defect;    ///< id of the first sample on a defect, -1: none
  PathCounts counts;

  /// 0 without light.
  std::size_t num_channels() const { return groups.empty() ? 0 : groups.front().channels.size(); }
};

/// Which pixels show what. background + sound + the defects = 1 in every pixel.
struct CoverageImages {
  ImageF background;
  ImageF sound;  ///< part without defect
  std::vector<std::int32_t> ids;
  std::vector<ImageF> defects;  ///< one for each id
};

/// Means over the samples that met the part; 0 where none did.
struct SurfaceImages {
  ImageF depth_mm;
  ImageF normal_x, normal_y, normal_z;  ///< unit
  ImageF x_mm, y_mm, z_mm;
  ImageF incidence_rad;  ///< between normal and ray, of the mean cosine
};

/// Standard error of the total at the scene's factors, one for each group: mean of the channels, by
/// the spread of single samples. Stratified samples err less: a bound rather than an estimate.
/// Pixels of one sample: inf.
ImageF standard_error_image(const Film& sums, std::span<const double> factors);

CoverageImages coverage_images(const Film& sums);
SurfaceImages surface_images(const Film& sums);

}  // namespace glint

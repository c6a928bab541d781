// SPDX-License-Identifier: GPL-3.0-or-later
//
// How much of two regions is common to both. Where the shares of pixels are known the figures are
// those of the outlines, not of their pixels: sums of the smaller and of the larger share.
#pragma once

#include <Eigen/Geometry>

#include "core/image/image.h"

namespace glint {

struct RegionOverlap {
  double iou = 1.0;       ///< intersection over union, in [0, 1]
  double dice = 1.0;      ///< twice the intersection over both areas, in [0, 1]
  double first_px = 0.0;  ///< areas
  double second_px = 0.0;
};

/// Two regions of one picture. Both empty: they agree, 1.
/// @throws ConfigError for different sizes
RegionOverlap overlap_of(const Mask& first, const Mask& second);

/// The same by the share of each pixel that a region covers, in [0, 1].
RegionOverlap overlap_of(const ImageF& first, const ImageF& second);

/// The value of a picture where the middle of another one's pixel (x, y) lies in it; 0 beyond its
/// border.
/// @tparam Picture  an Image
template <class Picture>
double value_under(const Picture& picture, const Eigen::Affine2d& to_picture, int x, int y) {
  const Eigen::Vector2d at = to_picture * Eigen::Vector2d(x + 0.5, y + 0.5);
  const bool is_inside =
      at.x() >= 0.0 && at.y() >= 0.0 && at.x() < picture.width() && at.y() < picture.height();
  return is_inside
             ? static_cast<double>(picture(static_cast<int>(at.x()), static_cast<int>(at.y())))
             : 0.0;
}

/// Pixels of a picture that lie wholly in its region and, where a motion takes them, wholly in that
/// of another picture.
/// @param own, other  the share of each pixel that the regions cover, of any sizes
/// @param to_other    from places in `own` to places in `other`
/// @returns of the size of `own`; empty where there are fewer than 100 such pixels
Mask pixels_on_both(const ImageF& own,
                    const ImageF& other,
                    const Eigen::Affine2d& to_other = Eigen::Affine2d::Identity());

}  // namespace glint

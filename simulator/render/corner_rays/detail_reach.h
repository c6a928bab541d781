// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/image/image.h"
#include "simulator/camera/pinhole_camera.h"
#include "simulator/geometry/part/part.h"
#include "simulator/geometry/surface/surface_detail.h"

namespace glint {

/// What can hide between the corners of a pixel, found by projection onto the image.
class RefinementNeed {
 public:
  RefinementNeed(const PinholeCamera& camera,
                 const RigidTransform& camera_from_world,
                 const Part& part,
                 const SurfaceDetail& detail);

  /// The need of rows [first, first + count), as rows 0 and on, without that of features.
  RefinementNeed vertices_in(int first, int count) const;

  /// Cells that a pixel within the reach of a feature must be cut into at least, so that their
  /// corners stand no further apart than 1.5 sigma of its cross-section: 2, 4, 8 or 16. Stains: no
  /// further than half their edge; 16 where they are rough.
  /// 0: out of reach of all features.
  int cells(int x, int y) const { return cells_.empty() ? 0 : cells_(x, y); }

  /// The error of interpolated directions that is allowed in a pixel: the general one, or less
  /// where a feature is so flat that it would not be small against what the feature does to the
  /// light.
  double max_error_rad(int x, int y, double general_rad) const {
    return max_error_.empty() ? general_rad
                              : std::min(general_rad, static_cast<double>(max_error_(x, y)));
  }

  /// True when a vertex of the mesh appears in the pixel.
  bool has_vertex(int x, int y) const { return has_vertex_(x, y) != 0; }

 private:
  RefinementNeed() = default;

  void add_feature(const PinholeCamera& camera,
                   const RigidTransform& camera_from_world,
                   const HeightFeature& feature);

  Image<std::uint8_t> cells_;
  ImageF max_error_;
  Mask has_vertex_;
};

}  // namespace glint

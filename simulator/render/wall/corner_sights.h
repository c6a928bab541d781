// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which pixels of the part a tunnel's wall hides, wholly or in part, by the camera's rays through
// their corners.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "simulator/light/tunnel/tunnel.h"
#include "simulator/render/ray_cache/packet_tracer.h"
#include "simulator/render/ray_cache/ray_cache.h"

namespace glint {

/// Pixels [left, right) of rows [top, bottom).
struct PixelArea {
  int left = 0, right = 0, top = 0, bottom = 0;
};

/// A pixel of which the wall hides a part. Arrays are those of its corners (x0 y0, x1 y0, x0 y1,
/// x1 y1): the sight line from the part to the camera, and where it crosses the wall
/// (Tunnel::intersect_block).
struct OccludedEdge {
  using Corners = std::array<float, 4>;

  std::int32_t pixel = 0;  ///< index y * width + x
  Corners origin_x = {}, origin_y = {}, origin_z = {};
  Corners direction_x = {}, direction_y = {}, direction_z = {};  ///< the camera at t = 1
  Corners x_mm = {}, y_mm = {}, margin_mm = {};

  bool operator==(const OccludedEdge&) const = default;
};

/// What of the part the wall hides.
struct OccludedPixels {
  Mask whole;                       ///< 1 where all of a pixel is hidden; empty: nowhere
  std::vector<OccludedEdge> edges;  ///< by growing pixels

  bool operator==(const OccludedPixels&) const = default;
};

/// Looks at pixels corner by corner. References must outlive it.
class CornerSights {
 public:
  /// @param seen  by a camera that it knows
  CornerSights(const VisibilityBuffer& seen,
               const Tunnel& tunnel,
               const Eigen::Vector3d& camera_in_world_mm);

  /// Adds the hidden pixels of an area; the mask is made where it is needed.
  void add_hidden(const PixelArea& area, OccludedPixels& found);

  /// The camera's ray through a point of the image [px], unit.
  Eigen::Vector3d direction(double x_px, double y_px) const;

 private:
  /// Sight lines of a row of corners.
  struct Row {
    std::vector<float> origin_x, origin_y, origin_z, direction_x, direction_y, direction_z;
    std::vector<float> x_mm, y_mm, margin_mm;
    std::vector<unsigned char> code;

    void resize(std::size_t count);
  };

  void load(const PixelArea& area, int y, Row& row) const;
  double distance_mm(int x, int y, const Eigen::Vector3d& direction) const;
  unsigned char code_of(const Row& row, std::size_t i) const;
  OccludedEdge edge_of(std::int32_t pixel, std::size_t i) const;

  const VisibilityBuffer& seen_;
  const Tunnel& tunnel_;
  Eigen::Vector3d camera_mm_;
  CameraRays rays_;
  double half_slot_mm_, half_length_mm_;
  bool is_between_panels_;  ///< the camera, of a flat tunnel: nothing is hidden
  Row above_, below_;
};

}  // namespace glint

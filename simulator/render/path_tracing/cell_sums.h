// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "simulator/render/path_tracing/path_packet.h"
#include "simulator/render/path_tracing/path_sums.h"

namespace glint {

/// Pictures are made in square cells of this width [px]; a cell belongs to one thread at a time.
inline constexpr int kCellWidth_px = 8;
inline constexpr std::size_t kCellPixels = 64;

/// The pixels of one cell, cut at the picture's border.
struct Cell {
  int x_px = 0;
  int y_px = 0;
  int width_px = 0;
  int height_px = 0;
};

/// All cells of a picture, row by row.
std::vector<Cell> cells_of(int width_px, int height_px);

/// Place of a pixel within a cell: 8 y + x.
using CellPixel = std::uint32_t;

/// What one pass adds to the pixels of a cell, in double.
class CellSums {
 public:
  /// @param groups  factors of the light groups @param channels  1 or 3 @param ids  of all defects
  CellSums(std::vector<double> factors, int channels, std::vector<std::int32_t> ids);

  void clear();

  /// What a path adds to the total, mean of the channels, is returned; a value that is no finite
  /// number >= 0 adds nothing and is counted.
  double add_light(CellPixel pixel, int group, const std::array<float, 3>& radiance);
  void add_square(CellPixel pixel, double total);
  /// What a lane of camera rays met.
  void add_surface(CellPixel pixel,
                   const SurfaceLanes& surface,
                   const PathPacket& paths,
                   const Eigen::Vector3d& camera_axis,
                   std::size_t lane);

  /// Adds everything to the picture. @param samples  of each pixel in this pass
  void add_to(const Cell& in_picture, int samples, PathSums& sums) const;

  std::int64_t dropped() const { return dropped_; }

 private:
  /// A number for each pixel of a cell.
  using Plane = std::array<double, kCellPixels>;

  struct Surface {
    Plane depth_mm = {};
    Plane tilt = {};  ///< 1 - cos(incidence)
    Plane normal_x = {}, normal_y = {}, normal_z = {};
    Plane x_mm = {}, y_mm = {}, z_mm = {};
    std::array<std::int32_t, kCellPixels> samples = {};
    std::array<std::int32_t, kCellPixels> triangle = {};
    std::array<std::int32_t, kCellPixels> defect = {};
  };

  /// @param cell  in the images of the sums
  void add_ids(const Cell& cell, PathSums& sums) const;

  std::vector<double> factors_;
  std::size_t channels_;
  std::vector<std::int32_t> ids_;
  std::vector<Plane> light_;  ///< by group, channel
  Plane squares_ = {};
  Surface surface_;
  std::vector<std::uint16_t> defects_;  ///< by pixel, id
  std::int64_t dropped_ = 0;
};

/// Sums of nothing yet.
PathSums empty_sums(
    int width_px, int height_px, std::size_t groups, int channels, std::vector<std::int32_t> ids);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "simulator/render/physical/path_sums.h"
#include "simulator/render/physical/surface_point.h"

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
  double add_light(CellPixel pixel, int group, const Colour& radiance);
  void add_square(CellPixel pixel, double total);
  void add_surface(CellPixel pixel,
                   const ShadingPoint& point,
                   const Ray& ray,
                   const Eigen::Vector3d& camera_axis,
                   std::int32_t triangle);

  /// Adds everything to the picture. @param samples  of each pixel in this pass
  void add_to(const Cell& cell, int samples, PathSums& sums) const;

  std::int64_t dropped() const { return dropped_; }

 private:
  struct Surface {
    int samples = 0;
    double depth_mm = 0.0;
    double tilt = 0.0;  ///< 1 - cos(incidence)
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
    std::int32_t triangle = -1;
    std::int32_t defect = -1;
  };

  void add_pixel(CellPixel from, int x, int y, PathSums& sums) const;

  std::vector<double> factors_;
  std::size_t channels_;
  std::vector<std::int32_t> ids_;
  std::vector<double> light_;  ///< by pixel, group, channel
  std::array<double, kCellPixels> squares_ = {};
  std::array<Surface, kCellPixels> surface_ = {};
  std::vector<std::uint16_t> defects_;  ///< by pixel, id
  std::int64_t dropped_ = 0;
};

/// Sums of nothing yet.
PathSums empty_sums(
    int width_px, int height_px, std::size_t groups, int channels, std::vector<std::int32_t> ids);

}  // namespace glint

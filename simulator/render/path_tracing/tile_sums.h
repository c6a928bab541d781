// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "simulator/render/path_tracing/film.h"
#include "simulator/render/path_tracing/path_packet.h"

namespace glint {

/// Pictures are made in square tiles of this width [px]; a tile belongs to one thread at a time.
inline constexpr int kTileWidth_px = 8;
inline constexpr std::size_t kTilePixels = 64;

/// The pixels of one tile, cut at the picture's border.
struct Tile {
  int x_px = 0;
  int y_px = 0;
  int width_px = 0;
  int height_px = 0;
};

/// All tiles of a picture, row by row.
std::vector<Tile> tiles_of(int width_px, int height_px);

/// Place of a pixel within a tile: 8 y + x.
using TilePixel = std::uint32_t;

/// What one pass adds to the pixels of a tile, in double.
class TileSums {
 public:
  /// @param groups  factors of the light groups @param channels  1 or 3 @param ids  of all defects
  TileSums(std::vector<double> factors, int channels, std::vector<std::int32_t> ids);

  void clear();

  /// What a path adds to the total, mean of the channels, is returned; a value that is no finite
  /// number >= 0 adds nothing and is counted.
  double add_light(TilePixel pixel, int group, const std::array<float, 3>& radiance);
  void add_square(TilePixel pixel, double total);
  /// What a lane of camera rays met.
  void add_surface(TilePixel pixel,
                   const SurfaceLanes& surface,
                   const PathPacket& paths,
                   const Eigen::Vector3d& camera_axis,
                   std::size_t lane);

  /// Adds everything to the picture. @param samples  of each pixel in this pass
  void add_to(const Tile& in_picture, int samples, Film& sums) const;

  std::int64_t dropped() const { return dropped_; }

 private:
  /// A number for each pixel of a tile.
  using Plane = std::array<double, kTilePixels>;

  struct Surface {
    Plane depth_mm = {};
    Plane tilt = {};  ///< 1 - cos(incidence)
    Plane normal_x = {}, normal_y = {}, normal_z = {};
    Plane x_mm = {}, y_mm = {}, z_mm = {};
    std::array<std::int32_t, kTilePixels> samples = {};
    std::array<std::int32_t, kTilePixels> triangle = {};
    std::array<std::int32_t, kTilePixels> defect = {};
  };

  /// @param tile  in the images of the sums
  void add_ids(const Tile& tile, Film& sums) const;

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
Film empty_film(
    int width_px, int height_px, std::size_t groups, int channels, std::vector<std::int32_t> ids);

}  // namespace glint

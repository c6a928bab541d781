// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <vector>

#include <Eigen/Core>

namespace glint {

/// Light from infinitely far away, as a latitude-longitude picture of constant radiance per pixel.
/// The top row looks along +z, the left edge along +x, columns run towards +y. Directions are drawn
/// exactly in proportion to radiance (mean of the channels).
class Environment {
 public:
  /// The same from everywhere.
  explicit Environment(const Eigen::Array3f& radiance);

  /// @param radiance  height rows of width columns, finite and >= 0 (the caller checks)
  Environment(int width, int height, std::vector<std::array<float, 3>> radiance);

  /// @param direction  unit, from the scene outwards
  Eigen::Array3f radiance(const Eigen::Vector3d& direction) const;

  struct Sample {
    Eigen::Vector3d direction = Eigen::Vector3d::UnitZ();
    Eigen::Array3f radiance = Eigen::Array3f::Zero();
    double density = 0.0;  ///< per steradian; 0: all is dark
  };

  /// @param u, v  in [0, 1)
  Sample sample(double u, double v) const;

  double density(const Eigen::Vector3d& direction) const;

  /// Mean of radiance and channels over all directions.
  double mean_radiance() const { return mean_radiance_; }

 private:
  std::size_t pixel_of(const Eigen::Vector3d& direction) const;
  Eigen::Array3f pixel(std::size_t index) const;
  double pixel_share(std::size_t index) const;
  double pixel_solid_angle_sr(std::size_t index) const;

  std::size_t width_ = 1;
  std::size_t height_ = 1;
  std::vector<std::array<float, 3>> radiance_;
  std::vector<double> sums_;      ///< power share within a row, of this and all pixels before it
  std::vector<double> row_sums_;  ///< of the rows
  double mean_radiance_ = 0.0;
};

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures as textures: they need no coordinates on the part's surface, since a point of the part
// is projected to the picture. Points too far out to be told apart are not expected (parts are at
// most metres large).
#pragma once

#include <filesystem>
#include <vector>

#include "core/config/keys.h"
#include "simulator/material/lay.h"
#include "simulator/material/material.h"
#include "simulator/material/texture_picture.h"

namespace glint {

/// Keys of [material.texture]: factors of colour and roughness from picture files.
///
/// The picture lies in the frame (u, v, axis): u is x laid across the axis (y if that stands along
/// x), turned by rotation_rad about the axis; v completes the frame. Pictures stand upright: their
/// columns run along u, their rows against v, their middle is at center_mm.
struct TextureSettings {
  enum class Mapping {
    kPlanar,       ///< along the axis
    kCylindrical,  ///< around the axis: columns are angles from u towards v, rows run against axis
    kBox  ///< six planes; a point belongs to the face that the ray from center_mm through it meets
  };

  std::filesystem::path colour_file;     ///< empty: none. Multiplies the light reflected
  std::filesystem::path roughness_file;  ///< empty: none; of colour pictures, the first channel
  TextureEncoding encoding = TextureEncoding::kAuto;  ///< of the colours; roughness is linear
  Interval roughness_factor = {0.5, 1.5};             ///< of black and of white; > 0
  Mapping mapping = Mapping::kPlanar;
  std::vector<double> center_mm = {0.0, 0.0, 0.0};
  std::vector<double> axis = {0.0, 0.0, 1.0};  ///< any length
  double rotation_rad = 0.0;
  std::vector<double> size_mm = {10.0};  ///< of one repeat, width and height; one number: a square
  int around = 1;                        ///< cylindrical: repeats in a turn; replaces the width
  std::vector<double> box_mm = {1.0, 1.0, 1.0};  ///< box: its sides along u, v, axis; their ratios

  bool is_empty() const { return colour_file.empty() && roughness_file.empty(); }
};

void visit_keys(KeyVisitor& keys, TextureSettings& settings);

/// Projects points of the part to a picture.
class TextureMapping {
 public:
  explicit TextureMapping(const TextureSettings& settings);

  /// In repeats of the picture: (0, 0) is the top left corner of one, (1, 1) the bottom right one.
  Eigen::Vector2d at(const Eigen::Vector3d& point_mm) const;

 private:
  Eigen::Vector2d planar(double right_mm, double up_mm) const;
  Eigen::Vector2d box(const Eigen::Vector3d& offset_mm) const;

  TextureSettings::Mapping mapping_;
  Eigen::Vector3d center_mm_;
  Eigen::Matrix3d frame_;  ///< rows: u, v, axis
  Eigen::Vector2d size_mm_;
  double around_;
  Eigen::Array3d box_mm_;
};

/// Read pictures with their mapping; immutable.
class Texture {
 public:
  /// @param is_grey  the sensor has one wavelength: a colour becomes its mean
  /// @throws IoError, ConfigError: a picture cannot be read or holds no factors
  Texture(const TextureSettings& settings, bool is_grey);

  Texel at(const Eigen::Vector3d& point_mm) const;

  /// Between the least and the greatest of the picture.
  Interval roughness_factors() const;

 private:
  TextureMapping mapping_;
  Interval roughness_factor_;
  TexturePicture colour_;     ///< may be empty
  TexturePicture roughness_;  ///< may be empty
};

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/config/keys.h"
#include "simulator/material/lay.h"
#include "simulator/material/material.h"
#include "simulator/material/pattern.h"
#include "simulator/material/texture.h"

namespace glint {

/// Keys of [material.coat].
struct CoatSettings {
  double index = 1.0;  ///< 1: no coat
  double roughness = 0.0;
  std::vector<double> transmittance = {1.0};  ///< 1 or 3 numbers
};

/// Keys of [material], or of [material.<name>].
struct MaterialSettings {
  enum class Type { kMirror, kConductor, kDiffuse };

  Type type = Type::kMirror;
  std::filesystem::path nk_file;  ///< of mirror and conductor; empty: from the reflectance
  std::vector<double> reflectance = {
      1.0};                         ///< linear, 1 or 3 numbers; at normal incidence for metal
  std::vector<double> colour_srgb;  ///< 0 to 255, 3 numbers; instead of reflectance
  double roughness = 0.25;
  double anisotropy = 0.0;
  std::vector<double>
      alpha;            ///< conductor: widths themselves, 1 or 2 numbers; instead of roughness
  bool schlick = true;  ///< without nk_file: metal reflects more at grazing
  bool multiple_reflections = true;
  CoatSettings coat;
  LaySettings lay;
  PatternSettings pattern;
  TextureSettings texture;
};

void visit_keys(KeyVisitor& keys, CoatSettings& settings);
void visit_keys(KeyVisitor& keys, MaterialSettings& settings);

/// A material ready for rendering, with what it varies by. Move-only and immutable; the plain
/// material points into it.
class SurfaceMaterial {
 public:
  /// @param wavelengths_nm  of the sensor: 1 (grey) or 3 (red, green, blue)
  /// @throws IoError, ConfigError: the table of n and k cannot be read, or lacks a wavelength; a
  ///         texture's picture cannot be read, or holds no factors
  SurfaceMaterial(const MaterialSettings& settings, std::span<const double> wavelengths_nm);

  /// Without its pattern and texture.
  const Material& plain() const { return material_; }

  /// The factors of pattern and texture at a point of the part, multiplied.
  Texel texel_at(const Eigen::Vector3d& point_mm) const;

  /// With these factors.
  Material at(const Eigen::Vector3d& point_mm) const;

  /// The frame of its directions at a point of the part.
  /// @param normal  outward, of length 1
  ShadingFrame frame_at(const Eigen::Vector3d& point_mm, const Eigen::Vector3d& normal) const;

  const LaySettings& lay() const { return lay_; }

  const LayPlane& lay_plane() const { return plane_; }

  /// Whether at() varies: there is a pattern or a texture.
  bool has_pattern() const {
    return pattern_.kind != PatternSettings::Kind::kNone || texture_ != nullptr;
  }

  /// Whether they change the roughness; else only the colour.
  bool varies_roughness() const {
    return roughness_factors_.min != 1.0 || roughness_factors_.max != 1.0;
  }

 private:
  LaySettings lay_;
  LayPlane plane_;
  PatternSettings pattern_;
  std::unique_ptr<const Texture> texture_;
  Interval roughness_factors_;
  std::unique_ptr<const GgxAlbedo> albedo_;
  std::unique_ptr<const CoatTables> coat_tables_;
  Material material_;
};

}  // namespace glint

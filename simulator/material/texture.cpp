// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/material/texture.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/pose.h"

namespace glint {
namespace {

using Eigen::Array3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::array<std::string_view, 3> kMappings = {"planar", "cylindrical", "box"};
constexpr std::array<std::string_view, 3> kEncodings = {"auto", "srgb", "linear"};

/// Rows u, v, axis.
Eigen::Matrix3d frame_of(const TextureSettings& settings) {
  const Vector3d axis = vector_of(settings.axis).normalized();
  constexpr double kAlong = 0.999;
  const Vector3d start = std::abs(axis.x()) > kAlong ? Vector3d::UnitY() : Vector3d::UnitX();
  const ShadingFrame frame = frame_at(axis, start);
  const double c = std::cos(settings.rotation_rad);
  const double s = std::sin(settings.rotation_rad);
  Eigen::Matrix3d rows;
  rows.row(0) = (c * frame.tangent + s * frame.bitangent).transpose();
  rows.row(1) = (c * frame.bitangent - s * frame.tangent).transpose();
  rows.row(2) = axis.transpose();
  return rows;
}

TexturePicture read_if_any(const std::filesystem::path& path, TextureEncoding encoding) {
  return path.empty() ? TexturePicture() : read_texture_picture(path, encoding);
}

void visit_place_keys(KeyVisitor& keys, TextureSettings& s) {
  const Count three = {.min = 3, .max = 3};
  const Range length = Range::between(-1e5, 1e5);
  keys.choice("mapping", s.mapping, kMappings, "how points of the part map to the picture");
  keys.numbers("center_mm", s.center_mm, three, length, "where the picture's middle lies");
  keys.numbers("axis",
               s.axis,
               three,
               length,
               "planar: the direction it is seen from; cylindrical: "
               "of the cylinder; box: of its top");
  keys.require(vector_of(s.axis).norm() > 0.0, "axis", "is zero; must have a length");
  keys.number("rotation_deg", s.rotation_rad, Range::between(-360, 360), "turn about the axis");
  keys.numbers("size_mm",
               s.size_mm,
               {.min = 1, .max = 2},
               {.min = 1e-3, .max = 1e5},
               "width and height of one repeat; one number: both");
  keys.integer("around",
               s.around,
               Range::between(1, 10000),
               "cylindrical: repeats in one turn, instead of the width");
  keys.numbers("box_mm",
               s.box_mm,
               three,
               {.min = 1e-3, .max = 1e5},
               "box: its sides; only their ratios play a role");
}

}  // namespace

void visit_keys(KeyVisitor& keys, TextureSettings& s) {
  keys.file("colour_file", s.colour_file, "picture that multiplies the light reflected");
  keys.file("roughness_file", s.roughness_file, "picture that varies the roughness");
  keys.choice("encoding",
              s.encoding,
              kEncodings,
              "of the colours; auto: 8 bits are sRGB, everything else is linear");
  keys.interval("roughness_factor",
                s.roughness_factor,
                Range::between(0.05, 20),
                "factor of the roughness at black and at white");
  visit_place_keys(keys, s);
}

TextureMapping::TextureMapping(const TextureSettings& settings)
    : mapping_(settings.mapping),
      center_mm_(vector_of(settings.center_mm)),
      frame_(frame_of(settings)),
      size_mm_(settings.size_mm.front(), settings.size_mm.back()),
      around_(settings.around),
      box_mm_(vector_of(settings.box_mm).array()) {}

Vector2d TextureMapping::planar(double right_mm, double up_mm) const {
  return {0.5 + right_mm / size_mm_.x(), 0.5 - up_mm / size_mm_.y()};
}

/// Every face is seen from outside, with the axis up; top and bottom with v up.
Vector2d TextureMapping::box(const Vector3d& offset_mm) const {
  int face = 0;
  (offset_mm.array() / box_mm_).abs().maxCoeff(&face);
  const double side = offset_mm[face] < 0.0 ? -1.0 : 1.0;
  if (face == 0) {
    return planar(side * offset_mm.y(), offset_mm.z());
  }
  if (face == 1) {
    return planar(-side * offset_mm.x(), offset_mm.z());
  }
  return planar(side * offset_mm.x(), offset_mm.y());
}

Vector2d TextureMapping::at(const Vector3d& point_mm) const {
  using Mapping = TextureSettings::Mapping;
  const Vector3d offset_mm = frame_ * (point_mm - center_mm_);
  if (mapping_ == Mapping::kBox) {
    return box(offset_mm);
  }
  if (mapping_ == Mapping::kCylindrical) {
    const double turns = std::atan2(offset_mm.y(), offset_mm.x()) / (2.0 * kPi);
    return {0.5 + around_ * turns, planar(0.0, offset_mm.z()).y()};
  }
  return planar(offset_mm.x(), offset_mm.y());
}

Texture::Texture(const TextureSettings& settings, bool is_grey)
    : mapping_(settings),
      roughness_factor_(settings.roughness_factor),
      colour_(read_if_any(settings.colour_file, settings.encoding)),
      roughness_(read_if_any(settings.roughness_file, TextureEncoding::kLinear)) {
  if (is_grey) {
    for (std::array<float, 3>& pixel : colour_.values()) {
      pixel.fill((pixel[0] + pixel[1] + pixel[2]) / 3.0F);
    }
  }
}

Texel Texture::at(const Vector3d& point_mm) const {
  const Vector2d place = mapping_.at(point_mm);
  Texel texel;
  if (!colour_.empty()) {
    texel.colour = bilinear(colour_, place).min(1.0);
  }
  if (!roughness_.empty()) {
    texel.roughness = roughness_factor_.at(bilinear(roughness_, place)[0]);
  }
  return texel;
}

Interval Texture::roughness_factors() const {
  if (roughness_.empty()) {
    return 1.0;
  }
  const auto [minimum, maximum] = std::ranges::minmax_element(
      roughness_.values(), {}, [](const std::array<float, 3>& pixel) { return pixel[0]; });
  return {roughness_factor_.at(double{(*minimum)[0]}), roughness_factor_.at(double{(*maximum)[0]})};
}

}  // namespace glint

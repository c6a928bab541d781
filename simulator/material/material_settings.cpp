// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/material/material_settings.h"

#include <array>

#include "core/error.h"
#include "simulator/material/nk_table.h"

namespace glint {
namespace {

using Type = MaterialSettings::Type;

constexpr std::array<std::string_view, 3> kTypes = {"mirror", "conductor", "diffuse"};

constexpr Count kOneOrThree = {.min = 1, .max = 3};

bool is_one_or_three(const std::vector<double>& values) {
  return values.size() == 1 || values.size() == 3;
}

Colour colour_of(const std::vector<double>& values) {
  return values.size() == 3 ? Colour(values[0], values[1], values[2]) : Colour::Constant(values[0]);
}

/// A grey camera's one value is the mean of an sRGB colour's three linear ones.
Colour reflectance_of(const MaterialSettings& settings, bool is_grey) {
  Colour colour = colour_of(settings.reflectance);
  if (!settings.colour_srgb.empty()) {
    colour = colour_of(settings.colour_srgb).unaryExpr(&linear_from_srgb);
  }
  return is_grey ? Colour::Constant(colour.mean()) : colour;
}

Fresnel fresnel_from_file(const std::filesystem::path& file,
                          std::span<const double> wavelengths_nm) {
  const NkTable table = read_nk(file);
  Colour n;
  Colour k;
  for (int c = 0; c < 3; ++c) {
    const auto w = wavelengths_nm.size() == 3 ? static_cast<std::size_t>(c) : 0;
    const RefractiveIndex index = table.at(wavelengths_nm[w]);
    n[c] = index.n;
    k[c] = index.k;
  }
  return conductor_fresnel(n, k);
}

Fresnel fresnel_of(const MaterialSettings& settings, std::span<const double> wavelengths_nm) {
  if (!settings.nk_file.empty()) {
    return fresnel_from_file(settings.nk_file, wavelengths_nm);
  }
  const Colour normal = reflectance_of(settings, wavelengths_nm.size() == 1);
  return settings.schlick ? schlick_fresnel(normal) : constant_fresnel(normal);
}

GgxAlpha<double> alpha_of(const MaterialSettings& settings) {
  if (settings.alpha.empty()) {
    return alpha_from_roughness(settings.roughness, settings.anisotropy);
  }
  return {.x = settings.alpha.front(), .y = settings.alpha.back()};
}

bool is_smooth(const MaterialSettings& settings) {
  return settings.type == Type::kMirror ||
         (settings.type == Type::kConductor && settings.alpha.empty() && settings.roughness == 0.0);
}

std::unique_ptr<const Texture> texture_of(const TextureSettings& settings, bool is_grey) {
  return settings.is_empty() ? nullptr : std::make_unique<const Texture>(settings, is_grey);
}

/// All that texels of pattern and texture together can have.
Interval roughness_factors(const MaterialSettings& settings, const Texture* texture) {
  const Interval pattern = roughness_factors(settings.pattern);
  const Interval picture = texture == nullptr ? Interval(1.0) : texture->roughness_factors();
  return {pattern.min * picture.min, pattern.max * picture.max};
}

std::unique_ptr<const GgxAlbedo> albedo_of(const MaterialSettings& settings,
                                           const Interval& factors) {
  if (settings.type != Type::kConductor || is_smooth(settings) || !settings.multiple_reflections) {
    return nullptr;
  }
  const GgxAlpha<double> alpha = alpha_of(settings);
  const double low = factors.min * factors.min;
  return std::make_unique<const GgxAlbedo>(GgxAlpha<double>{alpha.x * low, alpha.y * low},
                                           factors.max * factors.max / low);
}

BaseMaterial base_of(const MaterialSettings& settings,
                     std::span<const double> wavelengths_nm,
                     const GgxAlbedo* albedo) {
  if (settings.type == Type::kDiffuse) {
    return RoughDiffuse{.colour = reflectance_of(settings, wavelengths_nm.size() == 1),
                        .roughness = settings.roughness};
  }
  const Fresnel fresnel = fresnel_of(settings, wavelengths_nm);
  if (is_smooth(settings)) {
    return Mirror{.fresnel = fresnel};
  }
  const GgxAlpha<double> alpha = alpha_of(settings);
  return Conductor{.alpha = alpha,
                   .fresnel = fresnel,
                   .albedo = albedo,
                   .albedo_scale = albedo == nullptr ? 1.0 : alpha.x / albedo->lowest().x};
}

Coat coat_of(const CoatSettings& settings) {
  const double alpha = alpha_from_roughness(settings.roughness, 0.0).x;
  return {.index = settings.index,
          .alpha = settings.roughness == 0.0 ? 0.0 : alpha,
          .transmittance = colour_of(settings.transmittance)};
}

}  // namespace

void visit_keys(KeyVisitor& keys, CoatSettings& s) {
  keys.number(
      "index", s.index, Range::between(1, 4), "refractive index of lacquer or oil; 1: none");
  keys.number("roughness", s.roughness, Range::between(0, 1), "of its upper face; 0: smooth");
  keys.numbers("transmittance",
               s.transmittance,
               kOneOrThree,
               {.min = 1e-3, .max = 1},
               "light left after once down and up along the normal, grey or red, green, blue");
  keys.require(
      is_one_or_three(s.transmittance), "transmittance", "has 2 numbers; must have 1 or 3");
}

void visit_keys(KeyVisitor& keys, MaterialSettings& s) {
  const Range share = Range::between(0, 1);
  keys.choice(
      "type", s.type, kTypes, "mirror: smooth metal; conductor: rough metal; diffuse: matt");
  keys.file("nk_file", s.nk_file, "refractive index of the metal, from refractiveindex.info");
  keys.numbers(
      "reflectance",
      s.reflectance,
      kOneOrThree,
      share,
      "linear share of light reflected, grey or red, green, blue; of metal, straight back");
  keys.require(is_one_or_three(s.reflectance), "reflectance", "has 2 numbers; must have 1 or 3");
  keys.numbers("colour_srgb",
               s.colour_srgb,
               {.min = 0, .max = 3},
               Range::between(0, 255),
               "the reflectance as an 8-bit sRGB colour; empty: reflectance");
  keys.require(s.colour_srgb.empty() || s.colour_srgb.size() == 3,
               "colour_srgb",
               "must have 3 numbers or none");
  const MaterialSettings plain;
  // A resolved configuration writes every key, so only a value other than the default contradicts.
  keys.require(s.colour_srgb.empty() || s.reflectance == plain.reflectance,
               "colour_srgb",
               "excludes reflectance; give one of the two");
  keys.require(s.nk_file.empty() || s.type != MaterialSettings::Type::kDiffuse,
               "nk_file",
               "is for type mirror and conductor");
  keys.number("roughness", s.roughness, share, "0: smooth; the widths are its square");
  keys.number("anisotropy",
              s.anisotropy,
              Range::between(-1, 1),
              "conductor: > 0 rougher along the tangent, < 0 across it, as grooves are");
  keys.numbers("alpha",
               s.alpha,
               {.min = 0, .max = 2},
               {.min = kMinAlpha, .max = 4},
               "conductor: GGX widths along and across the tangent; empty: from the roughness");
  keys.require(
      s.alpha.empty() || (s.roughness == plain.roughness && s.anisotropy == plain.anisotropy),
      "alpha",
      "excludes roughness or anisotropy; give one of the two");
  keys.boolean("schlick", s.schlick, "without nk_file: metal reflects more at grazing");
  keys.boolean("multiple_reflections",
               s.multiple_reflections,
               "conductor: add back the light reflected several times between microfacets");
  keys.table(
      "coat", [&](KeyVisitor& t) { visit_keys(t, s.coat); }, "a clear layer on top");
  keys.table(
      "lay", [&](KeyVisitor& t) { visit_keys(t, s.lay); }, "direction of the grooves");
  keys.table(
      "pattern", [&](KeyVisitor& t) { visit_keys(t, s.pattern); }, "marks on the surface");
  keys.table(
      "texture", [&](KeyVisitor& t) { visit_keys(t, s.texture); }, "pictures on the surface");
}

SurfaceMaterial::SurfaceMaterial(const MaterialSettings& settings,
                                 std::span<const double> wavelengths_nm)
    : lay_(settings.lay),
      plane_(plane_of(settings.lay)),
      pattern_(settings.pattern),
      texture_(texture_of(settings.texture, wavelengths_nm.size() == 1)),
      roughness_factors_(roughness_factors(settings, texture_.get())),
      albedo_(albedo_of(settings, roughness_factors_)) {
  GLINT_CHECK(wavelengths_nm.size() == 1 || wavelengths_nm.size() == 3, "one or three wavelengths");
  const BaseMaterial base = base_of(settings, wavelengths_nm, albedo_.get());
  if (settings.coat.index > 1.0) {
    const Coat coat = coat_of(settings.coat);
    coat_tables_ = std::make_unique<const CoatTables>(coat, base);
    material_ = Coated{.coat = coat, .base = base, .tables = coat_tables_.get()};
  } else {
    std::visit([&](const auto& b) { material_ = b; }, base);
  }
}

Texel SurfaceMaterial::texel_at(const Eigen::Vector3d& point_mm) const {
  Texel texel = glint::texel_at(pattern_, plane_.at(point_mm));
  if (texture_ != nullptr) {
    const Texel picture = texture_->at(point_mm);
    texel.colour *= picture.colour;
    texel.roughness *= picture.roughness;
  }
  return texel;
}

Material SurfaceMaterial::at(const Eigen::Vector3d& point_mm) const {
  return has_pattern() ? textured(material_, texel_at(point_mm)) : material_;
}

ShadingFrame SurfaceMaterial::frame_at(const Eigen::Vector3d& point_mm,
                                       const Eigen::Vector3d& normal) const {
  return glint::frame_at(normal, groove_at(lay_, plane_, point_mm));
}

}  // namespace glint

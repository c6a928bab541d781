// SPDX-License-Identifier: GPL-3.0-or-later
//
// The materials that the conformance suite runs over.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/rng.h"
#include "simulator/material/material.h"

namespace glint::material_cases {

struct Case {
  std::string name;
  Material material;
  double width = 1.0;  ///< of its narrowest lobe that is no mirror, about [rad]
  bool is_isotropic = true;
};

/// Owns the tables that the materials of its cases point into.
class Cases {
 public:
  /// @param is_white  nothing absorbs: every reflectance and transmittance is 1
  explicit Cases(bool is_white) : is_white_(is_white) {
    add_mirrors_and_matt();
    add_conductors();
    add_coated();
  }

  const std::vector<Case>& all() const { return cases_; }

 private:
  Fresnel fresnel(const Fresnel& coloured) const {
    return is_white_ ? constant_fresnel(Colour::Ones()) : coloured;
  }

  Colour colour(double r, double g, double b) const {
    return is_white_ ? Colour(Colour::Ones()) : Colour(r, g, b);
  }

  void add_mirrors_and_matt() {
    cases_.push_back({.name = "mirror",
                      .material = Mirror{.fresnel = fresnel(schlick_fresnel({0.5, 0.6, 0.7}))}});
    for (const double roughness : {0.0, 0.3, 1.0}) {
      cases_.push_back(
          {.name = "diffuse " + std::to_string(roughness),
           .material = RoughDiffuse{.colour = colour(0.8, 0.5, 0.1), .roughness = roughness}});
    }
  }

  Conductor conductor(double x, double y) {
    albedos_.push_back(std::make_unique<const GgxAlbedo>(GgxAlpha<double>{x, y}));
    const Fresnel nickel = conductor_fresnel({1.70, 1.92, 1.99}, {2.94, 3.61, 4.08});
    return {.alpha = {x, y}, .fresnel = fresnel(nickel), .albedo = albedos_.back().get()};
  }

  void add_conductors() {
    const std::vector<std::pair<double, double>> widths = {{0.001, 0.001},
                                                           {0.05, 0.05},
                                                           {0.3, 0.3},
                                                           {1.0, 1.0},
                                                           {0.1028, 0.0380},
                                                           {0.3, 0.1},
                                                           {0.316, 1.0}};
    for (const auto& [x, y] : widths) {
      cases_.push_back({.name = "conductor " + std::to_string(x) + " " + std::to_string(y),
                        .material = conductor(x, y),
                        .width = std::min(x, y),
                        .is_isotropic = x == y});
    }
  }

  void add_coat(const std::string& name, const BaseMaterial& base, double alpha, Case like) {
    const Coat coat = {.index = 1.5, .alpha = alpha, .transmittance = colour(0.9, 0.8, 0.7)};
    tables_.push_back(std::make_unique<const CoatTables>(coat, base));
    like.name = name;
    like.material = Coated{.coat = coat, .base = base, .tables = tables_.back().get()};
    cases_.push_back(like);
  }

  void add_coated() {
    const RoughDiffuse matt = {.colour = colour(0.8, 0.5, 0.1), .roughness = 0.5};
    const Mirror mirror = {.fresnel = fresnel(schlick_fresnel({0.5, 0.6, 0.7}))};
    add_coat("smooth coat on matt", matt, 0.0, {});
    add_coat("rough coat on matt", matt, 0.2, {.width = 0.2});
    add_coat("smooth coat on mirror", mirror, 0.0, {});
    add_coat("rough coat on mirror", mirror, 0.1, {.width = 0.1});
    add_coat("smooth coat on metal", conductor(0.3, 0.3), 0.0, {.width = 0.3});
    add_coat("rough coat on brushed metal",
             conductor(0.1, 0.3),
             0.1,
             {.width = 0.1, .is_isotropic = false});
  }

  bool is_white_;
  std::vector<std::unique_ptr<const GgxAlbedo>> albedos_;
  std::vector<std::unique_ptr<const CoatTables>> tables_;
  std::vector<Case> cases_;
};

inline const std::vector<Case>& white_cases() {
  static const Cases cases(true);
  return cases.all();
}

inline const std::vector<Case>& coloured_cases() {
  static const Cases cases(false);
  return cases.all();
}

inline LocalDirection direction_at(double cosine, double phi_rad) {
  const double radius = std::sqrt((1.0 - cosine) * (1.0 + cosine));
  return {radius * std::cos(phi_rad), radius * std::sin(phi_rad), cosine};
}

/// Uniform over the half sphere above the surface.
inline LocalDirection random_direction(Rng& rng) {
  const double cosine = 1.0 - rng.uniform();
  return direction_at(cosine, rng.uniform(0.0, 2.0 * kPi));
}

/// The digits of a whole number behind the point, in reverse.
inline double radical_inverse(int base, int index) {
  double result = 0.0;
  double digit = 1.0;
  for (int rest = index; rest > 0; rest /= base) {
    digit /= base;
    result += digit * (rest % base);
  }
  return result;
}

/// Point of Halton's sequence: fills the cube evenly.
inline RandomTriple quasi_random(int index) {
  return {radical_inverse(3, index), radical_inverse(5, index), radical_inverse(2, index)};
}

/// Share of light from one direction that the material returns, by its own samples.
inline Colour albedo(const Material& material, const LocalDirection& to_viewer, int samples) {
  Colour sum = Colour::Zero();
  for (int i = 0; i < samples; ++i) {
    if (const auto light = sample(material, to_viewer, quasi_random(i))) {
      sum += light->weight;
    }
  }
  return sum / samples;
}

}  // namespace glint::material_cases

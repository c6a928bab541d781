// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulator/material/local.h"

namespace glint {

/// What a smooth interface between air and metal reflects, per wavelength. Unpolarised light.
struct Fresnel {
  enum class Kind {
    kConstant,  ///< the same at every angle
    kSchlick,   ///< from the reflectance at normal incidence, to 1 at grazing
    kConductor  ///< exact, from the complex refractive index n - i k
  };

  Kind kind = Kind::kConstant;
  Colour normal = Colour::Ones();   ///< reflectance at normal incidence, in [0, 1]
  Colour n = Colour::Ones();        ///< only for kConductor
  Colour k = Colour::Zero();        ///< only for kConductor
  Colour average = Colour::Ones();  ///< over all directions, weighted with the cosine
};

/// @param reflectance  in [0, 1] at every angle
Fresnel constant_fresnel(const Colour& reflectance);

/// R0 + (1 - R0) (1 - cos)^5. Source: C. Schlick, CGF 13(3), 1994.
/// @param normal  reflectance at normal incidence, in [0, 1]
Fresnel schlick_fresnel(const Colour& normal);

/// @param n  > 0  @param k  >= 0
Fresnel conductor_fresnel(const Colour& n, const Colour& k);

/// @param cosine  of the angle between light and normal of the interface, in [0, 1]
Colour reflectance(const Fresnel& fresnel, double cosine);

/// One wavelength of a metal, exact. Source: M. Born, E. Wolf, "Principles of optics", 14.2.
double conductor_reflectance(double n, double k, double cosine);

/// ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2)
double normal_reflectance(double n, double k);

/// From air into glass or lacquer. @param index  refractive index, >= 1
double dielectric_reflectance(double index, double cosine);

/// Cosine of the refracted direction, in a medium of that index, of a ray in air.
double refracted_cosine(double index, double cosine);

/// Linear light of an 8-bit sRGB value (0 to 255, fractions allowed). Source: IEC 61966-2-1.
double linear_from_srgb(double value);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The GGX distribution of microfacets with height-correlated Smith masking, as inline functions on
// plain values: no branches on data, no Eigen, `float` or `double`, so that a kernel can run them
// on packets. `to_viewer` and `to_light` have z > 0.
//
// Masking is written with len(v) = sqrt((alpha_x x)^2 + (alpha_y y)^2 + z^2), for which Smith's
// Lambda is (len / z - 1) / 2: nothing divides by a small cosine.
//
// Sources: E. Heitz, "Understanding the masking-shadowing function", JCGT 3(2), 2014; J. Dupuy and
// A. Benyoub, "Sampling visible GGX normals with spherical caps", CGF 42(8), 2023.
#pragma once

#include <algorithm>
#include <cmath>

#include "simulator/material/local.h"

namespace glint {

/// Width of the distribution of slopes along x and y, each >= kMinAlpha.
template <class Real>
struct GgxAlpha {
  Real x = Real(0.1);
  Real y = Real(0.1);
};

/// Below this a surface is a mirror to any camera (blur of 0.1 mm at a distance of 1 m).
inline constexpr double kMinAlpha = 1e-4;

template <class Real>
Real ggx_length(const GgxAlpha<Real>& alpha, const Local<Real>& v) {
  const Real x = alpha.x * v.x;
  const Real y = alpha.y * v.y;
  return std::sqrt(x * x + y * y + v.z * v.z);
}

/// Density of microfacets with a normal, per steradian and projected area.
template <class Real>
Real ggx_distribution(const GgxAlpha<Real>& alpha, const Local<Real>& normal) {
  const Real x = normal.x / alpha.x;
  const Real y = normal.y / alpha.y;
  const Real e = x * x + y * y + normal.z * normal.z;
  return Real(1) / (Real(kPi) * alpha.x * alpha.y * e * e);
}

/// Height-correlated masking over 4 cos(viewer) cos(light).
template <class Real>
Real ggx_visibility(const GgxAlpha<Real>& alpha,
                    const Local<Real>& to_viewer,
                    const Local<Real>& to_light) {
  return Real(0.5) /
         (to_light.z * ggx_length(alpha, to_viewer) + to_viewer.z * ggx_length(alpha, to_light));
}

/// Density of the direction that a visible normal reflects to, per steradian.
template <class Real>
Real ggx_density(const GgxAlpha<Real>& alpha,
                 const Local<Real>& to_viewer,
                 const Local<Real>& normal) {
  return ggx_distribution(alpha, normal) / (Real(2) * (to_viewer.z + ggx_length(alpha, to_viewer)));
}

/// BRDF without Fresnel, times cosine, over the density: what remains of a sampled path; <= 1.
template <class Real>
Real ggx_weight(const GgxAlpha<Real>& alpha,
                const Local<Real>& to_viewer,
                const Local<Real>& to_light) {
  const Real viewer = ggx_length(alpha, to_viewer);
  const Real light = ggx_length(alpha, to_light);
  return (to_viewer.z + viewer) * to_light.z / (viewer * to_light.z + light * to_viewer.z);
}

/// A microfacet normal as the viewer sees them, from two numbers in [0, 1).
template <class Real>
Local<Real> ggx_sample_normal(const GgxAlpha<Real>& alpha,
                              const Local<Real>& to_viewer,
                              Real u,
                              Real v) {
  const Real length = ggx_length(alpha, to_viewer);
  const Local<Real> stretched = {
      alpha.x * to_viewer.x / length, alpha.y * to_viewer.y / length, to_viewer.z / length};
  // A point of the spherical cap plus the viewer; the z of that sum, taken first, never cancels.
  const Real sum_z = (Real(1) - v) * (Real(1) + stretched.z);
  const Real z = sum_z - stretched.z;
  const Real radius = std::sqrt(std::max(Real(0), (Real(1) - z) * (Real(1) + z)));
  const Real phi_rad = Real(2.0 * kPi) * u;
  const Local<Real> normal = {alpha.x * (radius * std::cos(phi_rad) + stretched.x),
                              alpha.y * (radius * std::sin(phi_rad) + stretched.y),
                              sum_z};
  const Real scale = Real(1) / std::sqrt(dot(normal, normal));
  return {normal.x * scale, normal.y * scale, normal.z * scale};
}

/// Roughness and anisotropy as artists' programs give them to widths: alpha = roughness^2, drawn
/// apart by aspect = sqrt(1 - 0.9 |anisotropy|): alpha_x = alpha / aspect and alpha_y = alpha
/// aspect for anisotropy >= 0, the other way round below; neither under 0.001. This is the rule of
/// Disney's principled material and of appleseed's metal, in which the second seed states its gear.
/// @param roughness  in [0, 1]  @param anisotropy  in [-1, 1]
GgxAlpha<double> alpha_from_roughness(double roughness, double anisotropy);

}  // namespace glint

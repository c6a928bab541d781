// SPDX-License-Identifier: GPL-3.0-or-later
//
// Reflectances of an interface and their means over the half sphere, which the light of several
// reflections needs: 2 int R(mu) mu dmu, in closed form for Schlick's curve, by 48 Gauss-Legendre
// nodes for a metal's exact one, once a material. docs/theory/materials.md
#include "simulator/material/fresnel.h"

#include "simulator/material/quadrature.h"

namespace glint {
namespace {

/// 2 times the integral of R(mu) mu over mu in [0, 1].
Colour cosine_average(const Fresnel& fresnel) {
  const Quadrature rule = gauss_legendre(48);
  Colour sum = Colour::Zero();
  for (std::size_t i = 0; i < rule.nodes.size(); ++i) {
    sum += 2.0 * rule.weights[i] * rule.nodes[i] * reflectance(fresnel, rule.nodes[i]);
  }
  return sum;
}

}  // namespace

Fresnel constant_fresnel(const Colour& reflectance) {
  return {.kind = Fresnel::Kind::kConstant, .normal = reflectance, .average = reflectance};
}

Fresnel schlick_fresnel(const Colour& normal) {
  // 2 int mu (1 - mu)^5 = 2 (1/6 - 1/7) = 1/21.
  return {.kind = Fresnel::Kind::kSchlick,
          .normal = normal,
          .average = normal + (Colour::Ones() - normal) / 21.0};
}

Fresnel conductor_fresnel(const Colour& n, const Colour& k) {
  Fresnel fresnel = {.kind = Fresnel::Kind::kConductor, .n = n, .k = k};
  for (int c = 0; c < 3; ++c) {
    fresnel.normal[c] = normal_reflectance(n[c], k[c]);
  }
  fresnel.average = cosine_average(fresnel);
  return fresnel;
}

Colour reflectance(const Fresnel& fresnel, double cosine) {
  switch (fresnel.kind) {
    case Fresnel::Kind::kConstant:
      return fresnel.normal;
    case Fresnel::Kind::kSchlick: {
      const double rest = 1.0 - std::clamp(cosine, 0.0, 1.0);
      const double square = rest * rest;
      return fresnel.normal + (Colour::Ones() - fresnel.normal) * (square * square * rest);
    }
    case Fresnel::Kind::kConductor:
      break;
  }
  return {conductor_reflectance(fresnel.n[0], fresnel.k[0], cosine),
          conductor_reflectance(fresnel.n[1], fresnel.k[1], cosine),
          conductor_reflectance(fresnel.n[2], fresnel.k[2], cosine)};
}

double conductor_reflectance(double n, double k, double cosine) {
  const double c = std::clamp(cosine, 0.0, 1.0);
  const double c2 = c * c;
  const double s2 = 1.0 - c2;
  const double d = n * n - k * k - s2;
  const double a2_plus_b2 = std::sqrt(d * d + 4.0 * n * n * k * k);
  const double a = std::sqrt(std::max(0.0, 0.5 * (a2_plus_b2 + d)));
  const double across = (a2_plus_b2 + c2 - 2.0 * a * c) / (a2_plus_b2 + c2 + 2.0 * a * c);
  const double t1 = c2 * a2_plus_b2 + s2 * s2;
  const double t2 = 2.0 * a * c * s2;
  const double along = t1 + t2 > 0.0 ? across * (t1 - t2) / (t1 + t2) : across;
  return 0.5 * (across + along);
}

double normal_reflectance(double n, double k) {
  return ((n - 1.0) * (n - 1.0) + k * k) / ((n + 1.0) * (n + 1.0) + k * k);
}

double refracted_cosine(double index, double cosine) {
  const double c = std::clamp(cosine, 0.0, 1.0);
  return std::sqrt(std::max(0.0, 1.0 - (1.0 - c * c) / (index * index)));
}

double dielectric_reflectance(double index, double cosine) {
  const double c = std::clamp(cosine, 0.0, 1.0);
  const double t = refracted_cosine(index, c);
  if (t + c <= 0.0) {
    return 1.0;  // grazing on no interface at all
  }
  const double across = (c - index * t) / (c + index * t);
  const double along = (index * c - t) / (index * c + t);
  return 0.5 * (across * across + along * along);
}

double linear_from_srgb(double value) {
  const double v = value / 255.0;
  return v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4);
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/material/pattern.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace glint {
namespace {

constexpr std::array<std::string_view, 2> kPatternKinds = {"none", "concentric"};

double smoothstep(double t) {
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

void visit_keys(KeyVisitor& keys, PatternSettings& s) {
  keys.choice("kind", s.kind, kPatternKinds, "marks on the surface");
  keys.number("density", s.density, {.min = 1e-3, .max = 1e3}, "concentric: width of a ring, d");
  keys.number("unit_mm", s.unit_mm, {.min = 1e-3, .max = 1e3}, "length of 1 in the equation");
  keys.number("colour", s.colour, Range::between(0, 1), "how much the marks darken");
  keys.number("roughness",
              s.roughness,
              Range::between(0, 0.9),
              "the roughness varies by plus and minus this share of itself");
  keys.boolean("scaled", s.scaled, "divide the value by the density, so that it ends at 1");
  keys.require(
      s.scaled || s.density <= 1.0 || s.kind == PatternSettings::Kind::kNone,
      "density",
      "is above 1, so that marks would return more light than they receive; must be at most "
      "1, or scaled = true");
}

double concentric_value(double x, double y, double density) {
  const double r = std::sqrt(x * x + y * y);
  const double c = smoothstep(r - std::floor(r));
  const double distance = std::sqrt((x + c) * (x + c) + (y + c) * (y + c));
  return std::max(0.0, distance - density * std::floor(distance / density));
}

Texel texel_at(const PatternSettings& settings, const Eigen::Vector2d& at_mm) {
  if (settings.kind == PatternSettings::Kind::kNone) {
    return {};
  }
  const double v = concentric_value(
      at_mm.x() / settings.unit_mm, at_mm.y() / settings.unit_mm, settings.density);
  const double share = std::min(1.0, v / settings.density);
  const double factor = settings.scaled ? share : std::min(1.0, v);
  return {.colour = Colour::Constant(1.0 - settings.colour * (1.0 - factor)),
          .roughness = 1.0 + settings.roughness * (2.0 * share - 1.0)};
}

Interval roughness_factors(const PatternSettings& settings) {
  return settings.kind == PatternSettings::Kind::kNone
             ? Interval(1.0)
             : Interval(1.0 - settings.roughness, 1.0 + settings.roughness);
}

}  // namespace glint

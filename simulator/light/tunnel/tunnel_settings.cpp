// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/tunnel/tunnel_settings.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace glint {
namespace {

using Shape = TunnelSettings::Shape;

constexpr std::array<std::string_view, 5> kShapeNames = {
    "flat", "semicylinder", "ellipse", "superellipse", "free"};

}  // namespace

std::string_view shape_name(Shape shape) {
  return kShapeNames[static_cast<std::size_t>(shape)];
}

void visit_keys(KeyVisitor& keys, TunnelSettings& s) {
  const Range size = {.min = 1, .max = 1e5};
  keys.choice("shape", s.shape, kShapeNames, "cross-section of the luminous wall");
  keys.number("base_mm",
              s.base_mm,
              Range::between(-1e4, 1e4),
              "height of the cross-section's lower line above the scene's origin");
  keys.number("radius_mm", s.radius_mm, size, "semicylinder: radius");
  keys.number("half_width_mm", s.half_width_mm, size, "ellipse, superellipse: half axis along y");
  keys.number("height_mm", s.height_mm, size, "ellipse, superellipse: half axis along z");
  keys.number("exponent",
              s.exponent,
              Range::between(1, 20),
              "superellipse: 2 = ellipse, larger = closer to a rectangle");
  keys.number(
      "distance_mm", s.distance_mm, size, "flat: from the middle plane to the foot of each panel");
  keys.number("opening_deg",
              s.opening_rad,
              Range::between(0, 180),
              "flat: full angle between the panels, 0 = parallel upright, 180 = a ceiling");
  keys.number("panel_height_mm", s.panel_height_mm, size, "flat: size of a panel across x");
  keys.numbers("control_mm",
               s.control_mm,
               {.min = 3, .max = 16},
               size,
               "free: distances of the B-spline's control points from the base line, at equal "
               "angles from the rim to the top");
  keys.number("length_mm", s.length_mm, size, "size along the tunnel axis");
  keys.number("slot_mm",
              s.slot_mm,
              Range::between(0, 1e5),
              "width of the camera slot along the top, 0 = none");
  keys.number("period_mm", s.period_mm, Range{.min = 1e-3, .max = 1e5}, "of the stripes");
  keys.number("duty", s.duty, Range::between(0, 1), "bright share of a period");
  keys.number("orientation_deg",
              s.orientation_rad,
              Range::between(-90, 90),
              "of the stripes on the unrolled wall, 0 = across the tunnel axis");
  keys.number("offset_mm", s.offset_mm, Range{}, "shift of the stripes along their normal");
  keys.number("dark_reflectance",
              s.dark_reflectance,
              Range::between(0, 0.99),
              "diffuse reflectance of dark stripes, lit by the bright ones");
  keys.number("led_ripple",
              s.led_ripple,
              Range::between(0, 1),
              "relative ripple of the radiance along x from the spacing of LEDs or tubes");
  keys.number("led_pitch_mm", s.led_pitch_mm, size, "spacing of LEDs or tubes along x");
  keys.number("end_falloff",
              s.end_falloff,
              Range::between(0, 1),
              "relative loss of radiance at the tunnel's ends, quadratic along x");
  keys.boolean("blocks_view",
               s.blocks_view,
               "whether the wall occludes the part from the camera except through the slot");
  keys.boolean("cosine_law",
               s.cosine_law,
               "compatibility: multiplies the radiance by the cosine at the wall, which counts it "
               "twice for a Lambertian wall");
  const double half_width = s.shape == Shape::kFlat ? s.distance_mm
                            : s.shape == Shape::kFree
                                ? *std::max_element(s.control_mm.begin(), s.control_mm.end())
                            : s.shape == Shape::kSemicylinder ? s.radius_mm
                                                              : s.half_width_mm;
  keys.require(s.slot_mm < 2.0 * half_width,
               "slot_mm",
               fmt::format("is {:g}, must be smaller than the tunnel, which is {:g} mm wide",
                           s.slot_mm,
                           2.0 * half_width));
}

}  // namespace glint

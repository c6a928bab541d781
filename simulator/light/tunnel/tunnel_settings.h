// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

#include "core/config/keys.h"

namespace glint {

/// Keys of [lighting.tunnel].
struct TunnelSettings {
  enum class Shape { kFlat, kSemicylinder, kEllipse, kSuperellipse, kFree };

  Shape shape = Shape::kSemicylinder;
  double base_mm = 0.0;
  double radius_mm = 100.0;
  double half_width_mm = 100.0;
  double height_mm = 100.0;
  double exponent = 3.0;
  double distance_mm = 60.0;
  double opening_rad = 0.0;
  double panel_height_mm = 200.0;
  std::vector<double> control_mm = {100.0, 100.0, 100.0, 100.0, 100.0};
  double length_mm = 600.0;
  double slot_mm = 20.0;
  double period_mm = 16.0;
  double duty = 0.5;
  double orientation_rad = 0.0;
  double offset_mm = 0.0;
  double dark_reflectance = 0.0;
  double led_ripple = 0.0;
  double led_pitch_mm = 25.0;
  double end_falloff = 0.0;
  bool blocks_view = true;
  bool cosine_law = false;

  /// A place of the wall lies in the slot where |y| is less; without a slot none does.
  double half_slot_mm() const { return slot_mm > 0.0 ? 0.5 * slot_mm : -1e30; }
};

void visit_keys(KeyVisitor& keys, TunnelSettings& settings);

/// Names of TunnelSettings::Shape in order.
std::string_view shape_name(TunnelSettings::Shape shape);

}  // namespace glint

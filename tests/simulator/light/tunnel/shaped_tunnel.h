// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulator/light/tunnel/tunnel.h"

namespace glint::test {

/// A tunnel of any shape: what each shape is described by differs from its default.
inline TunnelSettings shaped_tunnel(TunnelSettings::Shape shape, double slot_mm) {
  return {.shape = shape,
          .half_width_mm = 90.0,
          .height_mm = 120.0,
          .exponent = 3.5,
          .opening_rad = 0.7,
          .control_mm = {80.0, 95.0, 130.0, 110.0, 100.0},
          .slot_mm = slot_mm};
}

/// Another one, raised and long.
inline TunnelSettings raised_tunnel(TunnelSettings::Shape shape, double slot_mm) {
  TunnelSettings settings = shaped_tunnel(shape, slot_mm);
  settings.base_mm = 3.0;
  settings.radius_mm = 110.0;
  settings.panel_height_mm = 120.0;
  settings.length_mm = 1000.0;
  return settings;
}

}  // namespace glint::test

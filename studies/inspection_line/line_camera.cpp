// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/inspection_line/line_camera.h"

namespace glint {

SensorSettings without_noise(SensorSettings settings) {
  settings.full_well_e = settings.read_noise_e = settings.dark_e = 0.0;
  return settings;
}

}  // namespace glint

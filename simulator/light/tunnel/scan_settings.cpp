// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/light/tunnel/scan_settings.h"

#include <cmath>

namespace glint {

void visit_keys(KeyVisitor& keys, ScanSettings& s) {
  keys.integer("positions", s.positions, Range::between(1, 4096), "pictures in a scan");
  keys.number("step_mm",
              s.step_mm,
              Range::at_least(0),
              "between two positions; 0 = one period over all positions");
}

double scan_step_mm(const ScanSettings& scan, const TunnelSettings& tunnel) {
  if (scan.step_mm > 0.0) {
    return scan.step_mm;
  }
  // Oblique stripes move along their normal by the cosine only.
  const double cosine = std::cos(tunnel.orientation_rad);
  constexpr double kSmallestCosine = 0.01;
  if (cosine < kSmallestCosine) {
    throw ConfigError("scan.step_mm",
                      "must be given: stripes that run along the tunnel do not move with it, so a "
                      "period takes no number of steps");
  }
  return tunnel.period_mm / (scan.positions * cosine);
}

}  // namespace glint

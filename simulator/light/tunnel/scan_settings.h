// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "core/config/keys.h"
#include "simulator/light/tunnel/tunnel.h"

namespace glint {

/// Keys of [scan].
struct ScanSettings {
  int positions = 24;
  double step_mm = 0.0;  ///< 0: one period over all positions
};

void visit_keys(KeyVisitor& keys, ScanSettings& settings);

/// The step between two positions along x [mm]: as given, or such that all positions together take
/// the stripes through one period along their normal.
/// @throws ConfigError when the stripes run along the tunnel and no step is given
double scan_step_mm(const ScanSettings& scan, const TunnelSettings& tunnel);

}  // namespace glint

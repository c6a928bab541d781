// SPDX-License-Identifier: GPL-3.0-or-later
//
// Tables of scans that depend on the sensor and the stripes alone. Candidates of a search mostly
// differ in other things: the last few tables are kept until the program ends.
#pragma once

#include <memory>
#include <vector>

#include "core/cache.h"
#include "simulator/render/scan/clipped_mean.h"

namespace glint {

/// ClippedMean(sensor, stripes). Safe to call from several threads.
std::shared_ptr<const ClippedMean> kept_mean_table(const SensorSettings& sensor,
                                                   const StripeSettings& stripes);

/// What tables are made from, number by number.
using TableKey = std::vector<double>;

/// Under dark stripes that shine a scan needs one for each level of their radiance.
inline constexpr std::size_t kKeptTables = 64;

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/scan/kept_tables.h"

namespace glint {

std::shared_ptr<const ClippedMean> kept_mean_table(const SensorSettings& sensor,
                                                   const StripeSettings& stripes) {
  static Cache<TableKey, ClippedMean> tables({.max_values = kKeptTables});
  const TableKey key = {sensor.exposure,
                        sensor.gain,
                        sensor.blur_px,
                        static_cast<double>(sensor.bits),
                        sensor.full_well_e,
                        sensor.read_noise_e,
                        sensor.dark_e,
                        stripes.duty,
                        stripes.dark,
                        stripes.gain,
                        static_cast<double>(stripes.frames),
                        static_cast<double>(stripes.phases)};
  return tables.get(key, [&] { return ClippedMean(sensor, stripes); });
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "simulator/render/blurred/blurred_pixels.h"
#include "simulator/render/scan/scan.h"

namespace glint {

/// take_scan() of rough metal. @throws ConfigError as blurred_pixels()
ScanResult take_blurred_scan(const RayCache& cache,
                             const Tunnel& tunnel,
                             const ConductorNumbers& metal,
                             const Sensor& sensor,
                             const ScanSettings& scan,
                             const Eigen::Vector3d& camera_in_world_mm,
                             const FrameConsumer& consume = {},
                             ThreadPool* pool = nullptr);

}  // namespace glint

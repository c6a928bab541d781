// SPDX-License-Identifier: GPL-3.0-or-later
//
// Materials, lights and cameras as the plain numbers of the packet kernels, where those know them.
#pragma once

#include <optional>

#include "simulator/light/area/lights.h"
#include "simulator/material/material_settings.h"
#include "simulator/render/path_tracing/conductor_kernels.h"
#include "simulator/render/path_tracing/path_kernels.h"
#include "simulator/render/path_tracing/physical_scene.h"
#include "simulator/render/path_tracing/ring_kernels.h"

namespace glint {

/// Metal that is the same everywhere and not too smooth for float; else empty.
std::optional<ConductorNumbers> conductor_numbers(const Material& material);

/// Up to eight rings of constant groups, flat or tilted by 1e-3 rad and more, and nothing else;
/// else empty.
std::optional<RingLights> ring_numbers(const Lights& lights);

/// In the scene frame.
LayNumbers lay_numbers(const SurfaceMaterial& material, const RigidTransform& scene_from_part);

/// Without distortion; else empty.
std::optional<CameraNumbers> camera_numbers(const PhysicalScene& scene);

}  // namespace glint

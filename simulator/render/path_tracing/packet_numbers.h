// SPDX-License-Identifier: GPL-3.0-or-later
//
// Materials and cameras as the plain numbers of the packet kernels, where those know them.
#pragma once

#include <optional>

#include "simulator/material/material_settings.h"
#include "simulator/render/path_tracing/conductor_kernels.h"
#include "simulator/render/path_tracing/path_kernels.h"
#include "simulator/render/path_tracing/physical_scene.h"

namespace glint {

/// Metal that is the same everywhere and not too smooth for float; else empty.
std::optional<ConductorNumbers> conductor_numbers(const Material& material);

/// In the scene frame.
LayNumbers lay_numbers(const SurfaceMaterial& material, const RigidTransform& scene_from_part);

/// Without distortion; else empty.
std::optional<CameraNumbers> camera_numbers(const PhysicalScene& scene);

}  // namespace glint

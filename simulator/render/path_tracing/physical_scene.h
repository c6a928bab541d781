// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "core/pose.h"
#include "simulator/camera/thin_lens_camera.h"
#include "simulator/geometry/bvh/bvh.h"
#include "simulator/geometry/part/part.h"
#include "simulator/geometry/surface/surface_detail.h"
#include "simulator/light/area/lights.h"
#include "simulator/material/material_settings.h"

namespace glint {

/// Everything a path tracer looks at, in the scene frame; it must outlive the call. Numbers from
/// the user are checked where they are read.
struct PhysicalScene {
  const Part& part;
  const Bvh& bvh;               ///< of part.mesh
  const SurfaceDetail& detail;  ///< heights and stains on it
  const SurfaceMaterial& material;
  const Lights& lights;
  const PinholeCamera& camera;
  RigidTransform camera_from_world;
  ThinLens lens = {};
  /// Per triangle the id of the defect it belongs to, 0: none; empty: no triangle belongs to one.
  std::span<const std::int32_t> face_labels = {};
};

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The gear under a ring light that the path tracer is measured on: 168,960 flat triangles, brushed
// metal, a ring around the camera (docs/benchmarks.md).
#pragma once

#include "core/units.h"
#include "simulator/light/area/lights.h"
#include "simulator/render/path_tracing/path_settings.h"
#include "simulator/render/path_tracing/render_paths.h"

namespace glint::bench {

/// What every renderer is told about the scene, besides the mesh.
struct GearSetup {
  int width_px = 612;
  int height_px = 512;
  double pixel_mm = 4.0 * 3.45e-3;  ///< four of a 5 megapixel sensor along each side
  double lens_mm = 12.0;            ///< focal length, focused at the distance below
  double distance_mm = 146.0;       ///< from the pinhole to the middle of the gear
  double ring_inner_mm = 25.0;      ///< radii of the luminous ring
  double ring_outer_mm = 40.0;
  double ring_ahead_mm = 16.0;  ///< of the pinhole
  double radiance = 10.0;
  double tilt_rad = 10.0 * kRadPerDeg;  ///< of the gear's axis, about x
  double roughness = 0.25;
  double anisotropy = 0.7;
  double colour_srgb[3] = {196.0, 199.0, 199.0};
  /// Light that goes on between microfacets. Off, as the rendering study and Cycles' GGX have none.
  bool has_compensation = false;
  int bounces = 3;  ///< after the first reflection, with light of its own at each

  double focal_px() const;
};

/// A spur gear around z: 24 smoothed teeth of tip radius 36 mm, 12 mm thick, with a bore of 20 mm.
/// Coordinates are floats, so that every renderer has the same ones.
TriangleMesh make_gear_mesh();

/// Everything a picture needs, owned.
struct GearScene {
  explicit GearScene(const GearSetup& of_setup = {});

  /// Refers to this object.
  PhysicalScene scene() const;

  /// 3 channels, the scene's bounces.
  PathSettings paths(int samples, int seed = 1) const;

  GearSetup setup;
  Part part;
  Bvh bvh;
  SurfaceDetail detail;
  SurfaceMaterial material;
  PinholeCamera camera;
  RigidTransform camera_from_world;
  Lights lights;
};

}  // namespace glint::bench

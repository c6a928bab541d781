// SPDX-License-Identifier: GPL-3.0-or-later
//
// One dent, realised by its normals and as a displaced mesh, through the whole simulator.
#pragma once

#include <algorithm>
#include <cmath>

#include "core/units.h"
#include "defects/part/height_defects.h"
#include "studies/evaluation/evaluation.h"

namespace glint::realisation {

struct Dent {
  double depth_um = 4.0;
  double diameter_mm = 0.8;
  double view_rad = 0.0;  ///< of the camera, from the plate's normal
};

constexpr double kDistance_mm = 400.0;

/// A flat mirror under a semicylinder, seen by a clipping sensor without noise.
inline SceneSettings dent_scene(const Dent& dent, Realisation realisation) {
  SceneSettings scene;
  scene.part.shape = PartSettings::Shape::kPlate;
  scene.part.length_mm = 40.0;
  scene.part.width_mm = 30.0;
  scene.camera.width_px = 120;
  scene.camera.height_px = 100;
  scene.camera.object_pixel_mm = 0.1;
  scene.camera.working_distance_mm = kDistance_mm;
  const double s = std::sin(dent.view_rad);
  const double c = std::cos(dent.view_rad);
  scene.viewpoint().position_mm = {-kDistance_mm * s, 0.0, kDistance_mm * c};
  scene.viewpoint().direction = {s, 0.0, -c};
  scene.scan.positions = 384;  // of fewer the flawless aspect has a ripple as large as weak dents
  scene.sensor.gain = 1.5;
  scene.sensor.blur_px = 1.0;
  scene.sensor.bits = 16;
  scene.tunnel.radius_mm = 150.0;
  scene.tunnel.length_mm = 2000.0;
  scene.tunnel.period_mm = 16.0;
  scene.tunnel.slot_mm = 0.0;
  scene.tunnel.blocks_view = false;
  DefectGroup group;
  group.realisation = realisation;
  group.height_mm = dent.depth_um * 1e-3;
  group.diameter_mm = dent.diameter_mm;
  scene.defects = {{"dent", group}};
  return scene;
}

/// What a realisation by normals gets wrong against the displaced mesh.
struct Difference {
  double contrast = 0.0;   ///< largest |aspect - flawless aspect|, displaced
  double rms_share = 0.0;  ///< rms difference over the rms signature
  double max_share = 0.0;  ///< largest difference / contrast
};

inline Difference difference(SceneStore& store, const Dent& dent) {
  const auto aspect = [&](Realisation realisation) {
    return evaluate(store,
                    dent_scene(dent, realisation),
                    [](int, const ImageF&) {},
                    {.fringes = false, .slot = false})
        .aspect;
  };
  SceneSettings flawless = dent_scene(dent, Realisation::kNormal);
  flawless.defects.clear();
  const ImageF clean = evaluate(store, flawless, [](int, const ImageF&) {}).aspect;
  const ImageF by_normals = aspect(Realisation::kNormal);
  const ImageF displaced = aspect(Realisation::kDisplaced);
  Difference result;
  double squares = 0.0;
  double signature = 0.0;
  double largest = 0.0;
  for (int y = 15; y + 15 < clean.height(); ++y) {
    for (int x = 15; x + 15 < clean.width(); ++x) {
      const double shown = static_cast<double>(displaced(x, y)) - static_cast<double>(clean(x, y));
      const double wrong =
          static_cast<double>(by_normals(x, y)) - static_cast<double>(displaced(x, y));
      result.contrast = std::max(result.contrast, std::abs(shown));
      largest = std::max(largest, std::abs(wrong));
      squares += wrong * wrong;
      signature += shown * shown;
    }
  }
  result.max_share = largest / result.contrast;
  result.rms_share = std::sqrt(squares / signature);
  return result;
}

}  // namespace glint::realisation

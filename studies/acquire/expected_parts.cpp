// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/expected_parts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simulator/camera/lens_settings.h"
#include "simulator/camera/pinhole_camera.h"
#include "simulator/camera/thin_lens_camera.h"
#include "studies/imaging/built_part.h"
#include "studies/reach/scene_cell.h"

namespace glint::acquire_detail {
namespace {

constexpr int kWidthPx = 160;
constexpr double kUnknownMm = 2.0;  ///< per axis, where no sigma is told
constexpr double kUnknownRad = 0.0175;

double sigma_or(const std::vector<double>& sigma, double unknown) {
  const double norm = std::hypot(sigma[0], sigma[1], sigma[2]);
  return norm > 0.0 ? norm : unknown * std::sqrt(3.0);
}

RigidTransform rigid(const Eigen::Isometry3d& pose) {
  return {.rotation = pose.linear(), .translation_mm = pose.translation()};
}

/// True where the ray through a block's middle meets the part.
Mask mask_of(const PinholeCamera& camera,
             int factor,
             const BuiltPart& part,
             const RigidTransform& part_from_camera) {
  const PinholeIntrinsics& in = camera.intrinsics();
  Mask mask(in.width_px / factor, in.height_px / factor);
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      const auto ray = camera.ray_through({(x + 0.5) * factor, (y + 0.5) * factor});
      mask(x, y) = ray && part.bvh->occluded(part_from_camera.translation_mm,
                                             part_from_camera.rotation * ray->normalized(),
                                             0.0,
                                             std::numeric_limits<double>::infinity())
                       ? 1
                       : 0;
    }
  }
  return mask;
}

/// The sensor's blur, and that of a disc for the part's point which is farthest out of focus.
double blur_of(const SceneSettings& scene,
               const BuiltPart& part,
               const RigidTransform& scene_from_camera) {
  constexpr double kSigmaOfDisc = 0.25;  ///< of its diameter, along one axis
  const LensGeometry lens = lens_geometry(scene.camera, scene.lens);
  const RigidTransform camera_from_scene = inverse(scene_from_camera);
  double circle_mm = 0.0;
  for (const Eigen::Vector3d& point_mm : part.part.mesh.vertices_mm) {
    const double depth_mm = (camera_from_scene * point_mm).z();
    if (lens.aperture_mm > 0.0 && depth_mm > 0.0) {
      circle_mm = std::max(circle_mm,
                           circle_of_confusion_mm(
                               lens.aperture_mm, lens.focus_mm, lens.image_distance_mm, depth_mm));
    }
  }
  return std::hypot(scene.sensor.blur_px, kSigmaOfDisc * circle_mm / scene.camera.pixel_mm);
}

}  // namespace

ExpectedParts expected_parts(const SceneSettings& scene,
                             const Cell& cell,
                             std::span<const PlannedView> views) {
  ExpectedParts expected;
  if (!has_cell_chain(scene, cell)) {
    return expected;
  }
  const CellChain chain = cell_chain(scene, cell);
  const BuiltPart part = build_part_with_bvh(scene.part);
  const PinholeIntrinsics intrinsics = intrinsics_of(scene);
  const PinholeCamera camera(intrinsics);
  const int factor = std::max(1, (intrinsics.width_px + kWidthPx - 1) / kWidthPx);
  for (const PlannedView& view : views) {
    const RigidTransform scene_from_camera = chain.scene_from_camera(rigid(view.base_from_flange));
    expected.masks.push_back(view.outcome == ViewOutcome::kPlanned
                                 ? mask_of(camera, factor, part, scene_from_camera)
                                 : Mask());
    expected.blur_px.push_back(blur_of(scene, part, scene_from_camera));
  }
  const double distance_mm = scene.camera.working_distance_mm;
  const double sigma_mm = std::hypot(sigma_or(chain.camera.sigma_mm, kUnknownMm),
                                     distance_mm * sigma_or(chain.camera.sigma_rad, kUnknownRad),
                                     sigma_or(chain.part.sigma_mm, kUnknownMm));
  expected.tolerance_px = 3.0 * sigma_mm * intrinsics.focal_px.x() / distance_mm;
  return expected;
}

}  // namespace glint::acquire_detail

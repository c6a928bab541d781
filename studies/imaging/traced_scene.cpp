// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/traced_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include <fmt/format.h>

#include "simulator/geometry/mesh/winding_number.h"
#include "studies/definition/render_methods.h"
#include "studies/imaging/blurred/kept_rays.h"
#include "studies/imaging/blurred/returning_light.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Distance of a surface point from a feature, in feature radii (2 sigma of its cross-section).
double distance_in_radii(const HeightFeature& feature, const Vector3d& point_mm) {
  const Vector3d offset = point_mm - feature.centre_mm;
  const double along = std::abs(offset.dot(feature.u_axis)) - feature.half_line_mm();
  const double across = offset.dot(feature.v_axis);
  return std::hypot(std::max(0.0, along), across) / (2.0 * feature.cross_sigma_mm());
}

/// Pixels per square millimetre of the surface around a point, as the camera sees it.
double pixels_per_mm2(const HeightFeature& feature,
                      const PinholeCamera& camera,
                      const RigidTransform& camera_from_world) {
  constexpr double kStep_mm = 1e-3;
  const auto at = [&](const Vector3d& point_mm) {
    return camera.project(camera_from_world * point_mm).value_or(Vector2d::Zero());
  };
  const Vector2d centre = at(feature.centre_mm);
  const Vector2d du = (at(feature.centre_mm + kStep_mm * feature.u_axis) - centre) / kStep_mm;
  const Vector2d dv = (at(feature.centre_mm + kStep_mm * feature.v_axis) - centre) / kStep_mm;
  return std::abs(du.x() * dv.y() - du.y() * dv.x());
}

/// A disc, or a line with round ends.
double feature_area_mm2(const HeightFeature& feature) {
  const double radius = 2.0 * feature.cross_sigma_mm();
  return kPi * radius * radius + 4.0 * radius * feature.half_line_mm();
}

DefectView view_defect(const HeightFeature& feature,
                       const VisibilityBuffer& rays,
                       const PinholeCamera& camera,
                       const RigidTransform& camera_from_world,
                       double window_radii) {
  const double density = pixels_per_mm2(feature, camera, camera_from_world);
  const auto centre = camera.project(camera_from_world * feature.centre_mm);
  if (!centre) {
    throw unseen_defect(feature.label, "is behind the camera");
  }
  const double reach_mm = 2.0 * feature.cross_sigma_mm() * window_radii + feature.half_line_mm();
  const double reach_px = 2.0 * std::sqrt(density) * reach_mm + 3.0;
  const auto clamp_to = [](double value, int size) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size)));
  };
  const int left = clamp_to(centre->x() - reach_px, rays.width_px);
  const int right = clamp_to(centre->x() + reach_px + 1.0, rays.width_px);
  const int top = clamp_to(centre->y() - reach_px, rays.height_px);
  const int bottom = clamp_to(centre->y() + reach_px + 1.0, rays.height_px);
  if (left >= right || top >= bottom) {
    throw unseen_defect(feature.label, "is outside the image");
  }
  DefectView view;
  view.label = feature.label;
  view.left_px = left;
  view.top_px = top;
  view.area_px = density * feature_area_mm2(feature);
  view.distance = ImageF(right - left, bottom - top, DefectView::kFar);
  for (int y = top; y < bottom; ++y) {
    for (int x = left; x < right; ++x) {
      if (rays.coverage(x, y) > 0.999F) {
        view.distance(x - left, y - top) = static_cast<float>(distance_in_radii(
            feature, vector_of(rays.seen_x(x, y), rays.seen_y(x, y), rays.seen_z(x, y))));
      }
    }
  }
  return view;
}

/// The camera that sees one window of the picture, pixel by pixel the same.
PinholeIntrinsics window_of(PinholeIntrinsics intrinsics, const DefectView& view) {
  intrinsics.width_px = view.distance.width();
  intrinsics.height_px = view.distance.height();
  intrinsics.center_px -= Vector2d(view.left_px, view.top_px);
  return intrinsics;
}

/// @param defect_free  the camera's rays without defects; nullptr: not known
void trace_camera(const SceneSettings& scene,
                  const PinholeCamera& camera,
                  const CornerRays* defect_free,
                  ThreadPool& pool,
                  TracedScene& traced) {
  const BuiltPart& built = traced.built();
  if (needs_paths(scene)) {
    static_cast<VisibilityBuffer&>(traced.corners) =
        look_at(built.part, *built.bvh, traced.detail(), camera, traced.camera_from_world, pool);
  } else if (keeps_rays(scene)) {
    traced.rays = trace_kept_rays(
        scene, built.part, *built.bvh, traced.detail(), camera, traced.camera_from_world, pool);
  } else if (defect_free != nullptr) {
    traced.corners = retrace_detail(*defect_free,
                                    built.part,
                                    *built.bvh,
                                    traced.detail(),
                                    {camera, traced.camera_from_world},
                                    scene.render,
                                    pool)
                         .rays;
  } else {
    traced.corners = trace_corner_rays(built.part,
                                       *built.bvh,
                                       traced.detail(),
                                       camera,
                                       traced.camera_from_world,
                                       scene.render,
                                       pool);
  }
}

void trace_flawless_windows(const SceneSettings& scene,
                            const PinholeCamera& camera,
                            ThreadPool& pool,
                            TracedScene& traced) {
  const BuiltPart& built = *traced.part->clean;
  for (const DefectView& view : traced.views) {
    const PinholeCamera window(window_of(camera.intrinsics(), view));
    const SurfaceDetail none;
    if (traced.is_sampled()) {
      traced.flawless.push_back(trace_kept_rays(
          scene, built.part, *built.bvh, none, window, traced.camera_from_world, pool));
    } else {
      traced.flawless_corners.push_back(trace_corner_rays(
          built.part, *built.bvh, none, window, traced.camera_from_world, scene.render, pool));
    }
  }
}

/// @throws ConfigError where blurred reflections do not hold
void check_no_light_returns(const TracedScene& traced) {
  std::vector<std::size_t> inside;
  for (const DefectPixels& defect : traced.defects) {
    inside.insert(inside.end(), defect.inside.begin(), defect.inside.end());
  }
  check_no_light_returns(traced.rays, inside, *traced.built().bvh, traced.camera_in_world_mm);
}

/// The outlines of the defects that can be scored, one after the other with those before it; the
/// labels of all others go to traced.unseen.
std::vector<HeightFeature> seen_outlines(const SceneSettings& scene,
                                         const PinholeCamera& camera,
                                         TracedScene& traced) {
  std::vector<HeightFeature> outlines;
  for (const HeightFeature& outline : traced.part->made.outlines) {
    outlines.push_back(outline);
    try {
      const auto views = view_defects(outlines,
                                      traced.seen(),
                                      camera,
                                      traced.camera_from_world,
                                      scene.metrics.ring_outer_radii);
      defect_pixels(views, traced.part_mask, scene.metrics);
    } catch (const ConfigError&) {
      outlines.pop_back();
      traced.unseen.push_back(outline.label);
    }
  }
  return outlines;
}

/// The pixels that are scored; none where there are too few and nobody scores them.
Mask region_of(const SceneSettings& scene, const TracedScene& traced, MayBeUnseen may_be_unseen) {
  try {
    return region_of_interest(traced.seen().coverage, traced.views, scene.metrics);
  } catch (const ConfigError&) {
    if (may_be_unseen != MayBeUnseen::kPart) {
      throw;
    }
    return {traced.part_mask.width(), traced.part_mask.height()};
  }
}

}  // namespace

TracedScene trace_scene(const SceneSettings& scene,
                        std::shared_ptr<const BuiltDefects> part,
                        const CornerRays* defect_free,
                        ThreadPool& pool,
                        MayBeUnseen may_be_unseen) {
  TracedScene traced;
  traced.part = std::move(part);
  traced.camera_from_world = camera_from_world(scene.viewpoint());
  traced.camera_in_world_mm = inverse(traced.camera_from_world).translation_mm;
  check_camera_outside_part(scene.camera, scene.viewpoint(), 0, traced.built().part.mesh);
  const PinholeCamera camera(intrinsics_of(scene));
  trace_camera(scene, camera, defect_free, pool, traced);
  const VisibilityBuffer& seen = traced.seen();
  traced.part_mask = whole_pixels(seen.coverage);
  const std::vector<HeightFeature> outlines = may_be_unseen == MayBeUnseen::kNothing
                                                  ? traced.part->made.outlines
                                                  : seen_outlines(scene, camera, traced);
  traced.views = view_defects(
      outlines, seen, camera, traced.camera_from_world, scene.metrics.ring_outer_radii);
  traced.region = region_of(scene, traced, may_be_unseen);
  traced.defects = defect_pixels(traced.views, traced.part_mask, scene.metrics);
  traced.watched = Mask(seen.width_px, seen.height_px);
  for (const DefectPixels& defect : traced.defects) {
    for (const auto* pixels : {&defect.inside, &defect.ring, &defect.window}) {
      for (const std::size_t pixel : *pixels) {
        traced.watched.values()[pixel] = 1;
      }
    }
  }
  if (is_blurred(scene)) {
    check_no_light_returns(traced);
  }
  if (!needs_paths(scene)) {
    trace_flawless_windows(scene, camera, pool, traced);
  }
  return traced;
}

bool keeps_rays(const SceneSettings& scene) {
  return scene.render.method == RenderSettings::Method::kSampled || is_blurred(scene);
}

std::optional<Mask> scanned_part_mask(const SceneSettings& scene, const TracedScene& traced) {
  return needs_paths(scene) ? std::nullopt : std::optional(traced.part_mask);
}

std::vector<DefectView> view_defects(std::span<const HeightFeature> outlines,
                                     const VisibilityBuffer& seen,
                                     const PinholeCamera& camera,
                                     const RigidTransform& camera_from_world,
                                     double window_radii) {
  std::vector<DefectView> views;
  for (const HeightFeature& feature : outlines) {
    views.push_back(view_defect(feature, seen, camera, camera_from_world, window_radii));
  }
  return views;
}

void check_camera_outside_part(const CameraSettings& camera,
                               const Viewpoint& viewpoint,
                               std::size_t index,
                               const TriangleMesh& part) {
  // Closed but for small holes: an open surface never surrounds a camera that much.
  constexpr double kInside = 0.99;
  const BoundingBox box = bounding_box(part);
  const Vector3d camera_mm = inverse(camera_from_world(viewpoint)).translation_mm;
  const bool is_in_box = (camera_mm.array() > box.min_mm.array()).all() &&
                         (camera_mm.array() < box.max_mm.array()).all();
  if (is_in_box && std::abs(winding_number(part, camera_mm)) > kInside) {
    throw ConfigError(
        viewpoint.position_mm == default_viewpoint(camera).position_mm
            ? std::string("camera.working_distance_mm")
            : fmt::format("viewpoint.{}.position_mm", index),
        fmt::format("puts the camera at ({:.4g}, {:.4g}, {:.4g}) mm, inside the "
                    "part; it must be outside of the part, which reaches up to z = {:.4g} mm",
                    camera_mm.x() + 0.0,
                    camera_mm.y() + 0.0,
                    camera_mm.z() + 0.0,
                    box.max_mm.z()));
  }
}

void check_part_in_tunnel(const BuiltPart& built,
                          const Tunnel& tunnel,
                          const ScanSettings& scan,
                          const std::string& name) {
  for (const Vector2d& point : built.outline_yz_mm) {
    if (!tunnel.contains(point.x(), point.y())) {
      throw ConfigError(fmt::format("lighting.{}.shape", name),
                        fmt::format("the tunnel is smaller than the part: the part's point at "
                                    "y {:.1f} mm, z {:.1f} mm lies outside the cross-section",
                                    point.x(),
                                    point.y()));
    }
  }
  const double half_length = 0.5 * tunnel.settings().length_mm;
  if (built.max_x_mm > half_length || built.min_x_mm < -half_length) {
    throw ConfigError(fmt::format("lighting.{}.length_mm", name),
                      fmt::format("the tunnel is {:g} mm long and smaller than the part, "
                                  "which reaches from x {:.1f} to {:.1f} mm",
                                  tunnel.settings().length_mm,
                                  built.min_x_mm,
                                  built.max_x_mm));
  }
  const double travel_mm = (scan.positions - 1) * scan_step_mm(scan, tunnel.settings());
  if (travel_mm - half_length > built.min_x_mm) {
    throw ConfigError(
        "scan.step_mm",
        fmt::format("the tunnel travels {:g} mm and its end leaves the part, which begins at x "
                    "{:.1f} mm; allowed is a travel of {:g} mm, or a longer tunnel",
                    travel_mm,
                    built.min_x_mm,
                    half_length + built.min_x_mm));
  }
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/imaging/defect_windows.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include <fmt/format.h>

#include "core/error.h"
#include "core/text.h"

namespace glint {
namespace {

/// A box that grows.
struct PixelBox {
  double left = 1e9;
  double top = 1e9;
  double right = -1e9;
  double bottom = -1e9;

  void add(double x, double y) {
    left = std::min(left, x);
    top = std::min(top, y);
    right = std::max(right, x);
    bottom = std::max(bottom, y);
  }
};

/// Whole pixels of a picture, with a margin; without area where the box is empty.
PixelWindow window_of(const PixelBox& box, double margin_px, int width_px, int height_px) {
  const auto bound = [](double value, int maximum) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(maximum)));
  };
  const int left = bound(std::floor(box.left - margin_px), width_px);
  const int top = bound(std::floor(box.top - margin_px), height_px);
  const int right = bound(std::ceil(box.right + margin_px), width_px);
  const int bottom = bound(std::ceil(box.bottom + margin_px), height_px);
  return {.left_px = left, .top_px = top, .width_px = right - left, .height_px = bottom - top};
}

void add_outline(const HeightFeature& outline,
                 const TracedScene& traced,
                 const PinholeCamera& camera,
                 PixelBox& box) {
  DefectView view;
  try {
    view = view_defects({&outline, 1},
                        traced.seen(),
                        camera,
                        traced.camera_from_world,
                        SurfaceDetail::kReachRadii)
               .front();
  } catch (const ConfigError&) {
    return;  // outside the picture
  }
  for (int y = 0; y < view.distance.height(); ++y) {
    for (int x = 0; x < view.distance.width(); ++x) {
      if (static_cast<double>(view.distance(x, y)) <= SurfaceDetail::kReachRadii) {
        box.add(x + view.left_px, y + view.top_px);
        box.add(x + view.left_px + 1, y + view.top_px + 1);
      }
    }
  }
}

void add_triangle(const TriangleMesh& mesh,
                  std::size_t triangle,
                  const TracedScene& traced,
                  const PinholeCamera& camera,
                  PixelBox& box) {
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const auto seen = camera.project(traced.camera_from_world * mesh.vertex(triangle, corner));
    if (seen) {
      box.add(seen->x(), seen->y());
    }
  }
}

/// How far apart the ends of a line through a point are in the picture, [px].
double length_px(const Eigen::Vector3d& centre_mm,
                 const Eigen::Vector3d& half_line_mm,
                 const PinholeCamera& camera,
                 const RigidTransform& camera_from_world) {
  const auto from = camera.project(camera_from_world * (centre_mm - half_line_mm));
  const auto to = camera.project(camera_from_world * (centre_mm + half_line_mm));
  return from && to ? (*to - *from).norm() : 0.0;
}

}  // namespace

double narrowest_px(const HeightFeature& outline,
                    const PinholeCamera& camera,
                    const RigidTransform& camera_from_world) {
  const double radius_mm = 2.0 * outline.cross_sigma_mm();
  const auto along = [&](const Eigen::Vector3d& axis) {
    return length_px(outline.centre_mm, radius_mm * axis, camera, camera_from_world);
  };
  const double across = along(outline.v_axis);
  return outline.kind == HeightFeature::Kind::kScratch ? across
                                                       : std::min(across, along(outline.u_axis));
}

std::string narrow_defects_note(const TracedScene& traced, const SceneSettings& scene) {
  constexpr double kSmallest_px = 3.0;
  const PinholeCamera camera(intrinsics_of(scene));
  std::vector<std::string> narrow;
  for (const HeightFeature& outline : traced.part->made.outlines) {
    const double width_px = narrowest_px(outline, camera, traced.camera_from_world);
    if (width_px < kSmallest_px) {
      narrow.push_back(fmt::format("{} {:.2g} px", outline.label, width_px));
    }
  }
  return narrow.empty() ? ""
                        : fmt::format(
                              "Narrower than three pixels: {}. Scores of such a defect "
                              "depend on where the pixels happen to lie.",
                              join(narrow, ", "));
}

std::string defect_stripes_note(const TracedScene& traced, const SceneSettings& scene) {
  std::vector<std::string> fine;
  if (!scene.has_tunnel || scene.sensor.blur_px <= 0.0) {
    return "";
  }
  const double top_mm = Tunnel(scene.tunnel).top_mm();
  const double pixel_mm = lens_geometry(scene.camera, scene.lens).object_pixel_mm;
  for (const HeightFeature& outline : traced.part->made.outlines) {
    // A mirror of curvature c at the distance d turns a step on the part into 1 + 2 c d of the
    // wall.
    const double sigma_mm = outline.cross_sigma_mm();
    const double curvature_per_mm = std::abs(outline.height_mm) / (sigma_mm * sigma_mm);
    const double distance_mm = std::max(0.0, top_mm - outline.centre_mm.z());
    const double period_px =
        scene.tunnel.period_mm / (pixel_mm * (1.0 + 2.0 * curvature_per_mm * distance_mm));
    if (period_px < kFinestPeriod_px) {
      fine.push_back(fmt::format("{} {:.2g} px", outline.label, period_px));
    }
  }
  return fine.empty()
             ? ""
             : fmt::format(
                   "A period of the stripes is less than half a pixel in the middle of: "
                   "{}. Pixels alias such stripes, and blur is applied to pixels: what "
                   "changes in frames by these defects is uncertain by some 6 % of itself.",
                   join(fine, ", "));
}

std::vector<PixelWindow> defect_windows(const BuiltDefects& part,
                                        const TracedScene& traced,
                                        const PinholeCamera& camera,
                                        double blur_px) {
  std::map<std::int32_t, PixelBox> boxes;
  std::int32_t next = -1;  // ids of imprinted defects are positive
  for (const HeightFeature& outline : part.made.outlines) {
    add_outline(outline, traced, camera, boxes[next--]);
  }
  const TriangleMesh& mesh = part.built->part.mesh;
  for (std::size_t t = 0; t < part.made.labels.size(); ++t) {
    if (part.made.labels[t] > 0) {
      add_triangle(mesh, t, traced, camera, boxes[part.made.labels[t]]);
    }
  }
  const PinholeIntrinsics& picture = camera.intrinsics();
  std::vector<PixelWindow> windows;
  for (const auto& [id, box] : boxes) {
    const PixelWindow window = window_of(box, 1.0 + blur_px, picture.width_px, picture.height_px);
    if (window.width_px > 0 && window.height_px > 0) {
      windows.push_back(window);
    }
  }
  return windows;
}

}  // namespace glint

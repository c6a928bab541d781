// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/starter/starter_plan.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/error.h"
#include "core/units.h"

namespace glint {
namespace {

/// Of a picture's longer side. Paths cost more than rays, and rough metal shows no finer detail.
double largest_picture_px(StarterLight light) {
  return is_mirror(light) ? 1000.0 : 480.0;
}

/// Ten pixels in either picture.
double diameter_share(StarterLight light) {
  return is_mirror(light) ? 0.01 : 0.02;
}

[[noreturn]] void refuse(const Eigen::Vector3d& part_mm,
                         double working_distance_mm,
                         const char* light,
                         double min_mm) {
  throw ConfigError(fmt::format(
      "--working_distance_mm: {:g} mm leaves no room for a {} between camera and part, which is "
      "{:.4g} x {:.4g} x {:.4g} mm large; must be at least {:.0f} mm",
      working_distance_mm,
      light,
      part_mm.x(),
      part_mm.y(),
      part_mm.z(),
      std::ceil(min_mm)));
}

void size_tunnel(const Eigen::Vector3d& size_mm, StarterSizes& sizes) {
  const double reach_mm = 0.5 * std::hypot(size_mm.y(), size_mm.z());
  sizes.tunnel_radius_mm = std::min(std::ceil(2.0 * reach_mm + 20.0), sizes.largest_radius_mm);
  // The view narrows from the part to the pinhole; the slot lets it through.
  const double narrowed = (sizes.working_distance_mm - sizes.tunnel_radius_mm) / sizes.top_mm;
  sizes.slot_mm = std::ceil(size_mm.y() * std::max(0.0, narrowed) + 2.0);
  sizes.length_mm = std::ceil(size_mm.x() + 6.0 * sizes.tunnel_radius_mm);
  sizes.period_mm = std::max(1.0, std::round(sizes.tunnel_radius_mm / 6.0));
}

}  // namespace

std::string_view light_name(StarterLight light) {
  switch (light) {
    case StarterLight::kTunnel:
      return "tunnel";
    case StarterLight::kRing:
      return "ring";
    case StarterLight::kDome:
      return "dome";
    case StarterLight::kBar:
      return "bar";
    case StarterLight::kAll:
      break;
  }
  return "all";
}

StarterSizes starter_sizes(const Eigen::Vector3d& upright_mm,
                           double tilt_deg,
                           double working_distance_mm,
                           StarterLight light) {
  const double cosine = std::cos(tilt_deg * kRadPerDeg);
  const double sine = std::sin(tilt_deg * kRadPerDeg);
  const Eigen::Vector3d size_mm(upright_mm.x(),
                                cosine * upright_mm.y() + sine * upright_mm.z(),
                                sine * upright_mm.y() + cosine * upright_mm.z());
  StarterSizes sizes{.tilt_deg = tilt_deg, .working_distance_mm = working_distance_mm};
  sizes.top_mm = working_distance_mm - 0.5 * size_mm.z();
  sizes.largest_radius_mm = 0.8 * working_distance_mm;
  const bool with_tunnel = is_mirror(light) || light == StarterLight::kAll;
  const double reach_mm = 0.5 * std::hypot(size_mm.y(), size_mm.z());
  if (with_tunnel && sizes.largest_radius_mm < 1.1 * reach_mm) {
    refuse(upright_mm, working_distance_mm, "tunnel", 1.1 * reach_mm / 0.8);
  }
  sizes.dome_radius_mm = std::max(0.55 * working_distance_mm, 0.65 * size_mm.norm());
  if (!is_mirror(light) && sizes.dome_radius_mm > 0.9 * working_distance_mm) {
    refuse(upright_mm, working_distance_mm, "light", 0.65 * size_mm.norm() / 0.9);
  }
  // The top of the part is nearer to the camera than its middle and looks larger.
  const double enlarged = working_distance_mm / sizes.top_mm;
  const double extent_mm = std::max(size_mm.x(), size_mm.y());
  sizes.object_pixel_mm = extent_mm / largest_picture_px(light);
  const auto pixels = [&](double size) {  // a plate may be seen on edge
    return std::max(
               1,
               static_cast<int>(std::ceil(1.1 * enlarged * size / sizes.object_pixel_mm / 16.0))) *
           16;
  };
  sizes.width_px = pixels(size_mm.x());
  sizes.height_px = pixels(size_mm.y());
  sizes.view_radius_mm = 0.55 * enlarged * std::hypot(size_mm.x(), size_mm.y());
  sizes.diameter_mm = diameter_share(light) * extent_mm;
  size_tunnel(size_mm, sizes);
  return sizes;
}

double StarterPlan::exposure(StarterLight kind) const {
  const auto found = exposures.find(kind);
  return found == exposures.end() ? 1.0 : found->second;
}

double StarterPlan::depth_mm() const {
  return slope_rad * 0.25 * sizes.diameter_mm * std::exp(0.5);
}

std::string_view objective_of(StarterLight light) {
  // Under one lamp a dent has a bright and a dark flank, which cancel in its mean and so in its
  // CNR.
  return is_mirror(light) ? "defects.min_cnr" : "defects.min_dprime";
}

}  // namespace glint

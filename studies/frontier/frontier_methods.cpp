// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/frontier_methods.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

namespace glint {
namespace {

using Method = RenderSettings::Method;

constexpr int kReferenceRaysPerAxis = 16;
constexpr std::array kFacets_um = {2.0, 20.0, 200.0};

std::string number_text(double value) {
  return fmt::format("{:g}", value);
}

/// What the part is made of when nothing is changed.
std::string own_tessellation(const PartSettings& part) {
  if (part.shape == PartSettings::Shape::kMesh) {
    return "mesh file";
  }
  return part.facets_mm > 0.0 ? fmt::format("facets {:g} um", part.facets_mm * 1e3)
                              : "exact surface";
}

std::string method_text(const FrontierPoint& point) {
  switch (point.method) {
    case Method::kSampled:
      return fmt::format("{} ray{} a pixel", point.rays_per_px, point.rays_per_px == 1 ? "" : "s");
    case Method::kIntegrated:
      return fmt::format("integrated, {} mrad", number_text(point.direction_mrad));
    case Method::kClosed:
      return "closed forms";
    case Method::kPaths:
      return "path tracing";
    case Method::kAuto:
      break;
  }
  return point.has_frames ? "own choice for pictures" : "own choice for scores";
}

class MethodList {
 public:
  explicit MethodList(const SceneSettings& scene)
      : own_mrad_(scene.render.max_direction_error_rad * 1e3),
        own_tessellation_(own_tessellation(scene.part)) {
    for (const int reduction : {1, 2}) {
      add_all(reduction);
    }
    for (const bool has_frames : {false, true}) {
      add({.method = Method::kAuto,
           .direction_mrad = own_mrad_,
           .has_frames = has_frames,
           .is_choice = true});
    }
    if (scene.part.shape != PartSettings::Shape::kMesh) {
      for (const double facets_um : kFacets_um) {
        add_facets(fmt::format("facets {:g} um", facets_um));
      }
    }
  }

  std::vector<FrontierPoint> points() { return std::move(points_); }

 private:
  void add(FrontierPoint point) {
    if (point.tessellation.empty()) {
      point.tessellation = own_tessellation_;
    }
    point.label = method_text(point);
    if (point.reduction > 1) {
      point.label += ", half resolution";
    }
    if (point.tessellation != own_tessellation_) {
      point.label += ", " + point.tessellation;
    }
    points_.push_back(std::move(point));
  }

  void add_all(int reduction) {
    for (const int per_axis : {1, 2, 4, 8, 16}) {
      add({.method = Method::kSampled,
           .rays_per_px = per_axis * per_axis,
           .reduction = reduction,
           .is_reference = reduction == 1 && per_axis == kReferenceRaysPerAxis});
    }
    for (const double mrad : {2.0, 0.2, 0.02}) {
      add({.method = Method::kIntegrated, .direction_mrad = mrad, .reduction = reduction});
    }
    add({.method = Method::kClosed,
         .direction_mrad = own_mrad_,
         .reduction = reduction,
         .has_frames = false});
  }

  void add_facets(const std::string& tessellation) {
    if (tessellation == own_tessellation_) {
      return;
    }
    add({.method = Method::kSampled, .rays_per_px = 4, .tessellation = tessellation});
    add({.method = Method::kIntegrated, .direction_mrad = 0.2, .tessellation = tessellation});
  }

  double own_mrad_;
  std::string own_tessellation_;
  std::vector<FrontierPoint> points_;
};

}  // namespace

std::vector<FrontierPoint> frontier_methods(const SceneSettings& scene) {
  return MethodList(scene).points();
}

SceneSettings half_resolution(SceneSettings scene) {
  CameraSettings& camera = scene.camera;
  const PinholeIntrinsics full = intrinsics_of(camera);
  camera.width_px = std::max(1, camera.width_px / 2);
  camera.height_px = std::max(1, camera.height_px / 2);
  camera.center_x_px = 0.5 * full.center_px.x();
  camera.center_y_px = 0.5 * full.center_px.y();
  camera.pixel_mm *= 2.0;
  camera.object_pixel_mm *= 2.0;
  camera.focal_x_px *= 0.5;
  camera.focal_y_px *= 0.5;
  scene.sensor.blur_px *= 0.5;
  scene.metrics.erosion_px = (scene.metrics.erosion_px + 1) / 2;
  return scene;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/frontier_methods.h"

#include <algorithm>
#include <array>
#include <functional>

#include <fmt/format.h>

namespace glint {
namespace {

constexpr int kReferenceRays = 256;  ///< a pixel
constexpr std::array kFacets_um = {2.0, 20.0, 200.0};

/// What the part is made of when nothing is changed.
std::string own_tessellation(const PartSettings& part) {
  if (part.shape == PartSettings::Shape::kMesh) {
    return "mesh file";
  }
  return part.facets_mm > 0.0 ? fmt::format("facets {:g} um", part.facets_mm * 1e3)
                              : "exact surface";
}

/// Triangles that the part is made of instead, where its surface is known.
std::vector<std::string> other_tessellations(const PartSettings& part) {
  std::vector<std::string> others;
  if (part.shape != PartSettings::Shape::kMesh) {
    for (const double facets_um : kFacets_um) {
      others.push_back(fmt::format("facets {:g} um", facets_um));
    }
    std::erase(others, own_tessellation(part));
  }
  return others;
}

}  // namespace

std::vector<FrontierPoint> frontier_methods(const SceneSettings& scene) {
  const std::vector<ComparedMethod> methods = compared_methods(scene);
  if (methods.empty()) {
    throw ConfigError("render.method",
                      "a frontier compares the methods for a plain mirror under one tunnel; this "
                      "scene is path-traced");
  }
  const std::string own = own_tessellation(scene.part);
  std::vector<FrontierPoint> points;
  const auto add = [&](auto is_wanted, int reduction, const std::string& tessellation) {
    for (const ComparedMethod& method : methods) {
      if (std::invoke(is_wanted, method)) {
        points.push_back({.method = method,
                          .label = method.label + (reduction > 1 ? ", half resolution" : "") +
                                   (tessellation != own ? ", " + tessellation : ""),
                          .reduction = reduction,
                          .tessellation = tessellation,
                          .is_reference = reduction == 1 && method.rays_per_px == kReferenceRays});
      }
    }
  };
  const auto is_asked_for = [](const ComparedMethod& method) { return !method.is_choice; };
  add(is_asked_for, 1, own);
  add(is_asked_for, 2, own);
  add(&ComparedMethod::is_choice, 1, own);
  for (const std::string& tessellation : other_tessellations(scene.part)) {
    add(&ComparedMethod::is_usual, 1, tessellation);
  }
  return points;
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

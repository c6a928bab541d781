// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/frontier/frontier_methods.h"

#include <algorithm>
#include <array>
#include <functional>
#include <string_view>

#include <fmt/format.h>

#include "simulator/sensor/sensor.h"
#include "studies/definition/ladder/larger_pixels.h"

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

constexpr std::string_view kFacetWord = "facets ";
constexpr std::array kRealisations = {
    Realisation::kNormal, Realisation::kDisplaced, Realisation::kImprinted};

/// Realisations that change something for at least one group.
std::vector<std::string> other_realisations(const SceneSettings& scene) {
  std::vector<std::string> others;
  for (const Realisation realisation : kRealisations) {
    if (std::ranges::any_of(scene.defects, [&](const NamedGroup& group) {
          return group.second.type != DefectType::kStain && group.second.realisation != realisation;
        })) {
      others.emplace_back(realisation_name(realisation));
    }
  }
  return others;
}

void put_realisation(const std::string& name, SceneSettings& scene) {
  for (const Realisation realisation : kRealisations) {
    for (auto& [label, group] : scene.defects) {
      if (realisation_name(realisation) == name && group.type != DefectType::kStain) {
        group.realisation = realisation;
      }
    }
  }
}

/// Collects points; what differs from the scene's own is in their labels.
class PointList {
 public:
  explicit PointList(const SceneSettings& scene) : own_(own_tessellation(scene.part)) {}

  void add(const ComparedMethod& method, const FrontierPoint& how) {
    FrontierPoint point = how;
    point.method = method;
    point.tessellation = how.tessellation.empty() ? own_ : how.tessellation;
    point.method.is_current = method.is_current && how.reduction == 1 &&
                              point.tessellation == own_ && how.realisation.empty();
    point.label = method.label;
    point.label += how.reduction == 2 ? ", half resolution" : "";
    point.label += how.reduction > 2 ? fmt::format(", 1/{} resolution", how.reduction) : "";
    point.label += point.tessellation != own_ ? ", " + point.tessellation : "";
    point.label += how.realisation.empty() ? "" : ", defects " + how.realisation;
    point.is_reference = point.label == method.label && method.rays_per_px == kReferenceRays;
    points_.push_back(std::move(point));
  }

  std::vector<FrontierPoint> points() { return std::move(points_); }

 private:
  std::string own_;
  std::vector<FrontierPoint> points_;
};

}  // namespace

std::vector<FrontierPoint> frontier_methods(const SceneSettings& scene) {
  std::vector<ComparedMethod> methods = compared_methods(scene);
  const std::vector<ComparedMethod> paths = compared_paths(scene);
  methods.insert(methods.end(), paths.begin(), paths.end());
  PointList list(scene);
  const auto add = [&](auto is_wanted, const FrontierPoint& how) {
    for (const ComparedMethod& method : methods) {
      if (std::invoke(is_wanted, method)) {
        list.add(method, how);
      }
    }
  };
  const auto is_asked_for = [](const ComparedMethod& method) { return !method.is_choice; };
  const auto has_own_reflections = [&](const ComparedMethod& method) {
    return is_asked_for(method) &&
           (!method.is_noisy || method.paths.max_reflections == scene.paths.max_reflections);
  };
  add(is_asked_for, {});
  add(has_own_reflections, {.reduction = 2});
  if (!paths.empty()) {
    add(&ComparedMethod::is_usual, {.reduction = 4});
  }
  add(&ComparedMethod::is_choice, {});
  for (const std::string& tessellation : other_tessellations(scene.part)) {
    add(&ComparedMethod::is_usual, {.tessellation = tessellation});
  }
  const auto is_finest_usual = [](const ComparedMethod& method) {
    return method.is_usual && method.rays_per_px == 0;
  };
  for (const std::string& realisation : other_realisations(scene)) {
    add(is_finest_usual, {.realisation = realisation});
  }
  return list.points();
}

SceneSettings scene_of(const FrontierPoint& point, SceneSettings scene) {
  scene = rendered_by(point.method, std::move(scene));
  if (point.tessellation.starts_with(kFacetWord)) {
    scene.part.facets_mm = std::stod(point.tessellation.substr(kFacetWord.size())) * 1e-3;
  }
  put_realisation(point.realisation, scene);
  return with_larger_pixels(std::move(scene), point.reduction);
}

SceneSettings noiseless(SceneSettings scene) {
  scene.sensor = without_noise(scene.sensor);
  scene.sensor.bits = 0;
  return scene;
}

int pixel_factor(const CameraSettings& camera, double max_pixels) {
  const auto pixels = [&](int factor) {
    const int cols = camera.width_px / factor;
    const int rows = camera.height_px / factor;
    return static_cast<double>(cols) * rows;
  };
  int factor = 1;
  while (pixels(factor) > max_pixels) {
    ++factor;
  }
  return factor;
}

}  // namespace glint

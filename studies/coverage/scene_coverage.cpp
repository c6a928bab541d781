// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/coverage/scene_coverage.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "metrics/coverage/separation.h"
#include "studies/definition/scene_viewpoints.h"
#include "studies/imaging/places/place_light.h"
#include "studies/imaging/scene_picture.h"

namespace glint {
namespace {

using Eigen::Vector3d;

CellState state_in_light(const PlaceLight& light, const CoverageSettings& settings) {
  if (light.is_hidden) {
    return CellState::kHidden;
  }
  if (light.lit_share < settings.min_lit_share) {
    return CellState::kUnlit;
  }
  if (light.mean < settings.min_grey) {
    return CellState::kDark;
  }
  return settings.max_grey < 1.0 && light.darkest > settings.max_grey ? CellState::kClipped
                                                                      : CellState::kInspected;
}

/// With the exposure that the pictures have of the first view that can be exposed; as it is where
/// none can: it is dark then.
SceneSettings exposed(SceneStore& store,
                      SceneSettings scene,
                      const std::vector<Viewpoint>& viewpoints) {
  SceneSettings flawless = scene;
  flawless.defects.clear();
  flawless.viewpoint_set.source = ViewpointSource::kListed;
  for (const Viewpoint& viewpoint : viewpoints) {
    if (scene.expose_to <= 0.0) {
      break;
    }
    flawless.viewpoints = {viewpoint};
    try {
      scene.sensor = with_equal_exposure(store, flawless).sensor;
      scene.expose_to = 0.0;
    } catch (const ConfigError&) {  // no light comes from there
    }
  }
  return scene;
}

class Covering {
 public:
  Covering(SceneStore& store, const SceneSettings& scene, int largest_k)
      : store_(store), scene_(scene), largest_k_(largest_k) {
    result_.part = store.build(scene);
    check_cameras_outside_part(store, scene);
    result_.viewpoints = viewpoints_of(scene, result_.part->part);
    result_.has_light = scene.coverage.has_light && is_lit(scene);
    if (result_.has_light) {
      check_part_in_tunnel(store, scene);
      scene_ = exposed(store, scene, result_.viewpoints);
    }
    result_.cells = surface_cells(result_.part->part, scene.coverage.points, scene.coverage.seed);
    result_.visibility = Visibility(result_.viewpoints.size(), result_.cells.size());
    result_.area_mm2 =
        std::accumulate(result_.cells.areas_mm2.begin(), result_.cells.areas_mm2.end(), 0.0);
  }

  void look(const CoverageProgress& progress) {
    for (std::size_t i = 0; i < result_.viewpoints.size(); ++i) {
      if (progress) {
        progress(i, result_.viewpoints.size());
      }
      views_.push_back(look_from(result_.viewpoints[i]));
      for (std::size_t cell = 0; cell < result_.cells.size(); ++cell) {
        if (views_.back()[cell].state == CellState::kInspected) {
          result_.visibility.set(i, cell);
        }
      }
    }
  }

  SceneCoverage judge() {
    choose();
    const Visibility used = visibility_of_used();
    result_.coverage = coverage_of(used, result_.cells.areas_mm2, 1);
    result_.of_cell.resize(result_.cells.size());
    std::vector<std::int32_t> separated(result_.cells.size());
    store_.pool().for_each(static_cast<std::int64_t>(result_.cells.size()),
                           [&](std::int64_t cell) { judge_cell(static_cast<std::size_t>(cell)); });
    for (std::size_t cell = 0; cell < result_.cells.size(); ++cell) {
      separated[cell] = result_.of_cell[cell].separated;
      result_.state_shares[static_cast<std::size_t>(result_.of_cell[cell].state)] +=
          result_.cells.areas_mm2[cell] / result_.area_mm2;
    }
    const int largest_k = std::clamp(static_cast<int>(result_.used.size()), 1, largest_k_);
    result_.coverage.ck = shares_of_counts(separated, result_.cells.areas_mm2, largest_k);
    find_gap();
    return std::move(result_);
  }

 private:
  /// What is kept of each view and cell.
  struct Look {
    CellState state = CellState::kUnseen;
    float pixel_mm = 0.0F;
    float lit_share = 0.0F;
  };

  std::vector<Look> look_from(const Viewpoint& viewpoint) {
    const CoverageView view = coverage_view(scene_.camera, scene_.lens, viewpoint);
    std::vector<ViewCell> cells = view_cells(
        result_.cells, *result_.part->bvh, view, scene_.coverage, store_.pool(), result_.rays);
    if (result_.has_light) {
      add_light(viewpoint, cells);
    }
    std::vector<Look> looks;
    std::ranges::transform(cells, std::back_inserter(looks), [](const ViewCell& cell) {
      return Look{.state = cell.state, .pixel_mm = cell.pixel_mm, .lit_share = cell.lit_share};
    });
    return looks;
  }

  void add_light(const Viewpoint& viewpoint, std::vector<ViewCell>& cells) const {
    std::vector<SeenPlace> places;
    std::vector<std::size_t> numbers;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      if (cells[i].state == CellState::kInspected) {
        places.push_back({.point_mm = result_.cells.points_mm[i],
                          .normal = result_.cells.normals[i],
                          .pixel_px = cells[i].pixel_px.cast<double>()});
        numbers.push_back(i);
      }
    }
    if (places.empty()) {
      return;
    }
    const std::vector<PlaceLight> lights =
        light_of_places(store_, scene_, viewpoint, places, scene_.coverage.samples);
    for (std::size_t i = 0; i < lights.size(); ++i) {
      cells[numbers[i]].lit_share = static_cast<float>(lights[i].lit_share);
      cells[numbers[i]].state = state_in_light(lights[i], scene_.coverage);
    }
  }

  void choose() {
    const CoverageSettings& settings = scene_.coverage;
    const int all = static_cast<int>(result_.viewpoints.size());
    result_.used.resize(result_.viewpoints.size());
    std::iota(result_.used.begin(), result_.used.end(), std::size_t{0});
    if (settings.choose > 0 && settings.choose < all) {
      const bool is_exact = settings.choice == CoverageSettings::Choice::kExact;
      const std::vector<double>& areas_mm2 = result_.cells.areas_mm2;
      result_.choice = is_exact ? choose_exact(result_.visibility, areas_mm2, settings.choose)
                                : choose_greedy(result_.visibility, areas_mm2, settings.choose);
      result_.used = result_.choice->views;
    }
  }

  Visibility visibility_of_used() const {
    Visibility used(result_.used.size(), result_.cells.size());
    for (std::size_t i = 0; i < result_.used.size(); ++i) {
      std::ranges::copy(result_.visibility.row(result_.used[i]), used.row(i).begin());
    }
    return used;
  }

  void judge_cell(std::size_t cell) {
    CellCoverage& all = result_.of_cell[cell];
    std::vector<Vector3d> directions;
    double straightest = 0.0;
    for (const std::size_t view : result_.used) {
      const Look& look = views_[view][cell];
      all.state = std::max(all.state, look.state);
      all.lit_share = std::max(all.lit_share, look.lit_share);
      if (look.state == CellState::kInspected) {
        all.pixel_mm = all.views == 0 ? look.pixel_mm : std::min(all.pixel_mm, look.pixel_mm);
        ++all.views;
        const std::vector<double>& position = result_.viewpoints[view].position_mm;
        const Vector3d camera_mm(position[0], position[1], position[2]);
        directions.push_back((camera_mm - result_.cells.points_mm[cell]).normalized());
        straightest = std::max(straightest, directions.back().dot(result_.cells.normals[cell]));
      }
    }
    if (all.views > 0) {
      all.incidence_rad = static_cast<float>(std::acos(std::min(straightest, 1.0)));
    }
    all.separated = separated_count(directions, scene_.coverage.separation_rad, largest_k_);
  }

  void find_gap() {
    std::vector<std::uint8_t> is_open(result_.cells.size());
    std::ranges::transform(result_.of_cell, is_open.begin(), [](const CellCoverage& cell) {
      return static_cast<std::uint8_t>(cell.views == 0 ? 1 : 0);
    });
    SurfacePatch patch = largest_patch(is_open, result_.cells.areas_mm2, result_.cells.links);
    CoverageGap& gap = result_.gap;
    gap.area_mm2 = patch.weight;
    if (patch.points.empty()) {
      return;
    }
    const std::vector<Vector3d>& points_mm = result_.cells.points_mm;
    Vector3d middle_mm = Vector3d::Zero();
    std::array<double, kCellStates> areas = {};
    for (const std::size_t i : patch.points) {
      middle_mm += result_.cells.areas_mm2[i] / patch.weight * points_mm[i];
      areas[static_cast<std::size_t>(result_.of_cell[i].state)] += result_.cells.areas_mm2[i];
    }
    const auto distance_to = [&](const Vector3d& from_mm) {
      return [&, from_mm](std::size_t i) { return (points_mm[i] - from_mm).squaredNorm(); };
    };
    const std::size_t nearest = *std::ranges::min_element(patch.points, {}, distance_to(middle_mm));
    const std::size_t end = *std::ranges::max_element(patch.points, {}, distance_to(middle_mm));
    const std::size_t other =
        *std::ranges::max_element(patch.points, {}, distance_to(points_mm[end]));
    gap.place_mm = points_mm[nearest];
    gap.normal = result_.cells.normals[nearest];
    gap.size_mm = (points_mm[end] - points_mm[other]).norm();
    gap.state = static_cast<CellState>(std::ranges::max_element(areas) - areas.begin());
    gap.cells = std::move(patch.points);
  }

  SceneStore& store_;
  SceneSettings scene_;
  int largest_k_;
  SceneCoverage result_;
  std::vector<std::vector<Look>> views_;
};

}  // namespace

SceneCoverage cover_scene(SceneStore& store,
                          const SceneSettings& scene,
                          const CoverageProgress& progress,
                          int largest_k) {
  Covering covering(store, scene, largest_k);
  covering.look(progress);
  return covering.judge();
}

Scores coverage_scores(SceneStore& store, const SceneSettings& scene) {
  const SceneCoverage covered = cover_scene(store, scene, {}, 2);
  const std::vector<double>& ck = covered.coverage.ck;
  return {{"coverage.c1", covered.coverage.c1()},
          {"coverage.c2", ck.size() > 1 ? ck[1] : 0.0},
          {"coverage.redundancy", covered.coverage.redundancy},
          {"coverage.largest_gap_mm2", covered.gap.area_mm2}};
}

}  // namespace glint

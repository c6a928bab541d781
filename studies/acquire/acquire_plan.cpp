// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/acquire_plan.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <thread>

#include <fmt/format.h>

#include "core/thread_pool.h"
#include "core/units.h"
#include "hardware/planning/plan_check.h"
#include "hardware/robot/path_check.h"
#include "studies/acquire/acquired.h"
#include "studies/acquire/expected_parts.h"
#include "studies/acquire/plan_digest.h"
#include "studies/acquire/source_files.h"
#include "studies/acquire/taught_views.h"
#include "studies/cell/pose_numbers.h"
#include "studies/cell_camera/cell_camera.h"
#include "studies/definition/study.h"
#include "studies/imaging/path_lights.h"
#include "studies/imaging/scene_picture.h"
#include "studies/plan/plan_file.h"
#include "studies/plan/scene_plan.h"
#include "studies/reach/scene_cell.h"

namespace glint {
namespace {

namespace fs = std::filesystem;

constexpr double kJoinedRad = 1e-6;

JointVector joints_of(const CellPosition& position) {
  return Eigen::Map<const JointVector>(position.joints_rad.data());
}

bool is_safe(const Cell& cell, const JointVector& joints_rad) {
  return std::ranges::any_of(cell.safe_positions, [&](const CellPosition& position) {
    return (joints_of(position) - joints_rad).cwiseAbs().maxCoeff() < kJoinedRad;
  });
}

/// Where no view is taken, the reason of the first one says more than that there is no path.
void check_any_taken(const ViewPlan& plan) {
  if (plan.paths.empty() && !plan.views.empty() &&
      plan.views.front().outcome != ViewOutcome::kPlanned) {
    const PlannedView& view = plan.views.front();
    throw NoViewTaken(fmt::format(
        "views: none can be taken; {}: {}: {}", view.name, name_of(view.outcome), view.reason));
  }
}

/// All paths one after the other.
Tour tour_of(const ViewPlan& plan, const Cell& cell) {
  Tour tour;
  for (const PlannedPath& path : plan.paths) {
    if (tour.empty()) {
      tour.push_back({.name = path.from, .joints_rad = path.joints_rad.front()});
    }
    const double gap = (tour.back().joints_rad - path.joints_rad.front()).cwiseAbs().maxCoeff();
    if (gap > kJoinedRad) {
      throw ConfigError(
          fmt::format("paths: the one from {} to {} does not begin where the one before it ends",
                      path.from,
                      path.to));
    }
    for (std::size_t i = 1; i < path.joints_rad.size(); ++i) {
      const bool is_last = i + 1 == path.joints_rad.size();
      tour.push_back({.name = is_last ? path.to : "", .joints_rad = path.joints_rad[i]});
    }
  }
  for (TourPoint& point : tour) {
    point.is_safe = is_safe(cell, point.joints_rad);
  }
  if (tour.empty() || !tour.front().is_safe) {
    throw ConfigError("paths: must begin at a [[safe_position]] of the cell");
  }
  return tour;
}

void check_legs(const Tour& tour, const Cell& cell, double share) {
  const ArmWithTool arm = arm_with_tool(robot_of(cell), cell.limits);
  for (std::size_t i = 0; i + 1 < tour.size(); ++i) {
    const CheckedMotion motion =
        check_joint_motion(arm, tour[i].joints_rad, tour[i + 1].joints_rad, share);
    if (!motion.is_allowed()) {
      throw ConfigError(fmt::format(
          "paths: {}: {}", place_text(tour, {.leg = i, .is_point = false}), motion.text));
    }
  }
}

void check_lights(const std::vector<std::string>& names, const Cell& cell) {
  for (const std::string& name : names) {
    if (std::ranges::find(cell.lights, name, &CellLight::name) == cell.lights.end()) {
      throw ConfigError(fmt::format(
          "lighting.{}: the cell has no [lights.{}] that is switched for it", name, name));
    }
  }
}

std::size_t point_named(const Tour& tour, const PlannedView& view) {
  for (std::size_t i = 0; i < tour.size(); ++i) {
    if (tour[i].name == view.name &&
        (tour[i].joints_rad - view.joints_rad).cwiseAbs().maxCoeff() < kJoinedRad) {
      return i;
    }
  }
  throw ConfigError(fmt::format("paths: none leads to the planned view {}", view.name));
}

/// By which a design multiplies the cell's exposure.
double exposure_of(const SceneSettings& scene) {
  if (scene.expose_to <= 0.0) {
    return scene.sensor.exposure;
  }
  ThreadPool pool(static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
  SceneStore store(pool);
  return with_equal_exposure(store, scene).sensor.exposure;
}

bool lies_in_cell(const AcquireSource& source) {
  return source.scene && source.scene->cell &&
         (source.scene->cell->base_from_part || source.scene->cell->flange_from_part);
}

/// The [[view]] of the cell that says how a planned view is taken; nullptr: none does. Planned by
/// the cell's file alone the views are its own, one by one, with a name or without; others have
/// their names.
const CellPosition* own_view(const ViewPlan& views,
                             std::size_t index,
                             const AcquireSource& source,
                             const Cell& cell) {
  if (!source.plan && !lies_in_cell(source)) {
    return &cell.views.at(index);
  }
  const auto own = std::ranges::find(cell.views, views.views[index].name, &CellPosition::name);
  return own == cell.views.end() ? nullptr : &*own;
}

std::vector<ViewTask> tasks_of(const ViewPlan& views,
                               const Tour& tour,
                               const AcquireSource& source,
                               const Cell& cell,
                               int num_positions) {
  std::vector<ViewTask> tasks;
  acquire_detail::ExpectedParts expected;
  double exposure = 1.0;
  if (source.scene) {
    expected = acquire_detail::expected_parts(*source.scene, cell, views.views);
    exposure = exposure_of(*source.scene);
  }
  for (std::size_t i = 0; i < views.views.size(); ++i) {
    const PlannedView& view = views.views[i];
    if (view.outcome != ViewOutcome::kPlanned) {
      continue;
    }
    const CellPosition* own = own_view(views, i, source, cell);
    ViewTask task = {.point = point_named(tour, view), .name = view.name};
    task.exposure_us = 1e6 * camera_of(cell).exposure_s;
    if (own != nullptr) {
      task.lights = own->lights;
      task.exposure_us = 1e6 * own->exposure_s.value_or(camera_of(cell).exposure_s);
    }
    if (source.scene) {
      task.lights = shining_lights(*source.scene);
    }
    task.exposure_us *= exposure;
    if (!expected.masks.empty()) {
      // The stripes of a scan may be less sharp than the part: its sequence is compared with
      // itself.
      const double blur_px = num_positions == 1 ? expected.blur_px[i] : 0.0;
      task.expected = {
          .part = expected.masks[i], .tolerance_px = expected.tolerance_px, .blur_px = blur_px};
    }
    check_lights(task.lights, cell);
    task.positions.resize(static_cast<std::size_t>(num_positions));
    std::iota(task.positions.begin(), task.positions.end(), 0);
    tasks.push_back(task);
  }
  std::ranges::stable_sort(tasks, {}, &ViewTask::point);
  return tasks;
}

void check_names(const std::vector<ViewTask>& tasks) {
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (folder_name_of(tasks[i].name) == folder_name_of(tasks[j].name)) {
        throw ConfigError(fmt::format(
            R"(views: "{}" and "{}" have the same folder)", tasks[j].name, tasks[i].name));
      }
    }
  }
}

const SceneSettings* scene_of(const AcquireSource& source) {
  return source.scene ? &*source.scene : nullptr;
}

ViewPlan views_of(const AcquireSource& source, const Cell& cell, double speed_share) {
  if (source.plan) {
    return *source.plan;
  }
  if (lies_in_cell(source)) {
    return plan_scene(*source.scene, cell).plan;
  }
  return plan_of_cell_views(cell, speed_share, scene_of(source));
}

/// A plan may have been made for another cell, or before something was put into this one.
void check_free(const ViewPlan& plan, const AcquireSource& source, const Cell& cell) {
  const PlanningCell planned = lies_in_cell(source) ? planning_cell_of(*source.scene, cell)
                                                    : planning_cell(cell, scene_of(source));
  const std::string touch = obstruction(planned, plan);
  if (!touch.empty()) {
    throw ConfigError(
        fmt::format("paths: {}; in this cell the plan cannot be driven, plan again", touch));
  }
}

[[noreturn]] void refuse_stage(const Cell& cell, const std::string& key, const std::string& text) {
  throw ConfigError({.kind = Problem::Kind::kRelation,
                     .place = {.file = cell.file.string()},
                     .key = key,
                     .text = text});
}

/// Stripes that no linear stage moves stand where hands or pictures have put them.
void check_offset(const SceneSettings& scene, const Cell& cell) {
  const double offset_mm = scene.tunnel.offset_mm;
  const double shown_mm = cell.stage ? cell.stage->offset_mm : 0.0;
  if (offset_mm == shown_mm) {
    return;
  }
  const std::string why =
      cell.stage ? fmt::format(
                       "the pictures of the cell's [stage] are for stage.offset_mm = {}: must "
                       "be the same; draw them for this design, and set it",
                       shown_mm)
                 : "the cell has no [stage] that takes the stripes there: must be 0";
  throw ConfigError(fmt::format("lighting.{}.offset_mm", scene.tunnel_name),
                    fmt::format("is {}, and {}", offset_mm, why));
}

/// The scan of the scene as this cell's stage makes it. @return how many positions
int set_scan(const SceneSettings& scene, const Cell& cell, ScanSteps& steps) {
  const StageScan scan = stage_scan(scene);
  steps.to_next_mm = scan.step_mm;
  if (cell.stage && cell.stage->kind == CellStage::Kind::kGrbl) {
    steps.to_first_mm = stripe_offset_mm(scene);
  } else if (scan.step_mm > 0.0) {
    check_offset(scene, cell);
  }
  return scan.positions;
}

/// What the stage cannot do is found before the arm drives out for it.
void check_stage(const AcquireWork& work, const Cell& cell) {
  if (!cell.stage) {
    if (work.num_positions > 1) {
      throw ConfigError(fmt::format(
          "scan.positions: is {}, and the cell has no [stage] that takes the stripes there",
          work.num_positions));
    }
    return;
  }
  const CellStage& stage = *cell.stage;
  const bool is_display = stage.kind != CellStage::Kind::kGrbl;
  if (is_display && std::ssize(stage.pictures) < work.num_positions) {
    refuse_stage(cell,
                 "stage.pictures",
                 fmt::format("are {}, must be at least {}: one for each position of the scan",
                             stage.pictures.size(),
                             work.num_positions));
  }
  if (!is_display && work.num_positions > 1 &&
      stage_way_of(stage, work.num_positions, work.steps).step_mm == 0.0) {
    refuse_stage(cell,
                 "stage.step_mm",
                 fmt::format("is 0, and no scan says another step: all {} positions are one place; "
                             "must not be 0, or stage.positions must be 0 or 1",
                             work.num_positions));
  }
}

}  // namespace

AcquireSource read_source(const fs::path& path) {
  const SourceFiles files = files_of(path);
  AcquireSource source;
  if (!files.plan.empty()) {
    source.plan = read_plan(files.plan).plan;
  }
  if (!files.scene.empty()) {
    source.scene = load_study(files.scene, {}).scene;
  }
  return source;
}

AcquireWork work_of(const AcquireSource& source, const Cell& cell, double speed_share) {
  AcquireWork work;
  work.views = views_of(source, cell, speed_share);
  check_any_taken(work.views);
  work.plan.tour = tour_of(work.views, cell);
  check_legs(work.plan.tour, cell, speed_share);
  if (source.plan && !source.is_plan_free) {
    check_free(work.views, source, cell);
  }
  if (source.scene) {
    work.num_positions = set_scan(*source.scene, cell, work.steps);
  }
  if (cell.stage && cell.stage->positions > 0) {
    work.num_positions = cell.stage->positions;
  }
  check_stage(work, cell);
  work.plan.tasks = tasks_of(work.views, work.plan.tour, source, cell, work.num_positions);
  check_names(work.plan.tasks);
  work.plan.camera = camera_configuration_of(camera_of(cell));
  work.digest = plan_digest(work, source, cell);
  work.grounds = picture_grounds(scene_of(source), cell);
  return work;
}

PoseSigma pose_sigma_of(ArmModel model) {
  // Universal Robots, data sheets: +-0.1 mm and 500 mm (UR3), +-0.03 mm and 500 mm (UR3e), +-0.03
  // mm and 850 mm (UR5e).
  const double repeatability_mm = model == ArmModel::kUr3 ? 0.1 : 0.03;
  const double reach_mm = model == ArmModel::kUr5e ? 850.0 : 500.0;
  const double sigma_mm = repeatability_mm / 3.0;
  return {.position_mm = sigma_mm, .rotation_rad = sigma_mm / (0.5 * reach_mm)};
}

}  // namespace glint

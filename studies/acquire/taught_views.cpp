// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/acquire/taught_views.h"

#include <algorithm>

#include <fmt/format.h>

#include "hardware/planning/route_map.h"
#include "hardware/robot/path_check.h"
#include "studies/reach/scene_cell.h"

namespace glint {
namespace {

bool is_in_joint_limits(const PlanningCell& cell, const JointVector& joints_rad) {
  return (joints_rad.array() >= cell.joint_min_rad.array()).all() &&
         (joints_rad.array() <= cell.joint_max_rad.array()).all();
}

/// The views one after the other, each by the joints that the cell's file has.
class TaughtViews {
 public:
  TaughtViews(const Cell& cell, double speed_share, const SceneSettings* scene)
      : planned_(planning_cell(cell, scene)),
        clearance_(planned_),
        routes_(planned_, clearance_),
        share_(speed_share) {
    if (!routes_.has_home()) {
      throw ConfigError(fmt::format("{}: {}", cell.file.string(), routes_.problem()));
    }
    at_ = routes_.home();
    at_name_ = home_name();
  }

  ViewPlan plan(const std::vector<CellPosition>& views) {
    for (std::size_t i = 0; i < views.size(); ++i) {
      PlannedView view = {
          .name = views[i].name.empty() ? fmt::format("view_{}", i + 1) : views[i].name,
          .joints_rad = Eigen::Map<const JointVector>(views[i].joints_rad.data())};
      view.base_from_flange = planned_.arm.arm.forward(view.joints_rad);
      judge(view);
      if (view.outcome == ViewOutcome::kPlanned) {
        go_to(view);
      }
      plan_.views.push_back(std::move(view));
    }
    if (!plan_.paths.empty()) {
      add_path(*routes_.route(at_, routes_.home()), home_name());
    }
    return std::move(plan_);
  }

 private:
  std::string home_name() const {
    return routes_.home_name().empty() ? "safe position" : routes_.home_name();
  }

  void judge(PlannedView& view) const {
    const Clearance there = clearance_.at(view.joints_rad);
    view.margin_mm = there.margin_mm;
    view.reason = there.text;
    if (!is_in_joint_limits(planned_, view.joints_rad)) {
      view.outcome = ViewOutcome::kJointLimit;
      view.reason = "joints are beyond [planning] joint_min_deg or joint_max_deg";
    } else if (!there.is_free()) {
      view.outcome =
          there.touch == Clearance::Touch::kBox ? ViewOutcome::kBox : ViewOutcome::kCollision;
    }
  }

  /// Where there is a way there, and one from there to the safe position: any view may be the last.
  void go_to(PlannedView& view) {
    const std::size_t node = routes_.legs().add(view.joints_rad);
    const auto route = routes_.route(at_, node);
    if (route && routes_.route(node, routes_.home())) {
      add_path(*route, view.name);
      at_ = node;
      at_name_ = view.name;
    } else {
      view.outcome = ViewOutcome::kNoPath;
      view.reason = route ? routes_.legs().leg(node, routes_.home()).text
                          : routes_.legs().leg(at_, node).text;
    }
  }

  void add_path(const Route& route, const std::string& to) {
    PlannedPath path = {.from = at_name_, .to = to, .margin_mm = route.margin_mm};
    for (const std::size_t node : route.nodes) {
      path.joints_rad.push_back(routes_.legs().joints_rad(node));
    }
    for (std::size_t i = 1; i < path.joints_rad.size(); ++i) {
      path.duration_s +=
          check_joint_motion(planned_.arm, path.joints_rad[i - 1], path.joints_rad[i], share_)
              .duration_s;
    }
    plan_.paths.push_back(std::move(path));
  }

  PlanningCell planned_;
  ClearanceCheck clearance_;
  RouteMap routes_;
  double share_;
  std::size_t at_ = 0;  ///< node where the arm stands
  std::string at_name_;
  ViewPlan plan_;
};

}  // namespace

ViewPlan plan_of_cell_views(const Cell& cell, double speed_share, const SceneSettings* scene) {
  return TaughtViews(cell, speed_share, scene).plan(cell.views);
}

}  // namespace glint

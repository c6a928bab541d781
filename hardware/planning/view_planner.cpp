// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/planning/view_planner.h"

#include <algorithm>
#include <limits>

#include "hardware/planning/nearest_view.h"
#include "hardware/planning/tour.h"
#include "hardware/planning/view_stops.h"

namespace glint {
namespace {

constexpr std::size_t kChoices = 2;  ///< branches of a view that a tour may choose from
constexpr int kRounds = 8;

class Planner {
 public:
  Planner(const PlanningCell& cell, std::span<const ViewRequest> views, const PlanOptions& options)
      : cell_(cell),
        views_(views),
        options_(options),
        clearance_(cell),
        routes_(cell, clearance_) {}

  ViewPlan plan() {
    for (const ViewRequest& view : views_) {
      add_view(view);
    }
    if (options_.has_tour && !planned_.empty()) {
      seek_tour();
      add_paths();
    }
    for (std::size_t i = 0; i < planned_.size(); ++i) {
      take_choice(planned_[i], choice_[i]);
    }
    add_reach();
    return std::move(plan_);
  }

  std::int64_t num_queries() const { return clearance_.num_queries(); }

 private:
  /// The camera in the frame of what stands still before it: the base, or the flange that holds the
  /// part up to it.
  static const Eigen::Isometry3d& pose_of(const ViewRequest& request) {
    return request.flange_from_camera ? *request.flange_from_camera : request.base_from_camera;
  }

  /// base_from_flange for a pose of that kind.
  Eigen::Isometry3d flange_of(const ViewRequest& request, const Eigen::Isometry3d& pose) const {
    return request.flange_from_camera ? request.base_from_camera * pose.inverse()
                                      : pose * cell_.flange_from_camera.inverse();
  }

  void add_nearest(const ViewRequest& request, PlannedView& view) {
    const auto nearest =
        nearest_view(pose_of(request), request.target_mm, [this, &request](const auto& pose) {
          return find_stop(cell_, clearance_, routes_, flange_of(request, pose), 1).outcome ==
                 ViewOutcome::kPlanned;
        });
    if (nearest && request.flange_from_camera) {
      view.nearest_base_from_flange = flange_of(request, *nearest);
    } else {
      view.nearest_base_from_camera = nearest;
    }
  }

  void add_view(const ViewRequest& request) {
    PlannedView view = {.name = request.name,
                        .base_from_camera = request.base_from_camera,
                        .base_from_flange = flange_of(request, pose_of(request))};
    Stop stop = find_stop(cell_, clearance_, routes_, view.base_from_flange, kChoices);
    view.outcome = stop.outcome;
    view.reason = std::move(stop.reason);
    if (view.outcome == ViewOutcome::kPlanned) {
      planned_.push_back(plan_.views.size());
      choice_.push_back(0);
    } else if (options_.has_nearest && routes_.has_home()) {
      add_nearest(request, view);
    }
    stops_.push_back(std::move(stop));
    plan_.views.push_back(std::move(view));
  }

  /// The node at a place of the tour: 0 is home, i is the i-th planned view.
  std::size_t node_of(std::size_t place) const {
    return place == 0 ? routes_.home()
                      : stops_[planned_[place - 1]].choices[choice_[place - 1]].node;
  }

  Eigen::MatrixXd durations() {
    const auto count = static_cast<Eigen::Index>(planned_.size()) + 1;
    Eigen::MatrixXd costs = Eigen::MatrixXd::Zero(count, count);
    for (Eigen::Index a = 0; a < count; ++a) {
      for (Eigen::Index b = 0; b < a; ++b) {
        costs(a, b) = routes_.optimistic_s(node_of(static_cast<std::size_t>(a)),
                                           node_of(static_cast<std::size_t>(b)));
        costs(b, a) = costs(a, b);
      }
    }
    return costs;
  }

  /// The cheapest branches for the order.
  void choose_branches() {
    std::vector<std::size_t> counts;
    for (const std::size_t place : order_) {
      counts.push_back(stops_[planned_[place - 1]].choices.size());
    }
    const auto node = [this](std::size_t i, std::size_t choice) {
      return i == order_.size() ? routes_.home()
                                : stops_[planned_[order_[i] - 1]].choices[choice].node;
    };
    const std::vector<std::size_t> chosen =
        cheapest_choices(counts, [&](std::size_t i, std::size_t a, std::size_t b) {
          const std::size_t from = i == 0 ? routes_.home() : node(i - 1, a);
          return routes_.optimistic_s(from, node(i, b));
        });
    for (std::size_t i = 0; i < order_.size(); ++i) {
      choice_[order_[i] - 1] = chosen[i];
    }
  }

  /// @return all ways of the tour had been looked at before
  bool look_at_tour() {
    bool is_known = true;
    for (std::size_t i = 0; i <= order_.size(); ++i) {
      const std::size_t from = node_of(i == 0 ? 0 : order_[i - 1]);
      const std::size_t to = node_of(i == order_.size() ? 0 : order_[i]);
      const double expected_s = routes_.optimistic_s(from, to);
      const std::optional<Route> route = routes_.route(from, to);
      is_known = is_known && route && route->duration_s <= kLonger * expected_s;
    }
    return is_known;
  }

  void seek_tour() {
    double min_s = kNoWay_s;
    std::vector<std::size_t> best_order;
    std::vector<std::size_t> best_choice;
    for (int round = 0; round < kRounds; ++round) {
      order_ = short_tour(durations());
      choose_branches();
      const bool is_known = look_at_tour();
      const double duration_s = tour_cost(durations(), order_);
      if (duration_s < min_s) {
        min_s = duration_s;
        best_order = order_;
        best_choice = choice_;
      }
      if (is_known) {
        break;
      }
    }
    order_ = std::move(best_order);
    choice_ = std::move(best_choice);
  }

  std::string name_of_place(std::size_t place) const {
    return place == 0 ? routes_.home_name() : plan_.views[planned_[place - 1]].name;
  }

  void add_paths() {
    for (std::size_t i = 0; i <= order_.size(); ++i) {
      const std::size_t from = i == 0 ? 0 : order_[i - 1];
      const std::size_t to = i == order_.size() ? 0 : order_[i];
      const std::optional<Route> route = routes_.route(node_of(from), node_of(to));
      PlannedPath path = {.from = name_of_place(from), .to = name_of_place(to)};
      for (const std::size_t node : route->nodes) {
        path.joints_rad.push_back(routes_.legs().joints_rad(node));
      }
      path.margin_mm = route->margin_mm;
      path.duration_s = route->duration_s;
      plan_.paths.push_back(std::move(path));
    }
  }

  void take_choice(std::size_t view, std::size_t choice) {
    const StopChoice& chosen = stops_[view].choices[choice];
    plan_.views[view].joints_rad = routes_.legs().joints_rad(chosen.node);
    plan_.views[view].margin_mm = chosen.margin_mm;
    plan_.views[view].singularity = chosen.singularity;
  }

  void add_reach() {
    if (planned_.empty()) {
      return;
    }
    plan_.reach_share =
        static_cast<double>(planned_.size()) / static_cast<double>(plan_.views.size());
    double margin_mm = kNoWay_s;
    for (const std::size_t view : planned_) {
      margin_mm = std::min(margin_mm, plan_.views[view].margin_mm);
    }
    for (const PlannedPath& path : plan_.paths) {
      margin_mm = std::min(margin_mm, path.margin_mm);
    }
    plan_.reach_margin_mm = margin_mm;
  }

  static constexpr double kLonger = 1.05;  ///< an estimate that is that good need not be mended

  const PlanningCell& cell_;
  std::span<const ViewRequest> views_;
  PlanOptions options_;
  ClearanceCheck clearance_;
  RouteMap routes_;
  ViewPlan plan_;
  std::vector<Stop> stops_;           ///< of each view
  std::vector<std::size_t> planned_;  ///< views that are planned
  std::vector<std::size_t> choice_;   ///< of each of these
  std::vector<std::size_t> order_;    ///< 1 is the first of them
};

}  // namespace

ViewPlan plan_views(const PlanningCell& cell,
                    std::span<const ViewRequest> views,
                    const PlanOptions& options,
                    PlanEffort* effort) {
  Planner planner(cell, views, options);
  ViewPlan plan = planner.plan();
  if (effort != nullptr) {
    effort->distance_queries = planner.num_queries();
  }
  return plan;
}

}  // namespace glint

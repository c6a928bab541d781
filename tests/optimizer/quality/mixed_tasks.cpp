// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/optimizer/quality/mixed_tasks.h"

#include <cmath>
#include <utility>

namespace glint::quality {
namespace {

using Kind = Variable::Kind;

/// What a design misses, by variable.
struct Cost {
  Point optimum;                           ///< in the unit cube; of choices the index
  std::vector<std::vector<double>> added;  ///< of choices: by value, 0 at the optimum
  std::vector<double> shift;  ///< of numbers: of the best place, times the cost of the choices
};

double of_choices(const SearchSpace& space, const Cost& cost, const Point& point) {
  double sum = 0.0;
  for (std::size_t i = 0; i < point.size(); ++i) {
    if (space.variables[i].kind == Kind::kChoice && is_active(space, point, i)) {
      sum += cost.added[i][static_cast<std::size_t>(point[i])];
    }
  }
  return sum;
}

double of_design(const SearchSpace& space, const Cost& cost, const Point& point) {
  const double chosen = of_choices(space, cost, point);
  const std::vector<double> unit = unit_from_point(space, point);
  double sum = chosen;
  for (std::size_t i = 0; i < point.size(); ++i) {
    if (space.variables[i].kind != Kind::kChoice && is_active(space, point, i)) {
      const double away = unit[i] - cost.optimum[i] - cost.shift[i] * chosen;
      sum += 4.0 * away * away + 0.3 * std::abs(away);
    }
  }
  return sum;
}

/// A design that the space allows, so that the least value is 0 also where numbers are whole.
Cost random_cost(const SearchSpace& space, Rng& rng) {
  std::vector<double> unit(space.variables.size());
  for (double& value : unit) {
    value = rng.uniform(0.15, 0.85);
  }
  const Point best = point_from_unit(space, unit);
  Cost cost{.optimum = unit_from_point(space, best), .added = {}, .shift = {}};
  for (std::size_t i = 0; i < best.size(); ++i) {
    std::vector<double> added;
    for (std::size_t k = 0; k < space.variables[i].choices.size(); ++k) {
      const double more = rng.uniform(0.2, 0.6);
      added.push_back(static_cast<double>(k) == best[i] ? 0.0 : more);
    }
    cost.added.push_back(std::move(added));
    cost.shift.push_back(rng.uniform(-0.3, 0.3));
  }
  return cost;
}

Variable only_for(const char* name, const char* of, const char* value) {
  return {.name = name, .when_name = of, .when_value = value};
}

}  // namespace

SearchSpace kinds_space() {
  return {{{.name = "kind", .kind = Kind::kChoice, .choices = {"ring", "bar", "dome"}},
           {.name = "count", .kind = Kind::kInteger, .low = 1.0, .high = 8.0},
           {.name = "height", .low = 20.0, .high = 200.0, .is_log = true},
           only_for("ring_radius", "kind", "ring"),
           only_for("ring_tilt", "kind", "ring"),
           only_for("bar_length", "kind", "bar"),
           only_for("bar_angle", "kind", "bar"),
           only_for("dome_radius", "kind", "dome"),
           only_for("dome_opening", "kind", "dome")}};
}

SearchSpace nested_space() {
  Variable lens = only_for("lens", "source", "narrow");
  lens.kind = Kind::kChoice;
  lens.choices = {"none", "tele", "macro"};
  Variable tilt = only_for("tilt", "lens", "tele");
  tilt.when_others = {"macro"};
  return {{{.name = "source", .kind = Kind::kChoice, .choices = {"wide", "narrow"}},
           {.name = "steps", .kind = Kind::kInteger, .low = 2.0, .high = 9.0},
           {.name = "height"},
           {.name = "angle"},
           std::move(lens),
           std::move(tilt),
           only_for("focus", "lens", "macro")}};
}

Task mixed_task(const SearchSpace& space, Rng& rng) {
  Task task;
  task.space = space;
  task.truth = [space, cost = random_cost(space, rng)](const std::vector<double>& x) {
    return std::vector<double>{of_design(space, cost, x)};
  };
  return task;
}

}  // namespace glint::quality

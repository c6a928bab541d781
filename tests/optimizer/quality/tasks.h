// SPDX-License-Identifier: GPL-3.0-or-later
//
// Test tasks with known optima, for comparing searches: noisy functions of one objective that
// resemble lighting studies (rotated, many optima, kinks and steps), and fronts that are known.
//
// One objective: rastrigin8, rosen6, gallagher10, kinks12; the optimum, of value 0, lies at another
// place for each instance. Several: zdt1, zdt2 (E. Zitzler, K. Deb and L. Thiele, Evolutionary
// Computation 8, 2000), dtlz2 with three objectives (K. Deb et al., CEC 2002) and wfg4 (S. Huband
// et al., IEEE Trans. Evol. Comput. 10, 2006), all in ten variables. Mixed, with one objective
// whose optimum is 0: kinds (of light, with variables of their own) and nested (conditions two
// deep).
#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "optimizer/problem/space.h"

namespace glint::quality {

/// Minimised over its space; the unit cube unless it is mixed.
struct Task {
  std::string name;
  SearchSpace space;
  int num_objectives = 1;
  std::function<std::vector<double>(const std::vector<double>&)> truth;
  /// Of several objectives: where the hypervolume is measured from, and that of the whole front.
  std::vector<double> reference;
  double full_volume = 1.0;
  std::vector<double> spread;  ///< standard deviation of each objective over random points
  double median = 1.0;         ///< of the first objective over random points
};

std::vector<std::string_view> tasks_of_one_objective();
std::vector<std::string_view> tasks_of_several_objectives();
/// Of one objective, with choices, integers and variables that are active for some choices only.
std::vector<std::string_view> mixed_tasks();

/// @param instance  moves the optimum of tasks with one objective
Task make_task(std::string_view name, int instance);

}  // namespace glint::quality

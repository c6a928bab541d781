// SPDX-License-Identifier: GPL-3.0-or-later
//
// Search by a Gaussian process: a Sobol design, then always the design that promises most.
//
// - One model per objective and per limit, and one of success once an evaluation has failed.
// - Designs that are asked and not told yet count as told what the models expect of them.
// - The models' parameters are chosen anew when a quarter more has been told, in between data are
//   added. Beyond 800 told designs the models know at most 800 of them: the best, and others evenly
//   in the order of telling.
// - No design is asked twice, so a finite space ends.
//
// What is asked depends on what was told and asked before, the seed and nothing else.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <vector>

#include "optimizer/algorithm/acquisition.h"
#include "optimizer/algorithm/algorithm.h"
#include "optimizer/algorithm/sobol.h"

namespace glint {

struct GaussianSearchPlan {
  std::uint64_t seed = 1;
  bool is_noisy = false;
  int num_design = 8;  ///< points asked before the first model, start points included
  int num_limits = 0;
  int num_objectives = 1;
};

class GaussianSearch final : public Algorithm {
 public:
  /// @param start_points  canonical
  GaussianSearch(const SearchSpace& space,
                 const GaussianSearchPlan& plan,
                 std::vector<Point> start_points);

  std::optional<Point> ask() override;
  using Algorithm::tell;
  void tell(const Point& point, const Answer& answer) override;

 private:
  struct Told {
    Point point;
    std::vector<double> values;  ///< objectives, then limits; empty: failed
    std::vector<double> errors;  ///< of values; NaN: not known
    double merit = 0.0;
  };

  std::optional<Point> next_point();
  std::optional<Point> fresh_sobol_point();
  std::optional<Point> promising_point();
  void update_models();
  void refit();
  std::vector<std::size_t> told_to_model() const;
  void add_to_models(const Told& told);
  std::vector<GaussianProcess> models_with_pending() const;
  std::vector<Point> first_candidates(const Point& best, Rng& rng) const;
  Point neighbour(const Point& point, double width, bool is_sparse, Rng& rng) const;

  SearchSpace space_;
  GaussianSearchPlan plan_;
  Sobol sobol_;
  std::deque<Point> design_;
  std::vector<Point> pending_;
  std::set<Point> asked_;
  std::vector<Told> told_;
  std::size_t num_succeeded_ = 0;
  std::vector<GaussianProcess> models_;  ///< objectives, limits, success
  std::vector<Point> model_points_;      ///< of the objectives' models, in their order
  std::size_t num_in_models_ = 0;        ///< of told_
  std::size_t next_refit_ = 0;
  std::uint32_t next_sobol_ = 0;
  std::uint64_t num_asks_ = 0;
};

}  // namespace glint

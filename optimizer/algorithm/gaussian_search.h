// SPDX-License-Identifier: GPL-3.0-or-later
//
// Search by a Gaussian process: a Sobol design, then always the design that promises most.
//
// - One model per objective and per limit, and one of success once an evaluation has failed.
// - What promises most is told by proposal.h and promise.h; by rules 1 (SearchSettings::rules) by
//   acquisition.h and random candidates.
// - Designs that are asked and not told yet count as told what the models expect of them.
// - The models' parameters are chosen anew when a quarter more has been told, in between data are
//   added. Beyond 800 told designs the models know at most 800 of them: of several objectives (by
//   rules 6) the front, the best, and others evenly in the order of telling. The first time is
//   noted in the log.
// - With derivatives (GaussianSearchPlan::takes_derivatives) models know those of designs near the
// best
//   one, 300 in all; which contradict the rest is found by leaving each out.
// - No design is asked twice, so a finite space ends.
//
// What is asked depends on what was told and asked before, the seed and nothing else. By rules 2
// the parameters are told as kModel events: with them the state is rebuilt without choosing any.
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <set>
#include <vector>

#include "optimizer/algorithm/acquisition.h"
#include "optimizer/algorithm/algorithm.h"
#include "optimizer/algorithm/exact_values.h"
#include "optimizer/algorithm/sobol.h"
#include "optimizer/algorithm/told_designs.h"

namespace glint {

struct GaussianSearchPlan {
  std::uint64_t seed = 1;
  bool is_noisy = false;
  int num_design = 8;  ///< points asked before the first model, start points included
  int num_limits = 0;
  int num_objectives = 1;
  std::vector<double> reference = {};  ///< of several objectives, NaN where not given; or empty
  ExactValues exact = {};              ///< of rules 3 and later
  bool takes_derivatives = false;      ///< of one objective: derivatives are observed, too
  int rules = kSearchRules;
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

  bool can_restore() const override { return plan_.rules > 1; }

  void restore_ask(const Point& point) override;
  void restore_model(std::span<const double> parameters) override;
  std::vector<std::vector<Expectation>> expected_objectives() override;
  std::vector<std::vector<Expectation>> expected_limits() override;

 private:
  /// The models' parameters were chosen when so many were told.
  struct Fit {
    std::size_t num_told = 0;
    std::vector<KernelParameters> parameters;  ///< of models_
  };

  bool is_designing() const;
  std::optional<Point> next_point();
  std::optional<Point> fresh_sobol_point();
  std::optional<Point> promising_point(std::span<const GaussianProcess> models, Rng& rng);
  std::optional<Point> scalarised_point(std::span<const GaussianProcess> models, Rng& rng);
  std::vector<double> reference() const;
  std::vector<std::vector<Expectation>> expected_values(int first, int count);
  /// Of the answer to a design: value, error and derivatives of a limit as its model knows them.
  void add_limit(const Answer& answer, std::size_t i, ToldDesign& told) const;
  void update_models();
  void refit();

  /// Of how many objectives the models keep the front.
  std::size_t num_front() const {
    const bool is_kept = plan_.rules > 5 && plan_.num_objectives > 1;
    return is_kept ? static_cast<std::size_t>(plan_.num_objectives) : 0;
  }

  void note_subset(std::size_t num_known, std::size_t num_told);
  void rebuild(const Fit& fit);
  int set_with_derivatives(const ModelData& data, const std::vector<KernelParameters>& parameters);
  void note_fit(std::size_t num_told);
  void add_models(bool has_failures);
  void add_to_models(const ToldDesign& told);
  std::vector<GaussianProcess> models_with_pending() const;
  std::vector<Point> known_points() const;
  std::vector<Point> first_candidates(const Point& best, Rng& rng) const;

  SearchSpace space_;
  GaussianSearchPlan plan_;
  Sobol sobol_;
  std::deque<Point> design_;
  std::vector<Point> pending_;
  std::set<Point> asked_;
  std::vector<ToldDesign> told_;
  std::size_t num_succeeded_ = 0;
  std::vector<GaussianProcess> models_;  ///< objectives, limits, success
  std::optional<Fit> restored_;          ///< parameters that models_ do not have yet
  std::vector<Point> model_points_;      ///< of the objectives' models, in their order
  std::size_t num_in_models_ = 0;        ///< of told_
  std::size_t next_refit_ = 0;
  bool is_subset_ = false;   ///< whether the models were last chosen to know a part of told_
  int max_derivatives_ = 0;  ///< derivatives that a model may know
  std::uint32_t next_sobol_ = 0;
  std::uint64_t num_asks_ = 0;
};

}  // namespace glint

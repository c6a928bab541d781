// SPDX-License-Identifier: GPL-3.0-or-later
//
// How a modelled score answers to one or two variables of a branch.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "optimizer/surrogate/gaussian_process.h"
#include "studies/analysis/branches.h"
#include "studies/analysis/score_model.h"

namespace glint {

/// Refers to what it is made of.
class ResponseModel {
 public:
  /// @param model  fitted
  /// @param best   a design of the branch
  ResponseModel(const GaussianProcess& model,
                const SearchSpace& space,
                const Branch& branch,
                std::optional<Point> best);

  /// @param k  index into branch.free
  Response over(std::size_t k) const;

  /// Over the two variables with the largest total indices.
  /// @param importance  one per free variable, at least two
  ResponseMap over_pair(std::span<const Importance> importance) const;

 private:
  /// The average over even values of all variables that `place` leaves open (NaN).
  Band average_at(const std::vector<double>& place, int count) const;

  const GaussianProcess& model_;
  const SearchSpace& space_;
  const Branch& branch_;
  std::optional<Point> best_;
};

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// By how much a design with uncertain objectives is expected to increase the hypervolume of a
// front (expected hypervolume improvement), exactly: the region that no design of the front
// dominates is cut into boxes, and in each of them the expectation is a product over the
// objectives (M. Emmerich, K. Yang et al., "A multicriteria generalization of bayesian global
// optimization", 2016; the cutting, one objective after the other, is our own).
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace glint {

class ExpectedHypervolume {
 public:
  /// All objectives are minimised.
  /// @param front      rows of objectives; those that are dominated or not better than the
  ///                   reference in every objective add nothing
  /// @param reference  one number per objective, at least one
  ExpectedHypervolume(std::span<const std::vector<double>> front, std::vector<double> reference);

  /// An expectation and its derivatives, one number per objective.
  struct Gain {
    double value = 0.0;
    std::vector<double> by_mean;
    std::vector<double> by_sigma;
  };

  /// Of a design whose objectives are normal and independent. @param sigmas  > 0
  Gain gain(std::span<const double> means, std::span<const double> sigmas) const;
  /// The value alone, at a third of the cost.
  double value(std::span<const double> means, std::span<const double> sigmas) const;

  std::size_t num_boxes() const { return boxes_.size() / (2 * reference_.size()); }

 private:
  void cut(std::span<const std::size_t> rows, std::size_t num_objectives, std::vector<int>& box);
  void fill_excesses(std::span<const double> means,
                     std::span<const double> sigmas,
                     std::vector<double>& excesses) const;

  std::vector<std::vector<double>> front_;
  std::vector<double> reference_;
  /// For each objective the borders of boxes, ascending, the reference last.
  std::vector<std::vector<double>> borders_;
  std::vector<std::vector<int>> border_of_;  ///< of each row of the front, by objective
  /// For each box and objective: index of its lower border, -1 for none, and of its upper one.
  std::vector<int> boxes_;
};

/// The rows of a front, at most `count` of them, that keep its extremes and spread evenly: each
/// next one is farthest from those taken, objectives in parts of their range. Ascending indices.
std::vector<std::size_t> spread_rows(std::span<const std::vector<double>> rows, std::size_t count);

}  // namespace glint

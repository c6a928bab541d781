// SPDX-License-Identifier: GPL-3.0-or-later
//
// How promising a design is: the expected improvement on the best expected design, times the
// probability that all limits hold; as a logarithm, so that hopeless designs can be compared, too.
//
// One objective: closed form (D. Jones, M. Schonlau and W. Welch, "Efficient global optimization of
// expensive black-box functions", J. Global Optim. 13, 1998). Several: of the augmented Chebyshev
// sum with the weights of this question (J. Knowles, "ParEGO", IEEE Trans. Evol. Comput. 10, 2006),
// over the same normal draws for all designs.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/rng.h"
#include "optimizer/surrogate/gaussian_process.h"

namespace glint {

/// log(E[max(0, best - f)]) for f normal; sigma > 0.
double log_expected_improvement(double best, double mean, double sigma);
/// log of the probability that a standard normal number is below z.
double log_normal_probability(double z);

class Acquisition {
 public:
  /// @param models          of the objectives, then of what must be at most 0
  /// @param num_objectives  >= 1
  /// @param low, high       of the objectives so far: they put them on one scale
  /// @param rng             draws weights and normals when there are several objectives
  Acquisition(std::span<const GaussianProcess> models,
              int num_objectives,
              std::vector<double> low,
              std::vector<double> high,
              Rng& rng);

  /// One per encoded row; larger is better.
  Eigen::VectorXd scores(const Eigen::MatrixXd& rows) const;

  /// Which of the points that the first model knows is expected to be the best.
  Eigen::Index best_point() const { return best_point_; }

 private:
  double combined(std::span<const double> objectives) const;
  void find_best(Eigen::Index num_points);
  void add_improvement(const Eigen::MatrixXd& rows, Eigen::VectorXd& scores) const;

  std::span<const GaussianProcess> models_;
  std::size_t num_objectives_;
  std::vector<double> low_;
  std::vector<double> high_;
  std::vector<double> weights_;
  Eigen::MatrixXd normals_;  ///< one row per draw, one column per objective
  double best_ = 0.0;
  Eigen::Index best_point_ = 0;
  bool has_feasible_ = false;
};

}  // namespace glint

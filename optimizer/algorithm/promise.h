// SPDX-License-Identifier: GPL-3.0-or-later
//
// How promising a design is, by rules 2 (SearchSettings::rules), as a logarithm with its
// derivatives.
//
// One objective: the expected improvement on the best expected design (D. Jones, M. Schonlau and
// W. Welch, J. Global Optim. 13, 1998). Several: the expected gain of hypervolume beyond the front
// of the expected designs, exactly (optimizer/front/expected_hypervolume.h). Times the probability
// that all limits hold; while no design is expected to keep them, that probability alone.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "optimizer/front/expected_hypervolume.h"
#include "optimizer/surrogate/gaussian_process.h"

namespace glint {

class Promise {
 public:
  /// @param models     of the objectives, then of what must be at most 0; must outlive this
  /// @param reference  of several objectives, one number each; empty: there is one
  /// @param is_exact   which models stand for values that follow from a design alone: what they
  ///                   were told is taken as it is; may be shorter
  Promise(std::span<const GaussianProcess> models,
          std::vector<double> reference,
          std::vector<bool> is_exact = {});

  /// One per encoded row; larger is better.
  Eigen::VectorXd scores(const Eigen::MatrixXd& rows) const;
  /// The same with values that are known without error.
  /// @param exact  one row per row; a column for each of the first models, NaN where it is not
  /// known
  Eigen::VectorXd scores_knowing(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& exact) const;

  /// How far exact values are from the models' means: shaped as `exact`, 0 where not known.
  Eigen::MatrixXd shifts(const Eigen::MatrixXd& rows, const Eigen::MatrixXd& exact) const;
  /// By the models, their means shifted.
  /// @param shifts  as shifts(); may have no columns
  /// @param derivatives  becomes the derivatives by the encoded columns, one row per row
  Eigen::VectorXd scores(const Eigen::MatrixXd& rows,
                         const Eigen::MatrixXd& shifts,
                         Eigen::MatrixXd& derivatives) const;

  /// Which of the points that the first model knows are expected to be the best, or of several
  /// objectives on the front; at least one.
  const std::vector<std::size_t>& best_points() const { return best_points_; }

 private:
  Eigen::VectorXd scores_of(const std::vector<Eigen::MatrixX2d>& expected) const;
  void find_best(const std::vector<Eigen::VectorXd>& means);
  void find_front(const std::vector<Eigen::VectorXd>& means);
  std::vector<std::size_t> expected_feasible(const std::vector<Eigen::VectorXd>& means) const;

  std::span<const GaussianProcess> models_;
  std::size_t num_objectives_ = 1;
  std::vector<double> reference_;
  std::vector<std::size_t> best_points_;
  double best_ = 0.0;                          ///< of one objective
  std::vector<double> ideal_;                  ///< of several: objectives are told in parts of
  std::vector<double> range_;                  ///< the way from it to the reference
  std::unique_ptr<ExpectedHypervolume> gain_;  ///< of several
  bool has_feasible_ = false;
};

}  // namespace glint

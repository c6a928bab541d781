// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a fit of grey values may change, and how grey values follow. Private to the room.
#pragma once

#include <compare>
#include <cstddef>
#include <map>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "studies/validate/grey_model.h"

namespace glint::validate_detail {

/// Numbers that are freed together.
struct GreyTerm {
  GreyFault fault = GreyFault::kExposure;
  std::size_t of = 0;  ///< index of the light; of kLightPower the design

  // NOLINTNEXTLINE(modernize-use-nullptr): there is no null
  auto operator<=>(const GreyTerm&) const = default;
};

/// Where a fit stands.
struct GreyState {
  double exposure = 1.0;
  Eigen::VectorXd powers;               ///< of the lights of each design, minus 1
  Eigen::VectorXd segments;             ///< power of each minus 1
  std::vector<Eigen::Vector3d> places;  ///< of each light, mm
  double roughness = 0.0;               ///< logarithm of the factor
};

/// A number of a term.
struct GreyNumber {
  GreyTerm term;
  int index = 0;  ///< of the segment, or of the axis x, y, z
};

/// Grey values of all pixels, or what is left of the real ones.
using GreyHalves = Halves<Eigen::VectorXd>;

/// Derivatives of all grey values by some numbers.
struct GreySystem {
  Halves<Eigen::MatrixXd> columns;
  std::vector<GreyNumber> numbers;  ///< of each column

  GreyHalves column(std::size_t i) const;

  void add(const GreyHalves& column, const GreyNumber& number);

  /// values + sign columns step.
  void change(GreyHalves& values, double sign, const Eigen::VectorXd& step) const;
};

/// Robust least squares of steps along derivatives, with the weights that what is left asks for.
class StepSolver {
 public:
  StepSolver(const GreySystem& system, const GreyHalves& left);

  /// The step to where nothing of these grey values is left.
  Eigen::VectorXd step(const GreyHalves& values) const;

  /// Of each number, by the noise of pixels.
  Eigen::VectorXd sigma() const;

 private:
  const GreySystem& system_;
  double noise_ = 0.0;
  Eigen::VectorXd weights_;
  Eigen::VectorXd shares_;   ///< of derivatives' products that are no noise, along the axes
  Eigen::MatrixXd vectors_;  ///< the axes; empty: black pictures
};

/// Robust least squares of a step to where nothing is left, without what the noise of derivatives
/// does to plain ones. @param sigma  of each number, if wanted
Eigen::VectorXd step_of(const GreySystem& system,
                        const GreyHalves& left,
                        Eigen::VectorXd* sigma = nullptr);

/// How badly a fit of so many numbers explains the pictures; without the noise that derivatives add
/// when steps are taken along them.
double score_of(const GreyHalves& left, std::size_t numbers);

/// The same of rendered pictures, whose noise is about the same in all of them.
double rendered_score(const GreyHalves& left, std::size_t numbers);

/// score_of() after a step along the derivatives, if grey values were linear.
double linear_score(const GreySystem& system, GreyHalves left);

/// Grey values and derivatives of a model, in shares of the mean real grey of each design.
class GreyProblem {
 public:
  GreyProblem(SceneStore& store, std::span<const GreyDesign> designs) : model_(store, designs) {}

  const GreyModel& model() const { return model_; }

  GreyState start();

  GreyHalves predicted(const GreyState& state, bool is_fine = false);

  /// All but kExposure that this scene has.
  std::vector<GreyTerm> terms();

  /// Derivatives at a state. Places and roughness cost renderings.
  GreySystem system_at(const GreyState& state, std::span<const GreyTerm> terms);

  /// About those of one term: places and roughness from where the fit began, so that all can be
  /// looked at for the price of one rendering a number.
  GreySystem rough_system(const GreyState& state, const GreyTerm& term);

  /// Each number that is not free, as designed, with the sigma that it would have if its term were
  /// freed beside those that are: by the noise of pixels alone, with rough derivatives. Infinite
  /// where the pictures do not change with it.
  /// @param free  derivatives by the free numbers at the state
  /// @param left  of the real grey values at the state
  std::vector<GreyValue> kept_values(const GreyState& state,
                                     const GreySystem& free,
                                     const GreyHalves& left);

  /// Derivatives of all grey values by a change of the camera. Costs a rendering.
  /// @param step  that the change is
  GreyHalves camera_derivative(const GreyState& state, const CameraChange& change, double step);

  /// A number of the state; changes from 0, exposure from 1.
  double& number(GreyState& state, const GreyNumber& number) const;

  /// Takes a step, kept within what can be. @return the largest one by place [mm]
  double take(const GreySystem& system, const Eigen::VectorXd& step, GreyState& state) const;

  /// All numbers of a term as the scene has them.
  void reset(GreyState& state, const GreyTerm& term) const;

 private:
  GreyModel::ColumnsPointer columns_of(const GreyState& state, bool is_fine = false);
  GreyHalves unexposed(const GreyState& state, bool is_fine = false);
  static GreyHalves grey_of(const Halves<GreyColumns>& all, const GreyState& state);
  Eigen::VectorXd exposure_of_rows(const GreyState& state) const;
  int size_of(const GreyTerm& term) const;
  void add_term(const GreyState& state, const GreyTerm& term, GreySystem& system);
  GreyHalves column(const GreyState& state, const GreyNumber& by);
  GreyHalves derivative(const GreyState& state, const GreyNumber& by);

  GreyModel model_;
  std::map<GreyTerm, std::vector<GreyHalves>> rough_;  ///< derivatives at the start, unexposed
};

}  // namespace glint::validate_detail

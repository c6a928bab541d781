// SPDX-License-Identifier: GPL-3.0-or-later
//
// Derivatives are differences of two noisy renderings, and the rendering that is taken off is the
// one that the real pictures are compared with: plain least squares find steps that are too small,
// and half of kStepMm at the true place where derivatives are all noise. So products are taken
// between two independent halves of the samples, as with instrumental variables.
#include "studies/validate/grey_terms.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

#include "core/median.h"

namespace glint::validate_detail {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kStepMm = 1.0;          ///< of the differences by place
constexpr double kStepRoughness = 0.05;  ///< and by the logarithm of roughness
constexpr double kLongestStepMm = 15.0;
constexpr double kLongestStepRoughness = 0.4;
constexpr double kPowerFloor = -1.0;  ///< against nominal: dark
constexpr double kExposureFloor = 0.05;

constexpr double kHuber = 2.5;
constexpr double kPixelsAlike = 10.0;   ///< neighbours tell about the same
constexpr double kPrice = 14.0;         ///< 3.7 standard deviations for each number
constexpr double kFloor = 0.003;        ///< of the mean grey: no model is better
constexpr double kMinShare = 0.1;       ///< of derivatives' products that is no noise
constexpr double kUnknownShare = 1e-3;  ///< likewise for sigma: nothing is known

bool needs_rendering(GreyFault fault) {
  return fault == GreyFault::kLightPlace || fault == GreyFault::kRoughness;
}

GreyHalves times(GreyHalves values, const VectorXd& factors) {
  for (VectorXd& half : values) {
    half = half.cwiseProduct(factors);
  }
  return values;
}

double median_size(const VectorXd& values) {
  std::vector<double> sizes(static_cast<std::size_t>(values.size()));
  for (Index i = 0; i < values.size(); ++i) {
    sizes[static_cast<std::size_t>(i)] = std::abs(values[i]);
  }
  return 1.4826 * median(std::move(sizes));
}

/// Robust weights of pixels.
VectorXd weights_of(const VectorXd& left, double noise) {
  return left.unaryExpr(
      [&](double value) { return 1.0 / std::max(1.0, std::abs(value) / (kHuber * noise)); });
}

/// Of the largest square of derivatives.
double wish_for(bool is_segment) {
  return is_segment ? 1e-4 : 1e-9;
}

/// A weak wish for small steps keeps apart what the pictures cannot: exposure and the powers of all
/// segments together.
void add_wish(const GreySystem& system, MatrixXd& normal) {
  const double scale = normal.diagonal().maxCoeff();
  for (Index i = 0; i < normal.rows(); ++i) {
    const bool is_segment =
        system.numbers[static_cast<std::size_t>(i)].term.fault == GreyFault::kSegments;
    normal(i, i) += wish_for(is_segment) * scale;
  }
}

/// Mean square, where large ones count less; of two halves their product, which is free of the
/// noise that derivatives add when steps are taken along them.
double robust_square(const GreyHalves& left) {
  const VectorXd mean = mean_of(left);
  const double noise = std::max(median_size(mean), kFloor);
  double sum = 0.0;
  for (Index i = 0; i < mean.size(); ++i) {
    const double ratio = std::abs(mean[i]) / (4.0 * kHuber * noise);
    sum += left[0][i] * left[1][i] / std::max(1.0, ratio);
  }
  return std::max(0.0, sum / static_cast<double>(mean.size()));
}

}  // namespace

GreyHalves GreySystem::column(std::size_t i) const {
  const auto at = static_cast<Index>(i);
  return {columns[0].col(at), columns[1].col(at)};
}

void GreySystem::add(const GreyHalves& column, const GreyNumber& number) {
  for (std::size_t half = 0; half < 2; ++half) {
    MatrixXd& all = columns[half];
    all.conservativeResize(column[half].size(), all.cols() + 1);
    all.rightCols<1>() = column[half];
  }
  numbers.push_back(number);
}

void GreySystem::change(GreyHalves& values, double sign, const VectorXd& step) const {
  for (std::size_t half = 0; half < 2; ++half) {
    values[half] += sign * (columns[half] * step);
  }
}

/// Along the axes in which the products of noisy derivatives are 1, those between the halves are
/// the share of them that is no noise. A step is at most ten times that of plain least squares;
/// where it would be longer it is too short, and sigma says that the number is hardly known.
StepSolver::StepSolver(const GreySystem& system, const GreyHalves& left) : system_(system) {
  const VectorXd mean = mean_of(left);
  noise_ = std::max(median_size(mean), kFloor);
  weights_ = weights_of(mean, noise_);
  const auto weights = weights_.asDiagonal();
  const auto& [first, second] = system.columns;
  const MatrixXd derivatives = mean_of(system.columns);
  MatrixXd noisy = derivatives.transpose() * (weights * derivatives);
  const MatrixXd product = first.transpose() * (weights * second);
  MatrixXd normal = 0.5 * (product + product.transpose());
  add_wish(system, noisy);
  add_wish(system, normal);
  if (noisy.isZero(0.0)) {
    return;
  }
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> axes(normal, noisy);
  shares_ = axes.eigenvalues();
  vectors_ = axes.eigenvectors();
}

VectorXd StepSolver::step(const GreyHalves& values) const {
  const auto& [first, second] = system_.columns;
  if (vectors_.size() == 0) {
    return VectorXd::Zero(first.cols());
  }
  const auto weights = weights_.asDiagonal();
  const VectorXd wanted = 0.5 * (first.transpose() * (weights * values[1]) +
                                 second.transpose() * (weights * values[0]));
  const VectorXd by = shares_.cwiseMax(kMinShare).cwiseInverse();
  return vectors_ * by.cwiseProduct(vectors_.transpose() * wanted);
}

VectorXd StepSolver::sigma() const {
  if (vectors_.size() == 0) {
    return VectorXd::Constant(system_.columns[0].cols(), std::numeric_limits<double>::infinity());
  }
  const VectorXd unknown = shares_.cwiseMax(kUnknownShare).cwiseInverse();
  return noise_ * std::sqrt(kPixelsAlike) * (vectors_ * unknown.asDiagonal()).rowwise().norm();
}

VectorXd step_of(const GreySystem& system, const GreyHalves& left, VectorXd* sigma) {
  const StepSolver solver(system, left);
  if (sigma != nullptr) {
    *sigma = solver.sigma();
  }
  return solver.step(left);
}

double score_of(const GreyHalves& left, std::size_t numbers) {
  const double n = static_cast<double>(left[0].size()) / kPixelsAlike;
  return n * std::log(robust_square(left) + kFloor * kFloor) +
         kPrice * static_cast<double>(numbers);
}

double rendered_score(const GreyHalves& left, std::size_t numbers) {
  const VectorXd mean = mean_of(left);
  return score_of({mean, mean}, numbers);
}

double linear_score(const GreySystem& system, GreyHalves left) {
  for (int round = 0; round < 2; ++round) {
    system.change(left, -1.0, step_of(system, left));
  }
  return score_of(left, system.numbers.size());
}

GreyState GreyProblem::start() {
  GreyState state;
  state.places.assign(model_.lights().size(), Vector3d::Zero());
  state.powers = VectorXd::Zero(static_cast<Index>(model_.designs().size()));
  state.segments = VectorXd::Zero(columns_of(state)->front().segments.cols());
  return state;
}

GreyModel::ColumnsPointer GreyProblem::columns_of(const GreyState& state, bool is_fine) {
  return model_.columns(state.places, std::exp(state.roughness), is_fine);
}

GreyHalves GreyProblem::grey_of(const Halves<GreyColumns>& all, const GreyState& state) {
  GreyHalves grey;
  std::ranges::transform(all, grey.begin(), [&](const GreyColumns& columns) {
    VectorXd sum = columns.sum;
    if (state.segments.size() > 0) {
      sum += columns.segments * state.segments;
    }
    return sum;
  });
  return grey;
}

GreyHalves GreyProblem::unexposed(const GreyState& state, bool is_fine) {
  return grey_of(*columns_of(state, is_fine), state);
}

GreyHalves GreyProblem::camera_derivative(const GreyState& state,
                                          const CameraChange& change,
                                          double step) {
  GreyHalves derivatives =
      grey_of(model_.columns_by(change, state.places, std::exp(state.roughness)), state);
  const GreyHalves here = unexposed(state);
  for (std::size_t half = 0; half < 2; ++half) {
    derivatives[half] = (derivatives[half] - here[half]) / step;
  }
  return times(derivatives, exposure_of_rows(state));
}

VectorXd GreyProblem::exposure_of_rows(const GreyState& state) const {
  VectorXd exposure(model_.real().size());
  for (std::size_t d = 0; d < model_.designs().size(); ++d) {
    const GreyRows& rows = model_.rows(d);
    exposure.segment(rows.first, rows.count)
        .setConstant(state.exposure * (1.0 + state.powers[static_cast<Index>(d)]));
  }
  return exposure;
}

GreyHalves GreyProblem::predicted(const GreyState& state, bool is_fine) {
  return times(unexposed(state, is_fine), exposure_of_rows(state));
}

std::vector<GreyTerm> GreyProblem::terms() {
  std::vector<GreyTerm> terms;
  for (std::size_t l = 0; l < model_.lights().size(); ++l) {
    if (model_.lights()[l].segments > 1) {
      terms.push_back({.fault = GreyFault::kSegments, .of = l});
    }
    if (model_.lights()[l].can_move) {
      terms.push_back({.fault = GreyFault::kLightPlace, .of = l});
    }
  }
  for (std::size_t d = 0; model_.designs().size() > 1 && d < model_.designs().size(); ++d) {
    terms.push_back({.fault = GreyFault::kLightPower, .of = d});
  }
  if (model_.can_change_roughness()) {
    terms.push_back({.fault = GreyFault::kRoughness});
  }
  return terms;
}

int GreyProblem::size_of(const GreyTerm& term) const {
  return term.fault == GreyFault::kLightPlace ? 3
         : term.fault == GreyFault::kSegments ? model_.lights()[term.of].segments
                                              : 1;
}

double& GreyProblem::number(GreyState& state, const GreyNumber& number) const {
  switch (number.term.fault) {
    case GreyFault::kExposure:
      return state.exposure;
    case GreyFault::kLightPower:
      return state.powers[static_cast<Index>(number.term.of)];
    case GreyFault::kSegments:
      return state.segments[model_.first_segment(number.term.of) + number.index];
    case GreyFault::kLightPlace:
      return state.places[number.term.of][number.index];
    case GreyFault::kRoughness:
      break;
  }
  return state.roughness;
}

void GreyProblem::reset(GreyState& state, const GreyTerm& term) const {
  for (int i = 0; i < size_of(term); ++i) {
    number(state, {.term = term, .index = i}) = 0.0;
  }
}

/// Of the unexposed grey values by a place or the roughness.
GreyHalves GreyProblem::derivative(const GreyState& state, const GreyNumber& by) {
  const double step = by.term.fault == GreyFault::kLightPlace ? kStepMm : kStepRoughness;
  GreyState moved = state;
  number(moved, by) += step;
  GreyHalves derivatives = unexposed(moved);
  const GreyHalves here = unexposed(state);
  for (std::size_t half = 0; half < 2; ++half) {
    derivatives[half] = (derivatives[half] - here[half]) / step;
  }
  return derivatives;
}

/// Derivatives of the grey values by one number.
GreyHalves GreyProblem::column(const GreyState& state, const GreyNumber& by) {
  VectorXd factors = exposure_of_rows(state);
  switch (by.term.fault) {
    case GreyFault::kExposure:
      return times(unexposed(state), factors / state.exposure);
    case GreyFault::kLightPower: {
      const GreyRows& rows = model_.rows(by.term.of);
      factors.setZero();
      factors.segment(rows.first, rows.count).setConstant(state.exposure);
      return times(unexposed(state), factors);
    }
    case GreyFault::kSegments: {
      const Index segment = model_.first_segment(by.term.of) + by.index;
      const GreyModel::ColumnsPointer kept = columns_of(state);
      const Halves<GreyColumns>& columns = *kept;
      return times({columns[0].segments.col(segment), columns[1].segments.col(segment)}, factors);
    }
    case GreyFault::kLightPlace:
    case GreyFault::kRoughness:
      break;
  }
  return times(derivative(state, by), factors);
}

void GreyProblem::add_term(const GreyState& state, const GreyTerm& term, GreySystem& system) {
  for (int i = 0; i < size_of(term); ++i) {
    const GreyNumber number = {.term = term, .index = i};
    system.add(column(state, number), number);
  }
}

GreySystem GreyProblem::system_at(const GreyState& state, std::span<const GreyTerm> terms) {
  GreySystem system;
  for (const GreyTerm& term : terms) {
    add_term(state, term, system);
  }
  return system;
}

GreySystem GreyProblem::rough_system(const GreyState& state, const GreyTerm& term) {
  if (!needs_rendering(term.fault)) {
    return system_at(state, std::span(&term, 1));
  }
  auto known = rough_.find(term);
  if (known == rough_.end()) {
    const GreyState begin = start();
    std::vector<GreyHalves> derivatives;
    for (int i = 0; i < size_of(term); ++i) {
      derivatives.push_back(derivative(begin, {.term = term, .index = i}));
    }
    known = rough_.emplace(term, std::move(derivatives)).first;
  }
  GreySystem system;
  for (int i = 0; i < size_of(term); ++i) {
    system.add(times(known->second[static_cast<std::size_t>(i)], exposure_of_rows(state)),
               {.term = term, .index = i});
  }
  return system;
}

double GreyProblem::take(const GreySystem& system, const VectorXd& step, GreyState& state) const {
  double longest_mm = 0.0;
  for (Index i = 0; i < step.size(); ++i) {
    const GreyNumber& by = system.numbers[static_cast<std::size_t>(i)];
    double& value = number(state, by);
    switch (by.term.fault) {
      case GreyFault::kExposure:
        value = std::max(kExposureFloor, value + step[i]);
        break;
      case GreyFault::kLightPower:
      case GreyFault::kSegments:
        value = std::max(kPowerFloor, value + step[i]);
        break;
      case GreyFault::kLightPlace: {
        const double by_mm = std::clamp(step[i], -kLongestStepMm, kLongestStepMm);
        value += by_mm;
        longest_mm = std::max(longest_mm, std::abs(by_mm));
        break;
      }
      case GreyFault::kRoughness:
        value += std::clamp(step[i], -kLongestStepRoughness, kLongestStepRoughness);
        break;
    }
  }
  return longest_mm;
}

namespace {

std::string name_of_subject(const GreyModel& model, const GreyTerm& term) {
  switch (term.fault) {
    case GreyFault::kLightPower:
      return model.designs()[term.of];
    case GreyFault::kSegments:
    case GreyFault::kLightPlace:
      return model.lights()[term.of].name;
    default:
      return "";
  }
}

/// Whether the pictures change with a number by more than the weak wish of add_wish() for small
/// steps, which would else pass for knowledge of it.
bool is_seen(const GreySystem& system, Index i) {
  const VectorXd squares = mean_of(system.columns).colwise().squaredNorm();
  const bool is_segment =
      system.numbers[static_cast<std::size_t>(i)].term.fault == GreyFault::kSegments;
  return squares[i] > 10.0 * wish_for(is_segment) * squares.maxCoeff();
}

}  // namespace

std::vector<GreyValue> GreyProblem::kept_values(const GreyState& state,
                                                const GreySystem& free,
                                                const GreyHalves& left) {
  std::vector<GreyValue> values;
  for (const GreyTerm& term : terms()) {
    const bool is_free = std::ranges::any_of(
        free.numbers, [&term](const GreyNumber& number) { return number.term == term; });
    if (is_free) {
      continue;
    }
    GreySystem system = free;
    const GreySystem more = rough_system(state, term);
    for (std::size_t i = 0; i < more.numbers.size(); ++i) {
      system.add(more.column(i), more.numbers[i]);
    }
    Eigen::VectorXd sigma;
    step_of(system, left, &sigma);
    for (std::size_t i = 0; i < more.numbers.size(); ++i) {
      const auto at = static_cast<Index>(free.numbers.size() + i);
      values.push_back(
          {.fault = term.fault,
           .light = name_of_subject(model_, term),
           .index = more.numbers[i].index,
           .value = term.fault == GreyFault::kLightPlace ? 0.0 : 1.0,
           .sigma = is_seen(system, at) ? sigma[at] : std::numeric_limits<double>::infinity()});
    }
  }
  return values;
}

}  // namespace glint::validate_detail

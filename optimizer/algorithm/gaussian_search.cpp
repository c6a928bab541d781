// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/gaussian_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <span>
#include <utility>

#include "core/error.h"
#include "optimizer/algorithm/proposal.h"

namespace glint {

namespace {

constexpr int kNumGlobal = 200;
constexpr int kNumLocal = 200;
constexpr int kNumRefined = 60;
/// Of so many questions by rules 2 one reaches everywhere.
constexpr std::uint64_t kAsksPerFarOne = 4;
/// Keeps the random numbers of questions apart from the other users of the study's seed.
constexpr std::uint64_t kAskSeeds = 1ULL << 35;

/// Derivatives in each model while its parameters are sought.
constexpr int kMaxFittedDerivatives = 60;
/// From what is expected of a derivative without it, in standard deviations.
constexpr double kContradiction = 5.0;

}  // namespace

GaussianSearch::GaussianSearch(const SearchSpace& space,
                               const GaussianSearchPlan& plan,
                               std::vector<Point> start_points)
    : space_(space),
      plan_(plan),
      sobol_(plan.seed, static_cast<int>(space.variables.size())),
      design_(start_points.begin(), start_points.end()) {}

std::optional<Point> GaussianSearch::ask() {
  std::optional<Point> point = next_point();
  ++num_asks_;
  if (point) {
    asked_.insert(*point);
    pending_.push_back(*point);
  }
  return point;
}

std::optional<Point> GaussianSearch::next_point() {
  if (!design_.empty()) {
    Point point = std::move(design_.front());
    design_.pop_front();
    return point;
  }
  if (is_designing()) {
    return fresh_sobol_point();
  }
  update_models();
  Rng rng(plan_.seed, Stream::kSearch, kAskSeeds + num_asks_);
  const std::vector<GaussianProcess> extended =
      pending_.empty() ? std::vector<GaussianProcess>{} : models_with_pending();
  const std::span<const GaussianProcess> models = pending_.empty() ? models_ : extended;
  std::optional<Point> point =
      plan_.rules > 1 ? promising_point(models, rng) : scalarised_point(models, rng);
  return point ? point : fresh_sobol_point();
}

bool GaussianSearch::is_designing() const {
  return num_asks_ < static_cast<std::uint64_t>(plan_.num_design) || num_succeeded_ < 2;
}

void GaussianSearch::restore_ask(const Point& point) {
  if (!design_.empty()) {
    design_.pop_front();
  } else if (is_designing()) {
    fresh_sobol_point();
  }
  ++num_asks_;
  asked_.insert(point);
  pending_.push_back(point);
  // Where it stood in for a promising design, the sequence went on.
  for (int i = 0; i < kMaxRepeats && !is_designing(); ++i) {
    if (!asked_.contains(point_from_unit(space_, sobol_.point(next_sobol_)))) {
      break;
    }
    ++next_sobol_;
  }
}

void GaussianSearch::restore_model(std::span<const double> parameters) {
  const std::size_t size = static_cast<std::size_t>(num_parameters(Encoding(space_))) +
                           (plan_.takes_derivatives ? 1U : 0U);
  GLINT_CHECK(parameters.size() % size == 0, "parameters of whole models");
  Fit fit{.num_told = told_.size(), .parameters = {}};
  for (std::size_t i = 0; i < parameters.size(); i += size) {
    fit.parameters.emplace_back(
        Eigen::Map<const Eigen::VectorXd>(parameters.data() + i, static_cast<Eigen::Index>(size)));
  }
  restored_ = std::move(fit);
  note_fit(told_.size());
}

std::vector<std::vector<Expectation>> GaussianSearch::expected_objectives() {
  return expected_values(0, plan_.num_objectives);
}

std::vector<std::vector<Expectation>> GaussianSearch::expected_limits() {
  return expected_values(plan_.num_objectives, plan_.num_limits);
}

/// Of `count` models from the first one on.
std::vector<std::vector<Expectation>> GaussianSearch::expected_values(int first, int count) {
  if (restored_) {
    rebuild(*restored_);
  }
  if (models_.empty()) {
    return {};
  }
  for (; num_in_models_ < told_.size(); ++num_in_models_) {
    add_to_models(told_[num_in_models_]);
  }
  return expected_rows_of(std::span<const GaussianProcess>(models_).subspan(
                              static_cast<std::size_t>(first), static_cast<std::size_t>(count)),
                          told_);
}

std::optional<Point> GaussianSearch::fresh_sobol_point() {
  for (int i = 0; i < kMaxRepeats; ++i) {
    Point point = point_from_unit(space_, sobol_.point(next_sobol_++));
    if (!asked_.contains(point)) {
      return point;
    }
  }
  return std::nullopt;
}

void GaussianSearch::tell(const Point& point, const Answer& answer) {
  GLINT_CHECK(!pending_.empty() && pending_.front() == point, "told in the order of asking");
  pending_.erase(pending_.begin());
  ToldDesign told{.point = point, .merit = answer.merit};
  if (!answer.is_failed) {
    told.values =
        answer.objectives.empty() ? std::vector<double>{answer.objective.value} : answer.objectives;
    told.errors = answer.errors;
    told.errors.resize(told.values.size(), std::nan(""));
    for (std::size_t i = 0; i < answer.limits.size(); ++i) {
      add_limit(answer, i, told);
    }
    if (plan_.takes_derivatives) {
      told.derivatives.insert(told.derivatives.begin(),
                              unit_derivatives(space_, point, answer.objective.gradient));
    }
    GLINT_CHECK(
        told.values.size() == static_cast<std::size_t>(plan_.num_objectives + plan_.num_limits),
        "told as many objectives and limits as announced");
    ++num_succeeded_;
  }
  told_.push_back(std::move(told));
}

void GaussianSearch::add_limit(const Answer& answer, std::size_t i, ToldDesign& told) const {
  const ValueWithGradient& limit = answer.limits[i];
  const bool has_log = plan_.rules > 3;
  const double derivative = has_log ? log_limit_derivative(limit.value) : 1.0;
  const bool is_known = plan_.rules > 4 && i < answer.limit_errors.size();
  told.values.push_back(has_log ? log_limit(limit.value) : limit.value);
  told.errors.push_back(is_known ? derivative * answer.limit_errors[i] : std::nan(""));
  if (plan_.takes_derivatives) {
    std::vector<double> gradient = limit.gradient;
    for (double& by_unit : gradient) {
      by_unit *= derivative;
    }
    told.derivatives.push_back(unit_derivatives(space_, told.point, gradient));
  }
}

void GaussianSearch::update_models() {
  if (restored_) {
    rebuild(*restored_);
  }
  if (told_.size() >= next_refit_) {
    refit();
    return;
  }
  for (; num_in_models_ < told_.size(); ++num_in_models_) {
    add_to_models(told_[num_in_models_]);
  }
}

void GaussianSearch::add_models(bool has_failures) {
  const auto num_values = static_cast<std::size_t>(plan_.num_objectives + plan_.num_limits);
  while (models_.size() < num_values) {
    const bool is_noisy = plan_.is_noisy && !plan_.exact.is_exact(models_.size());
    models_.emplace_back(space_, model_settings(plan_.rules, is_noisy, plan_.takes_derivatives));
  }
  if (has_failures && models_.size() == num_values) {
    models_.emplace_back(space_, model_settings(plan_.rules, true, plan_.takes_derivatives));
  }
}

void GaussianSearch::refit() {
  const auto num_values = static_cast<std::size_t>(plan_.num_objectives + plan_.num_limits);
  add_models(num_succeeded_ < told_.size());
  const ModelData data = model_data(told_, num_values, num_front());
  note_subset(data.all.size(), told_.size());
  max_derivatives_ = derivatives_per_model(told_, num_values);
  for (std::size_t k = 0; k < num_values; ++k) {
    const std::vector<UnitDerivatives> derivatives =
        plan_.takes_derivatives
            ? nearest_derivatives(
                  space_, told_, data, k, std::min(max_derivatives_, kMaxFittedDerivatives))
            : std::vector<UnitDerivatives>{};
    models_[k].fit(data.points, data.values[k], data.errors[k], derivatives);
  }
  if (models_.size() > num_values) {
    models_[num_values].fit(data.all, data.failures);
  }
  if (plan_.takes_derivatives) {
    std::vector<KernelParameters> parameters;
    std::ranges::transform(models_, std::back_inserter(parameters), &GaussianProcess::parameters);
    if (const int dropped = set_with_derivatives(data, parameters); dropped > 0) {
      add_event(EventKind::kNote,
                0,
                std::to_string(dropped) +
                    " derivatives contradict the scores and derivatives around them and are not "
                    "used");
    }
  }
  model_points_ = data.points;
  note_fit(told_.size());
  if (plan_.rules > 1) {
    std::vector<double> parameters;
    for (const GaussianProcess& model : models_) {
      parameters.insert(parameters.end(), model.parameters().begin(), model.parameters().end());
    }
    add_model_event(std::move(parameters));
  }
}

/// Says so in the log when the models know a part of what was told for the first time.
void GaussianSearch::note_subset(std::size_t num_known, std::size_t num_told) {
  if (plan_.rules > 5 && num_known < num_told && !is_subset_) {
    add_event(EventKind::kNote,
              static_cast<int>(num_known),
              "from here on the models know a part of what is told: " + std::to_string(num_known) +
                  " of " + std::to_string(num_told) + " designs");
  }
  is_subset_ = num_known < num_told;
}

/// The models of objectives and limits with given parameters. @return derivatives let go
int GaussianSearch::set_with_derivatives(const ModelData& data,
                                         const std::vector<KernelParameters>& parameters) {
  const auto num_values = static_cast<std::size_t>(plan_.num_objectives + plan_.num_limits);
  int dropped = 0;
  for (std::size_t k = 0; k < num_values; ++k) {
    models_[k].set(parameters[k],
                   data.points,
                   data.values[k],
                   data.errors[k],
                   nearest_derivatives(space_, told_, data, k, max_derivatives_));
    dropped += models_[k].drop_contradicted_derivatives(kContradiction);
  }
  return dropped;
}

/// The models as they were after the fit.
void GaussianSearch::rebuild(const Fit& fit) {
  const auto num_values = static_cast<std::size_t>(plan_.num_objectives + plan_.num_limits);
  add_models(fit.parameters.size() > num_values);
  GLINT_CHECK(fit.parameters.size() == models_.size(), "parameters of every model");
  const auto told = std::span<const ToldDesign>(told_).first(fit.num_told);
  const ModelData data = model_data(told, num_values, num_front());
  is_subset_ = data.all.size() < told.size();
  max_derivatives_ = derivatives_per_model(told, num_values);
  if (plan_.takes_derivatives) {
    set_with_derivatives(data, fit.parameters);
  } else {
    for (std::size_t k = 0; k < num_values; ++k) {
      models_[k].set(fit.parameters[k], data.points, data.values[k], data.errors[k]);
    }
  }
  if (models_.size() > num_values) {
    models_[num_values].set(fit.parameters[num_values], data.all, data.failures);
  }
  model_points_ = data.points;
  note_fit(fit.num_told);
  restored_.reset();
}

void GaussianSearch::note_fit(std::size_t num_told) {
  num_in_models_ = num_told;
  const std::size_t part = plan_.rules > 1 ? 8 : 4;
  const std::size_t step = std::min(num_told / part, kMaxModelPoints - kKeptModelPoints);
  next_refit_ = num_told + std::max<std::size_t>(2, step);
}

void GaussianSearch::add_to_models(const ToldDesign& told) {
  const auto num_values = static_cast<std::size_t>(plan_.num_objectives + plan_.num_limits);
  const bool is_failed = told.values.empty();
  for (std::size_t k = 0; k < num_values && !is_failed; ++k) {
    const bool has_room =
        k < told.derivatives.size() &&
        models_[k].num_derivatives() + num_known(told.derivatives[k]) <= max_derivatives_;
    models_[k].add(told.point,
                   told.values[k],
                   told.errors[k],
                   has_room ? told.derivatives[k] : UnitDerivatives{});
  }
  if (models_.size() > num_values) {
    models_[num_values].add(told.point, is_failed ? kFailure : kSuccess);
  }
  if (!is_failed) {
    model_points_.push_back(told.point);
  }
}

std::vector<GaussianProcess> GaussianSearch::models_with_pending() const {
  std::vector<GaussianProcess> models = models_;
  std::vector<std::vector<double>> exact;
  for (const Point& point : pending_) {
    exact.push_back(plan_.exact.empty() ? std::vector<double>{} : plan_.exact.at(point));
  }
  for (std::size_t k = 0; k < models.size(); ++k) {
    for (std::size_t i = 0; i < pending_.size(); ++i) {
      const bool is_known = k < exact[i].size() && std::isfinite(exact[i][k]);
      models[k].add(pending_[i], is_known ? exact[i][k] : models[k].predict(pending_[i]).mean);
    }
  }
  return models;
}

std::vector<Point> GaussianSearch::known_points() const {
  std::vector<Point> known = model_points_;
  known.insert(known.end(), pending_.begin(), pending_.end());
  return known;
}

/// References that are not given are the worst of the initial design.
std::vector<double> GaussianSearch::reference() const {
  if (plan_.num_objectives == 1) {
    return {};
  }
  std::vector<double> reference = plan_.reference;
  reference.resize(static_cast<std::size_t>(plan_.num_objectives), std::nan(""));
  for (std::size_t k = 0; k < reference.size(); ++k) {
    std::optional<double> worst;
    for (std::size_t i = 0; i < told_.size(); ++i) {
      const bool counts = i < static_cast<std::size_t>(plan_.num_design) || !worst;
      if (counts && !told_[i].values.empty()) {
        worst = std::max(worst.value_or(told_[i].values[k]), told_[i].values[k]);
      }
    }
    if (std::isnan(reference[k])) {
      reference[k] = *worst;
    }
  }
  return reference;
}

/// By rules 2. Empty: all candidates have been asked before.
std::optional<Point> GaussianSearch::promising_point(std::span<const GaussianProcess> models,
                                                     Rng& rng) {
  const Promise promise(models, reference(), plan_.exact.is_exact());
  const std::vector<Point> known = known_points();
  const ProposalTask task = {.space = space_,
                             .promise = promise,
                             .encoding = models.front().encoding(),
                             .known = known,
                             .asked = asked_,
                             .exact = plan_.exact.empty() ? nullptr : &plan_.exact};
  const Reach reach = num_asks_ % kAsksPerFarOne == 0 ? Reach::kEverywhere : Reach::kNear;
  std::optional<Point> point = propose(task, reach, rng);
  return point || reach == Reach::kEverywhere ? point : propose(task, Reach::kEverywhere, rng);
}

std::vector<Point> GaussianSearch::first_candidates(const Point& best, Rng& rng) const {
  std::vector<Point> points;
  std::vector<double> unit(space_.variables.size());
  for (int i = 0; i < kNumGlobal; ++i) {
    for (double& value : unit) {
      value = rng.uniform();
    }
    points.push_back(point_from_unit(space_, unit));
  }
  for (int i = 0; i < kNumLocal; ++i) {
    points.push_back(neighbour(space_, best, kLocalWidths[i % 2 == 0 ? 0 : 1], true, rng));
  }
  return points;
}

/// By rules 1. Empty: all candidates have been asked before.
std::optional<Point> GaussianSearch::scalarised_point(std::span<const GaussianProcess> models,
                                                      Rng& rng) {
  std::vector<double> low(static_cast<std::size_t>(plan_.num_objectives),
                          std::numeric_limits<double>::infinity());
  std::vector<double> high(low.size(), -std::numeric_limits<double>::infinity());
  for (const ToldDesign& told : told_) {
    for (std::size_t k = 0; k < low.size() && !told.values.empty(); ++k) {
      low[k] = std::min(low[k], told.values[k]);
      high[k] = std::max(high[k], told.values[k]);
    }
  }
  const Acquisition acquisition(models, plan_.num_objectives, low, high, rng);
  const std::vector<Point> known = known_points();
  std::optional<Point> best;
  double best_score = -std::numeric_limits<double>::infinity();
  const auto consider = [&](std::vector<Point> points) {
    std::erase_if(points, [this](const Point& point) { return asked_.contains(point); });
    if (points.empty()) {
      return;
    }
    const Eigen::VectorXd scores = acquisition.scores(models.front().encoding().rows(points));
    Eigen::Index at = 0;
    const double score = scores.maxCoeff(&at);
    if (!best || score > best_score) {
      best = points[static_cast<std::size_t>(at)];
      best_score = score;
    }
  };
  const Point& center = known[static_cast<std::size_t>(acquisition.best_point())];
  consider(first_candidates(center, rng));
  for (const double width : kRefinedWidths) {
    std::vector<Point> points;
    for (int i = 0; i < kNumRefined && best; ++i) {
      points.push_back(neighbour(space_, *best, width, false, rng));
    }
    consider(std::move(points));
  }
  return best;
}

}  // namespace glint

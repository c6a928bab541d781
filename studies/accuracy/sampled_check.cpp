// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/accuracy/sampled_check.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/error.h"
#include "core/rng.h"
#include "metrics/statistics/quantiles.h"
#include "optimizer/search/search.h"

namespace glint {
namespace {

constexpr double kWorthwhile = 0.5;                  ///< of a whole check's work, at most
constexpr std::uint64_t kDrawnSquares = 1ULL << 41;  ///< apart from the draws of trials
constexpr const char* kPixels = "pixels";            ///< names in a record's outcome
constexpr const char* kSquares = "squares";
constexpr const char* kOff = ".off";  ///< after that of a score

const std::vector<ScoreBound>& bounds_at_rung(const ChosenAccuracy& part) {
  return part.choice.steps[part.choice.step].bounds;
}

/// Pixels of the picture itself, and each by paths of its own.
bool has_paths_in_all_pixels(const RenderRung& rung) {
  return rung.is_noisy && rung.pixel_factor == 1;
}

/// In the same units as the works of a cheap rung and a dearer one.
bool is_worthwhile(double sampled, double whole) {
  return sampled <= kWorthwhile * whole;
}

/// Under this name the record keeps what the squares told.
std::string sample_name(const RenderRung& cheap, const RenderRung& dearer) {
  return fmt::format(R"(pixels of "{}" and "{}")", cheap.name, dearer.name);
}

std::optional<std::vector<SampledSquare>> squares_at(const AccuracyTask& task,
                                                     const Overrides& overrides,
                                                     const RenderRung& cheap,
                                                     const RenderRung& dearer,
                                                     const Rng& rng) {
  if (task.sample) {
    return task.sample(overrides, cheap, dearer, rng);
  }
  try {
    const SceneSettings scene = scene_with(task.study, overrides);
    return sampled_squares(task.store, at_rung(scene, cheap), at_rung(scene, dearer), rng);
  } catch (const IoError&) {
    throw;
  } catch (const Error&) {  // its whole picture will tell
    return std::nullopt;
  }
}

/// As the record keeps it: differences and standard errors by score, and of how many pixels; a
/// failed outcome where there is nothing to tell.
Outcome sampled_outcome(const ChosenAccuracy& part,
                        const Trial& trial,
                        const std::optional<std::vector<SampledSquare>>& squares) {
  Outcome untold = {.is_failed = true, .message = "the whole picture is needed"};
  if (!squares) {
    return untold;
  }
  Outcome outcome;
  std::size_t pixels = 0;
  for (const SampledSquare& square : *squares) {
    pixels += square.size();
  }
  outcome.scores[kPixels] = static_cast<double>(pixels);
  outcome.scores[kSquares] = static_cast<double>(squares->size());
  for (const ScoreBound& bound : bounds_at_rung(part)) {
    const auto found = sampled_error(bound.score, trial.outcome->scores, *squares);
    if (!found) {
      return untold;
    }
    outcome.scores[bound.score] = found->difference + 0.0;  // no negative zero
    outcome.scores[error_name(bound.score)] = found->error;
    outcome.scores[bound.score + kOff] = found->off + 0.0;
    outcome.scores[error_name(bound.score + kOff)] = found->off_error;
  }
  return outcome;
}

std::optional<SampledCheck> check_from(const ChosenAccuracy& part, const Outcome& outcome) {
  if (outcome.is_failed) {
    return std::nullopt;
  }
  const Scores& kept = outcome.scores;
  SampledCheck check = {.pixels = static_cast<int>(kept.at(kPixels)),
                        .squares = static_cast<int>(kept.at(kSquares)),
                        .errors = {}};
  for (const ScoreBound& bound : bounds_at_rung(part)) {
    check.errors[bound.score] = {.difference = kept.at(bound.score),
                                 .error = kept.at(error_name(bound.score)),
                                 .off = kept.at(bound.score + kOff),
                                 .off_error = kept.at(error_name(bound.score + kOff))};
  }
  return check;
}

}  // namespace

bool may_be_sampled(const AccuracyTask& task, const ChosenAccuracy& part) {
  // Exposure or samples that follow from the whole picture.
  const SceneSettings& scene = task.study.scene;
  if (scene.expose_to > 0.0 || scene.paths.relative_error > 0.0 || !part.choice.problem.empty() ||
      (task.evaluate && !task.sample)) {
    return false;
  }
  const std::vector<ScoreBound>& bounds = bounds_at_rung(part);
  const bool do_follow = std::ranges::all_of(
      bounds, [](const ScoreBound& bound) { return follows_from_squares(bound.score); });
  // A dearer rung of paths takes at least as much as the cheap one.
  return do_follow && !bounds.empty() &&
         std::ranges::count_if(part.ladder, has_paths_in_all_pixels) > 1 &&
         is_worthwhile(share_of_squares(task.study.scene), 1.0);
}

std::optional<double> sampled_work(const AccuracyTask& task,
                                   const ChosenAccuracy& part,
                                   const RenderRung& dearer) {
  if (!may_be_sampled(task, part) || !has_paths_in_all_pixels(part.rung()) ||
      !has_paths_in_all_pixels(dearer)) {
    return std::nullopt;
  }
  const double work = share_of_squares(task.study.scene) * (part.rung().work + dearer.work);
  return is_worthwhile(work, dearer.work) ? std::optional(work) : std::nullopt;
}

std::optional<SampledCheck> recorded_sample(const AccuracyTask& task,
                                            AccuracyRecord& record,
                                            const ChosenAccuracy& part,
                                            const Trial& trial,
                                            const RenderRung& dearer) {
  const std::string name = sample_name(part.rung(), dearer);
  const std::string design = trial_name(trial.number);
  if (const Outcome* known = record.find(name, design)) {
    return check_from(part, *known);
  }
  if (task.interrupt != nullptr && *task.interrupt > 0) {
    throw EvaluationAborted();
  }
  const Rng rng(task.study.search.seed,
                Stream::kResampling,
                kDrawnSquares + static_cast<std::uint64_t>(trial.number));
  const auto squares =
      squares_at(task, overrides_of(task.study, trial.point), part.rung(), dearer, rng);
  const Outcome outcome = sampled_outcome(part, trial, squares);
  record.keep(name, design, trial.point, outcome);
  if (task.on_evaluation) {
    task.on_evaluation();
  }
  return check_from(part, outcome);
}

bool is_confirmed(const ChosenAccuracy& part,
                  const Scores& scores,
                  const SampledCheck& check,
                  double confidence) {
  const double factor = t_quantile(0.5 + 0.5 * confidence, std::max(1, check.squares - 1));
  return std::ranges::all_of(bounds_at_rung(part), [&](const ScoreBound& bound) {
    const auto found = check.errors.find(bound.score);
    if (found == check.errors.end()) {
      return false;
    }
    const SampledError& score = found->second;
    const double allowed = bound_of(bound, scores);
    return std::abs(score.difference) + factor * score.error <= allowed &&
           std::abs(score.off) <= std::max(allowed, factor * score.off_error);
  });
}

}  // namespace glint

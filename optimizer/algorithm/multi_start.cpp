// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/multi_start.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/error.h"
#include "core/rng.h"
#include "core/text.h"

namespace glint {

namespace {

/// Step widths, as parts of a variable's range: of a search from a new place, and of repeated
/// searches from the best design, which differ so that they do not retrace their steps.
constexpr double kFirstStep = 0.25;
constexpr std::array<double, 3> kBestSteps = {0.1, 0.03, 0.25};

/// Runs that end without asking, or points asked before, in a row before anything is accepted.
constexpr int kMaxIdleStarts = 200;
constexpr int kMaxSobolRepeats = 100;

/// Integers also try a jump of this part of their values, not only the next one.
constexpr double kFarNeighbour = 0.125;

/// Keeps the seeds of runs apart from the other users of the study's seed.
constexpr std::uint64_t kRunSeeds = 1ULL << 34;

}  // namespace

MultiStart::MultiStart(const SearchSpace& space,
                       const MultiStartPlan& plan,
                       std::vector<Point> start_points,
                       BodyMaker make_body)
    : space_(space),
      plan_(plan),
      make_body_(std::move(make_body)),
      sobol_(plan.seed, static_cast<int>(space.variables.size())),
      design_(start_points.begin(), start_points.end()),
      slots_(static_cast<std::size_t>(plan.batch)),
      has_discrete_(!std::ranges::all_of(space.variables, is_continuous)) {
  asked_.insert(design_.begin(), design_.end());
  while (design_.size() < static_cast<std::size_t>(plan.num_design)) {
    design_.push_back(fresh_sobol_point());
    asked_.insert(design_.back());
  }
}

std::optional<Point> MultiStart::ask() {
  Pending pending;
  if (!design_.empty()) {
    pending.point = std::move(design_.front());
    design_.pop_front();
  } else if (const std::optional<std::size_t> slot = free_slot()) {
    pending = ask_slot(*slot);
  } else {
    GLINT_CHECK(false, "at most `batch` points may be asked before they are told");
  }
  asked_.insert(pending.point);
  pending_.push_back(pending);
  return pending.point;
}

void MultiStart::tell(const Point& point, const Answer& answer) {
  GLINT_CHECK(!pending_.empty() && pending_.front().point == point, "told in the order of asking");
  const Pending pending = std::move(pending_.front());
  pending_.pop_front();
  if (!answer.is_failed && told_points_.insert(point).second) {
    told_.push_back({point, answer.merit});
  }
  if (pending.slot) {
    Slot& slot = slots_[*pending.slot];
    slot.is_waiting = false;
    slot.thread->tell(answer_for(slot, answer));
  }
}

/// The answer with the derivatives by the run's own variables only, as far as its method looks at
/// them.
Answer MultiStart::answer_for(const Slot& slot, const Answer& answer) const {
  Answer result{.merit = answer.merit, .is_failed = answer.is_failed};
  if (plan_.num_objectives > 1 && !answer.is_failed) {
    result.objectives = answer.objectives;
    result.limits = answer.limits;
    return result;
  }
  if (!is_gradient_method(plan_.method) || answer.is_failed) {
    return result;
  }
  const auto picked = [&slot, this](const std::vector<double>& gradient) {
    GLINT_CHECK(gradient.size() == space_.variables.size(),
                "told with one derivative per variable");
    std::vector<double> own;
    for (const std::size_t variable : slot.variable) {
      own.push_back(gradient[variable]);
    }
    return own;
  };
  GLINT_CHECK(answer.limits.size() == static_cast<std::size_t>(plan_.num_limits),
              "told with as many limits as announced");
  result.objective = {answer.objective.value, picked(answer.objective.gradient)};
  for (const ValueWithGradient& limit : answer.limits) {
    result.limits.push_back({limit.value, picked(limit.gradient)});
  }
  return result;
}

std::optional<std::size_t> MultiStart::free_slot() {
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    const std::size_t index = (next_slot_ + i) % slots_.size();
    if (!slots_[index].is_waiting) {
      next_slot_ = (index + 1) % slots_.size();
      return index;
    }
  }
  return std::nullopt;
}

MultiStart::Pending MultiStart::ask_slot(std::size_t index) {
  Slot& slot = slots_[index];
  Start start;
  for (int idle = 0; idle < kMaxIdleStarts; ++idle) {
    if (slot.thread) {
      if (std::optional<Point> point = ask_run(slot)) {
        slot.is_waiting = true;
        return {std::move(*point), index};
      }
    }
    start = next_start();
    if (!variables_to_search(start.point).empty()) {
      begin_run(index, start);
    } else if (!asked_.contains(start.point)) {
      break;
    }
  }
  return {start.point, std::nullopt};
}

/// The run's next question; empty when the run is over.
std::optional<Point> MultiStart::ask_run(Slot& slot) {
  using Status = AskTellThread::Status;
  if (runs_to_abandon_.contains(slot.run)) {
    slot.thread->abandon();
  }
  const Status status = slot.thread->ask();
  if (status == Status::kAsked) {
    std::vector<double> unit = unit_from_point(space_, slot.base);
    for (std::size_t i = 0; i < slot.variable.size(); ++i) {
      unit[slot.variable[i]] = slot.thread->point()[i];
    }
    return point_from_unit(space_, unit);
  }
  if (status == Status::kAbandoned) {
    add_event(EventKind::kAbandon,
              slot.run,
              plan_.method + " run " + std::to_string(slot.run) + " did not answer within " +
                  shortest(plan_.patience_s) + " s and was left behind");
  } else {
    add_event(EventKind::kNote,
              slot.run,
              plan_.method + " run " + std::to_string(slot.run) + ": " + slot.thread->ending());
  }
  slot.thread.reset();
  return std::nullopt;
}

void MultiStart::begin_run(std::size_t index, const Start& start) {
  Slot& slot = slots_[index];
  slot.run = num_runs_++;
  slot.base = start.point;
  slot.variable = variables_to_search(start.point);
  const std::vector<double> unit = unit_from_point(space_, start.point);
  Rng rng(plan_.seed, Stream::kSearch, kRunSeeds + static_cast<std::uint64_t>(slot.run));
  MethodRun run{.method = plan_.method,
                .initial_step = start.step,
                .tolerance = plan_.tolerance,
                .num_limits = plan_.num_limits,
                .num_objectives = plan_.num_objectives,
                .seed = rng.next_u32(),
                .is_first = slot.run == 0};
  for (const std::size_t variable : slot.variable) {
    run.start.push_back(unit[variable]);
  }
  set_box(run);
  add_event(EventKind::kRestart,
            slot.run,
            plan_.method + " run " + std::to_string(slot.run) + " starts from " + start.text);
  slot.thread = std::make_unique<AskTellThread>(make_body_(run), plan_.patience_s);
}

/// The whole cube; but DIRECT-L ignores start points, so further runs of it get a part of the cube
/// around theirs.
void MultiStart::set_box(MethodRun& run) const {
  run.low.assign(run.start.size(), 0.0);
  run.high.assign(run.start.size(), 1.0);
  if (run.method != "direct_l" || run.is_first) {
    return;
  }
  for (std::size_t i = 0; i < run.start.size(); ++i) {
    run.low[i] = std::clamp(run.start[i] - kFirstStep, 0.0, 1.0 - 2.0 * kFirstStep);
    run.high[i] = run.low[i] + 2.0 * kFirstStep;
  }
}

std::vector<std::size_t> MultiStart::variables_to_search(const Point& point) const {
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < point.size(); ++i) {
    const Variable& variable = space_.variables[i];
    if (is_continuous(variable) && num_values(variable) > 1.0 && is_active(space_, point, i)) {
      result.push_back(i);
    }
  }
  return result;
}

MultiStart::Start MultiStart::next_start() {
  const int number = num_starts_++;
  if (number < plan_.batch) {
    if (std::optional<Start> start = first_start()) {
      return *start;
    }
    return start_from_sobol();
  }
  const int turn = number - plan_.batch;
  if (has_discrete_) {
    const int kind = turn % 3;
    return kind == 0 ? start_from_neighbour() : kind == 1 ? start_from_sobol() : start_from_best();
  }
  return turn % 2 == 0 ? start_from_sobol() : start_from_best();
}

/// The first runs begin at the best designs, each at another one.
std::optional<MultiStart::Start> MultiStart::first_start() {
  const auto rank = static_cast<std::size_t>(num_starts_ - 1);
  if (std::optional<Point> point = told_of_rank(rank)) {
    return Start{std::move(*point), kFirstStep, "design of rank " + std::to_string(rank + 1)};
  }
  if (rank == 0) {
    const std::vector<double> middle(space_.variables.size(), 0.5);
    return Start{point_from_unit(space_, middle), kFirstStep, "the middle"};
  }
  return std::nullopt;
}

MultiStart::Start MultiStart::start_from_sobol() {
  return {fresh_sobol_point(), kFirstStep, "a fresh Sobol point"};
}

MultiStart::Start MultiStart::start_from_best() {
  const std::optional<Point> best = told_of_rank(0);
  if (!best) {
    return start_from_sobol();
  }
  const double step = kBestSteps[static_cast<std::size_t>(num_best_starts_++) % kBestSteps.size()];
  return {*best, step, "the best design so far, step " + shortest(step)};
}

MultiStart::Start MultiStart::start_from_neighbour() {
  const std::optional<Point> best = told_of_rank(0);
  if (!best) {
    return start_from_sobol();
  }
  const std::vector<Point> candidates = neighbours(*best);
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const auto turn = static_cast<std::size_t>(num_neighbours_++);
    const Point& candidate = candidates[turn % candidates.size()];
    if (!asked_.contains(candidate)) {
      return {candidate, kBestSteps.front(), "a neighbour of the best design so far"};
    }
  }
  return start_from_sobol();
}

/// The point with one active choice or integer changed.
std::vector<Point> MultiStart::neighbours(const Point& point) const {
  std::vector<Point> result;
  for (std::size_t i = 0; i < point.size(); ++i) {
    const Variable& variable = space_.variables[i];
    if (is_continuous(variable) || !is_active(space_, point, i)) {
      continue;
    }
    const double num = num_values(variable);
    std::vector<double> offsets;
    if (variable.kind == Variable::Kind::kChoice) {
      for (std::size_t k = 1; k < variable.choices.size(); ++k) {
        offsets.push_back(static_cast<double>(k));
      }
    } else {
      const double step = std::max(1.0, variable.step);
      const double jump = step * std::max(2.0, std::floor(kFarNeighbour * num));
      offsets = {step, -step, jump, -jump};
    }
    for (const double offset : offsets) {
      Point changed = point;
      changed[i] += offset;
      if (variable.kind == Variable::Kind::kChoice && changed[i] >= num) {
        changed[i] -= num;
      }
      changed = canonical(space_, changed);
      if (changed != point) {
        result.push_back(std::move(changed));
      }
    }
  }
  return result;
}

Point MultiStart::fresh_sobol_point() {
  Point point;
  for (int i = 0; i < kMaxSobolRepeats; ++i) {
    point = point_from_unit(space_, sobol_.point(next_sobol_++));
    if (!asked_.contains(point)) {
      break;
    }
  }
  return point;
}

/// The told point with so many better ones before it; equal merits count in the order of telling.
std::optional<Point> MultiStart::told_of_rank(std::size_t rank) const {
  if (rank >= told_.size()) {
    return std::nullopt;
  }
  std::vector<std::size_t> order(told_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(
      order, [this](std::size_t a, std::size_t b) { return told_[a].merit < told_[b].merit; });
  return told_[order[rank]].point;
}

}  // namespace glint

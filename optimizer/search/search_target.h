// SPDX-License-Identifier: GPL-3.0-or-later
//
// When a search has reached budget.target. Without noise an evaluation tells; under search.noisy
// the models of gp must expect it of the best design. They are asked after a batch of which a
// design was seen to reach the target, where their parameters are new, and (by rules 8) where the
// run goes on with another target than it was last looked at with. That one stands in the log, so
// that a search that was cut up ends where a whole one does. Private to the module.
#pragma once

#include <optional>
#include <span>

#include "optimizer/search/replay.h"

namespace glint {

class SearchTarget {
 public:
  /// @param task  with the rules that the run follows; must outlive this
  /// @param log   all events of the run so far
  SearchTarget(const SearchTask& task, std::span<const Event> log);

  /// Whether the target is another than the log tells.
  bool is_new() const { return is_new_; }

  /// Looks at what was told. Asks the models at most once.
  bool is_reached(const SearchMemory& memory);

  /// What the log has to tell before the next design is asked; from then on the target is not new.
  std::optional<Event> take_event();

  /// Whether a model expects the target of a trial.
  bool is_expected(const Expectations& expected, int number) const;

  /// How often models were asked.
  int num_questions() const { return num_questions_; }

 private:
  bool is_beyond(double value) const;
  bool has_reached(const Trial& told) const;
  bool has_seen_it(const SearchMemory& memory) const;
  bool may_be_expected(const SearchMemory& memory) const;
  bool is_expected_of_best(const SearchMemory& memory);

  const SearchTask& task_;
  bool has_model_;      ///< the algorithm is gp
  bool judges_limits_;  ///< by rules 8 with models: limits, too, by what these expect
  bool is_new_ = false;
  int num_questions_ = 0;
};

}  // namespace glint

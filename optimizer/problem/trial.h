// SPDX-License-Identifier: GPL-3.0-or-later
//
// The plain values a search leaves behind: trials, their outcomes, and the ordered events.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "optimizer/problem/space.h"

namespace glint {

/// Named scores of one evaluation, in the order of their names.
using Scores = std::map<std::string, double>;

/// What an evaluation says about its own result, for people.
struct Remark {
  std::optional<std::int64_t> count;  ///< of what the text tells: 71 and "pixels are held"
  std::string text;

  bool operator==(const Remark&) const = default;
};

/// "71 pixels are held"; several with " | " between them.
std::string text_of(const Remark& remark);
std::string text_of(std::span<const Remark> remarks);

/// The remarks that text_of() made this of: until schema 2 a study's database held them so.
std::vector<Remark> remarks_from_text(std::string_view text);

/// What one evaluation gave.
struct Outcome {
  Scores scores;
  bool is_failed = false;
  std::string message;          ///< why it failed; empty when it did not
  std::vector<Remark> remarks;  ///< on what it gave
  double seconds = 0.0;         ///< wall clock of the evaluation; for budgets and reports only
  /// Score name -> its derivative by each variable of the space, in the variable's own unit, in the
  /// order of Point; NaN: not known. Of objective and limited scores, where needs_gradient() asks
  /// for it; all of it is recorded.
  std::map<std::string, std::vector<double>> gradients;
};

/// Why a design was evaluated.
enum class TrialKind {
  kSearch,
  kPart,      ///< one inspected part of a population, its figures as scores
  kReplicate  ///< a design once more, with random numbers that no search has seen
};

/// A design and, once it was evaluated, its outcome.
struct Trial {
  TrialKind kind = TrialKind::kSearch;
  int number = 0;    ///< counts from 1 within its kind, in the order of asking
  std::string name;  ///< of an inspected part or of a replicate's design; empty in the search
  Point point;
  std::optional<Outcome> outcome;  ///< empty: asked, not evaluated yet
};

/// Steps of a search in the order they happened. Asks and tells alone rebuild the algorithm.
enum class EventKind {
  kAsk,      ///< the algorithm asked for this trial's point; again for a trial that it knows
  kTell,     ///< this trial's merit was told; `value` is the merit
  kRestart,  ///< a run of the algorithm ended and another took its place
  kAbandon,  ///< run number `value` did not answer and was left behind
  /// For people; `value` > 0: so many designs the models know from here on; with `objectives`: the
  /// budget.target that the search is looked at with from here on, NaN: none.
  kNote,
  kReference,  ///< of several objectives: the hypervolume's reference was fixed at `objectives`
  kRules,      ///< before the first ask: the run follows the rules `value` (SearchSettings::rules)
  kModel,      ///< the algorithm's models have the parameters `objectives` from the next ask on
  /// The algorithm begins anew: asks and tells before are history. `trial` > 0: all outcomes so far
  /// were withdrawn, this trial showed why, and `value` and `objectives` are of who reviews the
  /// search. 0: the space was widened; outcomes stay.
  kEpoch,
  /// A design was evaluated once more, with random numbers that no search has seen: replicate
  /// number `value` of its race, of search trial `trial` (0: of none) or of what `text` names.
  kReplicate
};

struct Event {
  EventKind kind = EventKind::kNote;
  int trial = 0;  ///< search trial number; 0: none
  double value = 0.0;
  std::string text;
  /// Of several objectives, one number each and smaller is better: maximised scores are negated.
  /// Of kTell (empty when the trial failed) and kReference. Of kModel: parameters; of kEpoch:
  /// numbers of the reviewer.
  std::vector<double> objectives = {};
};

}  // namespace glint

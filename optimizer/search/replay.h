// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a running search keeps in memory, and how the recorded events rebuild it. Private to the
// module.
#pragma once

#include <algorithm>
#include <cstddef>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "optimizer/search/search.h"

namespace glint {

struct SearchMemory {
  int rules = kSearchRules;  ///< SearchSettings::rules
  std::unique_ptr<Algorithm> algorithm;
  MeritFunction merit;
  std::vector<Trial> trials;       ///< trial number n at index n - 1
  std::map<Point, int> number_of;  ///< of every point asked
  std::deque<int> in_flight;       ///< trial numbers asked and not told, in order
  int num_known = 0;               ///< trials that an ask has named
  std::vector<int> tells;          ///< trial numbers in the order of telling
  int num_told = 0;                ///< distinct trials told; they are the first ones
  int num_failed = 0;              ///< of those told
  int num_reused = 0;              ///< asks for a known trial
  int num_idle = 0;                ///< the same, since the last ask for a new one
  int num_archived = 0;            ///< trials that the epoch began with
  int num_given = 0;               ///< trials of an earlier run that the search began with
  int since_better = 0;            ///< told trials since `surely_best`, none that it began with
  std::optional<int> best;         ///< number of the best told trial
  std::optional<int>
      surely_best;                ///< the last told one that beat the one before by more than noise
  int num_design = 0;             ///< evaluations that fix the reference
  std::vector<double> reference;  ///< of several objectives; empty: not fixed yet
  std::vector<int> surely_gained;     ///< of several: feasible ones that added to the hypervolume
  std::size_t told_before_batch = 0;  ///< tells before the last batch was asked
  std::optional<std::size_t> told_before_model;  ///< tells before models had their last parameters

  Trial& trial(int number) { return trials[static_cast<std::size_t>(number - 1)]; }

  const Trial& trial(int number) const { return trials[static_cast<std::size_t>(number - 1)]; }

  /// Whether a trial, by its number, was not there when the search or its epoch began.
  bool is_new(int number) const { return number > std::max(num_archived, num_given); }

  /// Counts an ask of this trial and puts it in flight.
  void note_ask(int number);

  /// The models have other parameters from the next ask on.
  void note_model() { told_before_model = tells.size(); }

  /// Whether models were given other parameters for the last batch.
  bool has_new_model() const { return told_before_model == told_before_batch; }

  /// Tells the oldest trial in flight what it gave. @return the event that says so
  Event tell_next(const Goal& goal);
  /// Fixes the reference of several objectives once the initial design is told.
  /// @return the event that says so, when it was fixed now
  std::optional<Event> fix_reference(const Goal& goal);
};

/// A search that has not asked anything yet in its epoch: it begins with the points that were asked
/// before. @throws ConfigError for a wrong task; IoError
SearchMemory make_memory(const SearchTask& task, const Storage& storage);

/// The events of the last epoch; all where there was one.
std::span<const Event> last_epoch(std::span<const Event> events);

/// The rules (SearchSettings::rules) that a run follows: those in its log; 1 where it has asked
/// without any, as programs did before there were rules; `latest` where it has not asked yet.
/// @throws ConfigError for rules that this program does not know
int recorded_rules(std::span<const Event> events, int latest);

/// Writes the rules that a new run follows, before its first ask.
void begin_log(const SearchTask& task, Storage& storage);

/// Repeats the recorded asks and tells of the last epoch. Asks are computed again and compared: all
/// of them when SearchTask::verify_replay or where the algorithm cannot do without, else the last
/// batch and ten drawn ones; the others are taken from the record.
/// @throws ConfigError when the algorithm now asks or judges otherwise than recorded
/// @throws IoError     when the record contradicts itself
void replay(const SearchTask& task, const Storage& storage, SearchMemory& memory);

}  // namespace glint

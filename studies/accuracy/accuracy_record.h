// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is known of designs at the rungs of a ladder, beside the search: nothing is evaluated twice,
// neither in a run nor when it is resumed.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "optimizer/storage/storage.h"

namespace glint {

/// Of how a rung is chosen from evaluations of the ladder, and when it is raised; a run keeps those
/// that it was begun by. 1: bounds without the top's own bias, no epochs; kept nothing of itself.
inline constexpr int kAccuracyRules = 2;
/// The same of a search with a rung for each branch, where a choice changes the scene's kind; begun
/// by rules 2 such a search has one rung for all designs, and goes on so.
inline constexpr int kBranchRules = 3;
/// The same with a rung for each combination of the values of several such choices; begun by rules
/// 3 such a search has a rung for each value of one of them, and goes on so.
inline constexpr int kCombinedRules = 4;
/// The rung is chosen by rules before, which are noted too, and designs are checked in random
/// pixels while the search goes on; begun by those rules themselves a search is checked by whole
/// pictures, and goes on so.
inline constexpr int kPixelRules = 5;

/// After the name of a rung: its scores without the mean errors of an epoch that has ended.
inline constexpr std::string_view kCorrected = ", corrected";

/// Gets what a trial of the search gave at a rung.
using OnTrialOutcome =
    std::function<void(const std::string& rung, int trial, const Outcome& outcome)>;

/// Outcomes by "RUNG | DESIGN", in a database where there is one: a row of kPart for each. Safe to
/// use from several threads.
class AccuracyRecord {
 public:
  /// @param storage  kAccuracyTrials; nullptr: nothing is kept beyond this object
  /// @throws IoError
  explicit AccuracyRecord(Storage* storage);

  /// Refuses a search that has been begun by rules before kAccuracyRules, or by unknown ones:
  /// its rung would not be chosen again, and scores of two rungs would be mixed.
  /// @param is_begun  the search has asked for designs
  /// @throws ConfigError
  void check_rules(bool is_begun) const;

  /// Notes the rung that a search begins with, before it asks for anything; compares it when
  /// resumed.
  /// @param rung   its name, or SearchRungs::name() of several
  /// @param rules  ChosenAccuracy::rules()
  /// @param has_sampled_checks  by kPixelRules beside them
  /// @throws ConfigError when it was another one; IoError
  void begin_search(const std::string& rung,
                    int rules = kAccuracyRules,
                    bool has_sampled_checks = false);

  /// The rung that begin_search() noted in an earlier run; empty: none did.
  std::optional<std::string> begun_rung() const;
  /// And by which rules its rung was chosen.
  std::optional<int> begun_rules() const;
  /// And whether it is checked by kPixelRules.
  std::optional<bool> begun_with_sampled_checks() const;

  /// Stays where it is. nullptr: not known
  const Outcome* find(const std::string& rung, const std::string& design) const;

  /// What is known already stays as it is. @throws IoError
  void keep(const std::string& rung,
            const std::string& design,
            const Point& point,
            const Outcome& outcome);

  /// Hands on what is known of the search's trials, and from now on what is kept of them, at once.
  void follow(OnTrialOutcome on_outcome);

 private:
  void hand_on(const std::string& key, const Outcome& outcome) const;

  /// What begin_search() noted.
  std::optional<Event> begun() const;

  Storage* storage_;
  mutable std::mutex mutex_;
  std::map<std::string, Outcome> known_;
  OnTrialOutcome on_outcome_;
  int last_number_ = 0;
};

/// The name of a search's trial among the designs: "trial 17".
std::string trial_name(int number);

}  // namespace glint

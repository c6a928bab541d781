// SPDX-License-Identifier: GPL-3.0-or-later
//
// A search looked after while it goes on: designs of it evaluated at a second, dearer rung, and a
// dearer rung for all of them where one is beyond the bound (docs/accuracy.md, "Checked").
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "optimizer/search/search.h"
#include "studies/accuracy/chosen_accuracy.h"
#include "studies/accuracy/sampled_check.h"

namespace glint {

/// Of a search's counted work, what checks may take.
inline constexpr double kCheckShare = 0.1;
/// Evaluations before the first check.
inline constexpr int kUncheckedEvaluations = 20;

/// One design of the search at the chosen rung and at a dearer one.
struct CheckedDesign {
  int trial = 0;
  bool is_finalist = false;  ///< it was the best when it was found; else drawn at random
  std::string rung;          ///< the dearer one
  Outcome dearer;
  std::vector<std::string> beyond;  ///< scores whose difference is beyond their bound_of()
  std::vector<std::string> wider;   ///< scores whose own bound is wider than that of the trial
  std::size_t branch = 0;           ///< of ChosenAccuracy::parts()
  /// What confirmed the bounds in random pixels; dearer has no scores then. Empty: the whole
  /// picture was compared.
  std::optional<SampledCheck> sampled = {};
};

/// A part of the search that a check has ended: all its designs are evaluated again, where there
/// are branches those of the branches whose rung rises.
struct EndedEpoch {
  int trial = 0;             ///< whose check was beyond the bound
  std::string rung;          ///< that the search, or the branch of that trial, was rendered by
  int evaluations = 0;       ///< that are made again
  double check_work = 0.0;   ///< of checks of such designs
  double search_work = 0.0;  ///< of those evaluations
  std::string sentence;
};

/// A trial of the search beside what it gave at a dearer rung.
/// @param chosen  of the search, or of the trial's branch
CheckedDesign compared(const ChosenAccuracy& chosen,
                       const Trial& trial,
                       bool is_finalist,
                       const RenderRung& rung,
                       const Outcome& dearer);

/// What the rung of a search, or of a branch, is checked with while the search goes on:
/// LadderChoice::second. nullptr: it is the top, or nothing could be judged.
const RenderRung* second_rung(const ChosenAccuracy& chosen);

/// Decides from told trials and recorded checks alone: the same for any number of threads and jobs,
/// and after any kill.
class SearchReview {
 public:
  /// @param chosen  rises with each epoch
  SearchReview(const AccuracyTask& task, AccuracyRecord& record, ChosenAccuracy& chosen);

  /// Takes up the epochs that a resumed search has behind it.
  /// @throws ConfigError when they would be others now; EvaluationAborted; IoError
  void resume(const Storage& storage);

  /// Checks, within kCheckShare of the counted work, the best design so far, then the next best,
  /// then one at random and so on, in the order in which a search could pay for them. Each branch
  /// is looked after as if it were a search of its own. By kPixelRules a design is looked at in
  /// random pixels first, and as a whole where these leave it in doubt, before any other one.
  /// @param told  trials of this epoch, by number
  /// @param left  without time the checks are made and no epoch begins
  /// @return the epoch that begins when a design is beyond the bound and a dearer rung is left that
  ///         renders the designs of its trial; nothing when interrupted
  /// @throws IoError
  std::optional<Event> review(std::span<const Trial> told, TimeLeft left = TimeLeft::kSome);

  const std::vector<CheckedDesign>& checked() const { return checked_; }  ///< of this epoch

  /// Trials that random pixels have left in doubt and whose whole pictures are not paid for yet.
  const std::vector<int>& undecided() const { return undecided_; }

  double work() const;  ///< of these checks, counted

  const std::vector<EndedEpoch>& ended() const { return ended_; }

 private:
  struct Part;

  void check_up_to(std::span<const Trial> told);
  bool is_beyond_with(const Trial& trial, Part& part);
  std::optional<CheckedDesign> next_checked(Part& part, const RenderRung& dearer, double allowed);
  std::optional<CheckedDesign> confirmed(Part& part, const RenderRung& dearer, double work);
  EndedEpoch ended_by(const CheckedDesign& design,
                      const ChosenAccuracy& raised,
                      std::span<const Trial> told) const;
  std::optional<Event> raise(std::span<const Trial> told);
  void stay(const CheckedDesign& design, const ChosenAccuracy& raised);

  const AccuracyTask& task_;
  AccuracyRecord& record_;
  ChosenAccuracy& chosen_;
  std::vector<CheckedDesign> checked_;
  std::vector<int> undecided_;
  std::vector<double> works_;  ///< of these checks, of each part
  std::vector<EndedEpoch> ended_;
  bool has_sampled_checks_ = false;
};

}  // namespace glint

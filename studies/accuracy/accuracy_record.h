// SPDX-License-Identifier: GPL-3.0-or-later
//
// What is known of designs at the rungs of a ladder, beside the search: nothing is evaluated twice,
// neither in a run nor when it is resumed.
#pragma once

#include <map>
#include <mutex>
#include <string>

#include "optimizer/storage/storage.h"

namespace glint {

/// Outcomes by "RUNG | DESIGN", in a database where there is one: a row of kPart for each. Safe to
/// use from several threads.
class AccuracyRecord {
 public:
  /// @param storage  kAccuracyTrials; nullptr: nothing is kept beyond this object
  /// @throws IoError
  explicit AccuracyRecord(Storage* storage);

  /// Stays where it is. nullptr: not known
  const Outcome* find(const std::string& rung, const std::string& design) const;

  /// What is known already stays as it is. @throws IoError
  void keep(const std::string& rung,
            const std::string& design,
            const Point& point,
            const Outcome& outcome);

 private:
  Storage* storage_;
  mutable std::mutex mutex_;
  std::map<std::string, Outcome> known_;
  int last_number_ = 0;
};

/// The name of a search's trial among the designs: "trial 17".
std::string trial_name(int number);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The labels under which study.sqlite keeps each outcome of a search's trial (docs/accuracy.md,
// "Every outcome").
#pragma once

#include <string>

#include "optimizer/storage/storage.h"
#include "studies/definition/study.h"

namespace glint {

/// The rung of what is rendered as the study's [render] says: all of a search without [accuracy].
inline constexpr const char* kOwnRung = "[render]";
/// That of rescoring_settings() of it.
inline constexpr const char* kRescoredRung = "[render], re-scored";

/// Of an evaluation with the search's own random numbers: replicate 0, the seed of the paths.
OutcomeLabel searched_label(const Study& study, const std::string& rung = kOwnRung);

/// Of a design that is re-scored: replicate 1. The seed is that of the paths plus what is added to
/// those of sensor and paths: it tells noise apart where no paths are followed, too.
/// @param scene  of the design, as the search has it
OutcomeLabel rescored_label(const SceneSettings& scene);

/// Of scan number `index` of repeated_settings(): replicate index + 1.
OutcomeLabel repeated_label(const SceneSettings& scene, int index);

/// Keeps what trials of a search gave with other random numbers than the search's. A trial numbered
/// 0 is none: of it nothing is kept.
class FreshOutcomes {
 public:
  /// @param storage  of the search; must outlive it
  explicit FreshOutcomes(Storage& storage) : storage_(storage) {}

  /// Replaces what an earlier run kept. @throws IoError
  void keep(const OutcomeLabel& label, int trial, const Outcome& outcome);

 private:
  Storage& storage_;
};

}  // namespace glint

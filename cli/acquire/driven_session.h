// SPDX-License-Identifier: GPL-3.0-or-later
//
// What all verbs that drive the robot over views share: Ctrl-C, questions to the person at the
// terminal, the progress bar.
#pragma once

#include <atomic>
#include <memory>

#include "cli/acquire/acquire.h"
#include "core/progress.h"
#include "studies/acquire/acquire_run.h"
#include "studies/cell/cell_file.h"

namespace glint {

/// The cell that the arguments name. @throws ConfigError for what is wrong with it, also where
/// --twin names no twin of a device that it has; IoError
Cell driven_cell(const AcquireArguments& arguments);

/// What the arguments say; DrivenSession adds who is asked and told.
/// @throws as driven_cell() where the file of --twin is there
AcquireOptions driven_options(const AcquireArguments& arguments);

class DrivenSession {
 public:
  /// Takes SIGINT and SIGTERM: at the first the arm backs out; at the second the program ends, and
  /// the controller ends the leg that it has.
  /// @param is_silent  no progress bar
  explicit DrivenSession(bool is_silent);

  /// Sets `confirm` where somebody is at the terminal, `lights`, `interrupt` and `progress`.
  /// @param options  must not outlive this
  void attend(AcquireOptions& options);

 private:
  bool is_silent_;
  const std::atomic<int>& interrupts_;
  ConfirmedLights lights_;
  std::unique_ptr<Progress> bar_;
};

}  // namespace glint

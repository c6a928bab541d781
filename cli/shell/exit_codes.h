// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace glint {

/// How the program ends.
enum ExitCode {
  kExitDone = 0,
  kExitNegative = 1,
  kExitUsage = 2,
  kExitIo = 3,
  kExitInternal = 4,
  kExitInterrupted = 130
};

}  // namespace glint

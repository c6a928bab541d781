// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

#include "hardware/twin/robot/script_program.h"

namespace glint {

/// The threads of one program that run beside it.
class ScriptThreads {
 public:
  /// "x = run beat()" of that program. @return false: there is no such thread, or too many run
  /// already
  bool start(const ScriptProgram& program, const ScriptStatement& run);

  /// "kill x": what does not run is left alone.
  void kill(const ScriptStatement& kill);

  void clear() { running_.clear(); }

  /// The statements whose time has come, of all threads, up to the next sleep of each: at most one
  /// round of a loop.
  std::vector<ScriptStatement> advance(double dt_s);

 private:
  struct Running {
    std::string variable;
    ScriptThread thread;
    std::size_t next = 0;
    double sleep_s = 0.0;
  };

  static void advance_one(Running& running, double dt_s, std::vector<ScriptStatement>& due);

  std::vector<Running> running_;
};

}  // namespace glint

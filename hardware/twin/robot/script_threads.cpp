// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/twin/robot/script_threads.h"

#include <algorithm>

namespace glint {

bool ScriptThreads::start(const ScriptProgram& program, const ScriptStatement& run) {
  constexpr std::size_t kMaxThreads = 8;
  const auto thread =
      std::ranges::find(program.threads, run.arguments.at(0).name, &ScriptThread::name);
  if (thread == program.threads.end() || running_.size() == kMaxThreads) {
    return false;
  }
  running_.push_back({.variable = run.arguments.at(1).name, .thread = *thread});
  return true;
}

void ScriptThreads::kill(const ScriptStatement& kill) {
  std::erase_if(running_, [&kill](const Running& running) {
    return running.variable == kill.arguments.at(0).name;
  });
}

std::vector<ScriptStatement> ScriptThreads::advance(double dt_s) {
  std::vector<ScriptStatement> due;
  for (Running& running : running_) {
    advance_one(running, dt_s, due);
  }
  return due;
}

void ScriptThreads::advance_one(Running& running, double dt_s, std::vector<ScriptStatement>& due) {
  const std::vector<ScriptStatement>& statements = running.thread.statements;
  running.sleep_s = std::max(0.0, running.sleep_s - dt_s);
  for (std::size_t i = 0; i < statements.size() && running.sleep_s == 0.0; ++i) {
    if (running.next == statements.size()) {
      if (!running.thread.is_loop) {
        return;
      }
      running.next = 0;
    }
    const ScriptStatement& statement = statements[running.next];
    ++running.next;
    if (statement.function == "sleep") {
      running.sleep_s = std::max(0.0, statement.number("t", 0, 0.0));
    } else {
      due.push_back(statement);
    }
  }
}

}  // namespace glint

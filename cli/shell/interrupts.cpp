// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/shell/interrupts.h"

#include <unistd.h>

#include <csignal>

#include "cli/shell/exit_codes.h"

namespace glint {
namespace {

/// A signal handler can reach nothing but a global.
std::atomic<int> interrupt_count = 0;

void count_interrupt(int /*signal*/) {
  if (interrupt_count.fetch_add(1) >= 1) {
    ::_exit(kExitInterrupted);
  }
}

}  // namespace

const std::atomic<int>& take_interrupts() {
  std::signal(SIGINT, count_interrupt);
  std::signal(SIGTERM, count_interrupt);
  // A terminal that is closed, but where nohup lets the program go on.
  if (std::signal(SIGHUP, count_interrupt) == SIG_IGN) {
    std::signal(SIGHUP, SIG_IGN);
  }
  return interrupt_count;
}

void keep_attending() {
  for (const int signal : {SIGPIPE, SIGTSTP, SIGTTOU}) {
    std::signal(signal, SIG_IGN);
  }
}

}  // namespace glint

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
  return interrupt_count;
}

}  // namespace glint

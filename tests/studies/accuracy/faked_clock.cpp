// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/studies/accuracy/faked_clock.h"

#include <atomic>
#include <cstdint>
#include <ctime>

#include <sys/syscall.h>
#include <unistd.h>

namespace glint::test {
namespace {

std::atomic<bool> is_faked = false;
std::atomic<int> looks_so_far = 0;
std::atomic<std::uint32_t> state = 1;
std::atomic<std::int64_t> now_s = 0;

std::int64_t jump_s() {
  constexpr std::uint32_t kMaxJump_s = 5000;
  const std::uint32_t next = state * 1664525U + 1013904223U;  // Numerical Recipes
  state = next;
  return 1 + (next >> 8) % kMaxJump_s;
}

}  // namespace

FakedClock::FakedClock(unsigned seed) {
  state = seed;
  looks_so_far = 0;
  timespec real = {};
  ::syscall(SYS_clock_gettime, CLOCK_MONOTONIC, &real);
  now_s = real.tv_sec;
  is_faked = true;
}

FakedClock::~FakedClock() {
  is_faked = false;
}

int FakedClock::looks() {
  return looks_so_far;
}

}  // namespace glint::test

/// In place of the C library's, for all libraries of this program.
extern "C" int clock_gettime(clockid_t clock, timespec* time) noexcept {
  using namespace glint::test;  // NOLINT: what is faked stands above
  if (!is_faked) {
    return static_cast<int>(::syscall(SYS_clock_gettime, clock, time));
  }
  ++looks_so_far;
  now_s += jump_s();
  *time = {.tv_sec = now_s, .tv_nsec = 0};
  return 0;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <ctime>

namespace glint {

/// CPU seconds since some moment, of this thread alone or of the whole process.
inline double cpu_s(clockid_t clock) {
  timespec now = {};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

inline double thread_cpu_s() {
  return cpu_s(CLOCK_THREAD_CPUTIME_ID);
}

inline double process_cpu_s() {
  return cpu_s(CLOCK_PROCESS_CPUTIME_ID);
}

/// The least CPU time of this thread for doing the work: at least `repeats` times, and again until
/// all of them together took total_s, or ten times as often.
template <class Work>
double min_cpu_s(int repeats, double total_s, const Work& work) {
  double minimum = 0.0;
  double sum = 0.0;
  for (int i = 0; i < repeats || (sum < total_s && i < 10 * repeats); ++i) {
    const double start = thread_cpu_s();
    work();
    const double taken = thread_cpu_s() - start;
    minimum = i == 0 ? taken : std::min(minimum, taken);
    sum += taken;
  }
  return minimum;
}

}  // namespace glint

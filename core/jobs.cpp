// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/jobs.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>
#include <vector>

namespace glint {

void run_jobs(std::size_t count,
              int jobs,
              const std::function<void(std::size_t)>& work,
              const std::function<bool()>& is_ended) {
  std::atomic<std::size_t> next = 0;
  std::atomic<bool> has_error = false;
  std::vector<std::exception_ptr> errors(count);
  const auto run = [&] {
    while (!has_error && !is_ended()) {
      const std::size_t i = next++;
      if (i >= count) {
        return;
      }
      try {
        work(i);
      } catch (...) {
        errors[i] = std::current_exception();
        has_error = true;
      }
    }
  };
  {
    std::vector<std::jthread> helpers;
    const auto wanted = static_cast<std::size_t>(std::max(1, jobs));
    for (std::size_t i = 1; i < std::min(count, wanted); ++i) {
      helpers.emplace_back(run);
    }
    run();
  }
  for (const std::exception_ptr& error : errors) {
    if (error) {
      std::rethrow_exception(error);
    }
  }
}

}  // namespace glint

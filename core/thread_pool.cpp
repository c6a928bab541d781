// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/thread_pool.h"

#include <algorithm>
#include <thread>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "core/error.h"
#include "core/jobs.h"

namespace glint {

struct ThreadPool::Arena {
  explicit Arena(int num_threads)
      : limit(tbb::global_control::max_allowed_parallelism,
              static_cast<std::size_t>(std::max(num_threads, hardware_threads()))),
        arena(num_threads) {}

  tbb::global_control limit;  ///< more threads than cores are allowed when asked for
  tbb::task_arena arena;
};

ThreadPool::ThreadPool(int num_threads) {
  GLINT_CHECK(num_threads >= 1, "a pool needs a thread");
  arena_ = std::make_unique<Arena>(num_threads);
}

ThreadPool::~ThreadPool() = default;

int ThreadPool::num_threads() const {
  return arena_->arena.max_concurrency();
}

void ThreadPool::for_each(std::int64_t count, const std::function<void(std::int64_t)>& body) {
  if (num_threads() == 1) {
    for (std::int64_t i = 0; i < count; ++i) {
      body(i);
    }
    return;
  }
#ifdef __SANITIZE_THREAD__
  // oneTBB is not instrumented: a thread sanitizer does not see how its threads wait for each
  // other.
  run_jobs(static_cast<std::size_t>(count), num_threads(), [&](std::size_t i) {
    body(static_cast<std::int64_t>(i));
  });
#else
  arena_->arena.execute([&] {
    // Else a thread that waits for the last bodies may begin one of another loop in the meantime.
    tbb::this_task_arena::isolate([&] {
      tbb::parallel_for(
          tbb::blocked_range<std::int64_t>(0, count, 1),
          [&](const tbb::blocked_range<std::int64_t>& range) {
            for (std::int64_t i = range.begin(); i != range.end(); ++i) {
              body(i);
            }
          },
          tbb::simple_partitioner());
    });
  });
#endif
}

int hardware_threads() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/thread_pool.h"

#include <algorithm>
#include <thread>

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include "core/error.h"

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#define GLINT_UNWATCHED __attribute__((no_sanitize("thread")))
#else
#define GLINT_UNWATCHED
#endif

namespace glint {
namespace {

/// oneTBB is not instrumented: tells a thread sanitizer that what was written before done() is
/// there for whoever called wait() after it. Nothing in other builds.
struct Order {
#ifdef __SANITIZE_THREAD__
  void done() {
    __tsan_release(this);
  }

  void wait() {
    __tsan_acquire(this);
  }
#else
  void done() {}

  void wait() {}
#endif
};

/// What all threads of a loop share.
struct Loop {
  const std::function<void(std::int64_t)>& body;
  Order begin = {};
  Order end = {};

  void run(std::int64_t first, std::int64_t last) {
    begin.wait();
    for (std::int64_t i = first; i != last; ++i) {
      body(i);
    }
    end.done();
  }
};

/// What oneTBB copies from thread to thread: one pointer, which a thread sanitizer does not watch.
class LoopBody {
 public:
  explicit LoopBody(Loop& loop) : loop_(&loop) {}

  GLINT_UNWATCHED void operator()(const tbb::blocked_range<std::int64_t>& range) const {
    loop_->run(range.begin(), range.end());
  }

 private:
  Loop* loop_;
};

}  // namespace

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
  Loop loop = {.body = body};
  loop.begin.done();
  arena_->arena.execute([&] {
    // Else a thread that waits for the last bodies may begin one of another loop in the meantime.
    tbb::this_task_arena::isolate([&] {
      tbb::parallel_for(
          tbb::blocked_range<std::int64_t>(0, count, 1), LoopBody(loop), tbb::simple_partitioner());
    });
  });
  loop.end.wait();
}

int hardware_threads() {
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

}  // namespace glint

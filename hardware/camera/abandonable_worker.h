// SPDX-License-Identifier: GPL-3.0-or-later
//
// A thread for calls that may block far longer than their caller can wait.
#pragma once

#include <chrono>
#include <exception>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

namespace glint {

/// Does one task after the other. Whoever waits for one in vain drops the worker: its thread then
/// finishes what it is at, lets go of everything that its tasks hold, and ends by itself.
class AbandonableWorker {
 public:
  using Clock = std::chrono::steady_clock;

  AbandonableWorker();
  ~AbandonableWorker();  ///< does not wait
  AbandonableWorker(const AbandonableWorker&) = delete;
  AbandonableWorker& operator=(const AbandonableWorker&) = delete;

  /// Calls it on the thread; must own all it uses. Exceptions come out here.
  /// @return empty: it has not ended by then, and goes on
  template <class Function>
  auto call(Function function, Clock::time_point until) {
    using Result = std::invoke_result_t<Function>;
    auto task = std::make_shared<std::packaged_task<Result()>>(std::move(function));
    std::future<Result> result = task->get_future();
    post([task]() mutable {
      (*task)();
      task.reset();
    });
    const bool is_ready = result.wait_until(until) == std::future_status::ready;
    if constexpr (std::is_void_v<Result>) {
      if (is_ready) {
        result.get();
      }
      return is_ready;
    } else {
      return is_ready ? std::optional<Result>(result.get()) : std::nullopt;
    }
  }

 private:
  struct Queue;

  void post(std::function<void()> task);

  std::shared_ptr<Queue> queue_;
};

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <type_traits>
#include <vector>

namespace glint {

/// A fixed number of worker threads (a oneTBB arena), passed down by whoever owns the program.
///
/// Work is cut into chunks by the caller, never by the number of threads, and partial results are
/// combined in index order: results are the same bytes for any number of threads.
class ThreadPool {
 public:
  explicit ThreadPool(int num_threads);  ///< >= 1
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  int num_threads() const;

  /// Calls body(i) once for each i in [0, count), in any order. Until all are done the thread does
  /// nothing else, so that a caller may hold a lock. The first exception is rethrown here.
  void for_each(std::int64_t count, const std::function<void(std::int64_t)>& body);

  /// {f(0), f(1), ...} in that order, computed in any order.
  template <class Result, class Function>
  std::vector<Result> map(std::int64_t count, const Function& f) {
    static_assert(!std::is_same_v<Result, bool>, "neighbours in std::vector<bool> share a byte");
    std::vector<Result> results(static_cast<std::size_t>(count));
    for_each(count, [&](std::int64_t i) { results[static_cast<std::size_t>(i)] = f(i); });
    return results;
  }

 private:
  struct Arena;
  std::unique_ptr<Arena> arena_;
};

/// The number of threads the machine offers, at least 1.
int hardware_threads();

}  // namespace glint

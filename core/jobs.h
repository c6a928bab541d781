// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>

namespace glint {

/// Calls work(i) for i = 0, 1, ... count - 1, several at a time, on threads of its own: work that
/// waits for a value which another thread makes, or uses the thread pool itself, must not begin
/// another piece meanwhile, as a pool would let it. The number of jobs is not bound by that of the
/// pool's threads.
/// @param jobs  at a time; the caller's thread is one of them. Below 1: 1
/// @param is_ended  asked before each piece, from all threads: true leaves the rest out
/// @throws what work() has thrown for the smallest i; pieces that were not begun are left out then
void run_jobs(
    std::size_t count,
    int jobs,
    const std::function<void(std::size_t)>& work,
    const std::function<bool()>& is_ended = [] { return false; });

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/camera/abandonable_worker.h"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>

namespace glint {

struct AbandonableWorker::Queue {
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::function<void()>> tasks;
  bool is_dropped = false;
};

AbandonableWorker::AbandonableWorker() : queue_(std::make_shared<Queue>()) {
  std::thread([queue = queue_] {
    for (;;) {
      std::function<void()> task;
      {
        std::unique_lock lock(queue->mutex);
        queue->changed.wait(lock, [&] { return queue->is_dropped || !queue->tasks.empty(); });
        if (queue->tasks.empty()) {
          return;
        }
        task = std::move(queue->tasks.front());
        queue->tasks.pop_front();
      }
      task();
    }
  }).detach();
}

AbandonableWorker::~AbandonableWorker() {
  const std::scoped_lock lock(queue_->mutex);
  queue_->is_dropped = true;
  queue_->changed.notify_all();
}

void AbandonableWorker::post(std::function<void()> task) {
  const std::scoped_lock lock(queue_->mutex);
  queue_->tasks.push_back(std::move(task));
  queue_->changed.notify_all();
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/ask_tell_thread.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <utility>

#include "core/error.h"

namespace glint {

/// All that both threads touch; kept alive by whichever ends last.
struct AskTellThread::Shared {
  enum class Turn { kBody, kOwner };

  std::mutex mutex;
  std::condition_variable changed;
  Turn turn = Turn::kBody;
  bool is_stopping = false;
  bool is_finished = false;
  std::vector<double> point;
  Answer answer;
  std::string ending;

  std::optional<Answer> call(const std::vector<double>& x) {
    std::unique_lock lock(mutex);
    if (is_stopping) {
      return std::nullopt;
    }
    point = x;
    turn = Turn::kOwner;
    changed.notify_all();
    changed.wait(lock, [this] { return turn == Turn::kBody || is_stopping; });
    if (is_stopping) {
      return std::nullopt;
    }
    return answer;
  }

  void finish(std::string why) {
    const std::lock_guard lock(mutex);
    ending = std::move(why);
    is_finished = true;
    changed.notify_all();
  }
};

AskTellThread::AskTellThread(Body body, double patience_s)
    : shared_(std::make_shared<Shared>()), patience_s_(patience_s) {
  thread_ = std::thread([shared = shared_, run = std::move(body)] {
    std::string why;
    try {
      why = run([&shared](const std::vector<double>& x) { return shared->call(x); });
    } catch (const std::exception& e) {
      why = e.what();
    }
    shared->finish(std::move(why));
  });
}

AskTellThread::~AskTellThread() {
  if (thread_.joinable() && !stop()) {
    abandon();
  }
}

AskTellThread::Status AskTellThread::ask() {
  if (!thread_.joinable()) {
    return end_;
  }
  std::unique_lock lock(shared_->mutex);
  const bool has_answered =
      shared_->changed.wait_for(lock, std::chrono::duration<double>(patience_s_), [this] {
        return shared_->is_finished || shared_->turn == Shared::Turn::kOwner;
      });
  if (!has_answered) {
    lock.unlock();
    abandon();
    return Status::kAbandoned;
  }
  if (shared_->is_finished) {
    ending_ = shared_->ending;
    lock.unlock();
    thread_.join();
    end_ = Status::kFinished;
    return end_;
  }
  point_ = shared_->point;
  return Status::kAsked;
}

void AskTellThread::tell(Answer answer) {
  const std::lock_guard lock(shared_->mutex);
  GLINT_CHECK(shared_->turn == Shared::Turn::kOwner, "tell() answers an ask()");
  shared_->answer = std::move(answer);
  shared_->turn = Shared::Turn::kBody;
  shared_->changed.notify_all();
}

bool AskTellThread::stop() {
  if (!thread_.joinable()) {
    return true;
  }
  std::unique_lock lock(shared_->mutex);
  shared_->is_stopping = true;
  shared_->changed.notify_all();
  const bool has_ended = shared_->changed.wait_for(
      lock, std::chrono::duration<double>(patience_s_), [this] { return shared_->is_finished; });
  if (!has_ended) {
    return false;
  }
  ending_ = shared_->ending;
  lock.unlock();
  thread_.join();
  end_ = Status::kFinished;
  return true;
}

void AskTellThread::abandon() {
  if (!thread_.joinable()) {
    return;
  }
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->is_stopping = true;
    shared_->changed.notify_all();
  }
  thread_.detach();
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Turns an optimiser that calls a function into one that is asked and told: it runs on a thread of
// its own and stops at each call until the value is told.
//
// It never waits without a way out. An optimiser that does not ask within the patience is
// abandoned: its thread is detached, holds only state it shares by shared_ptr, and ends by itself
// if it ever calls again.
//
// The hand-over is a mutex and a condition variable, not std::counting_semaphore: libstdc++ 12's
// can sleep for ever (GCC bug 104928).
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "optimizer/algorithm/answer.h"

namespace glint {

class AskTellThread {
 public:
  /// Evaluates a point; empty means: stop now and return. Valid only on the body's thread.
  /// Derivatives are by the coordinates of that point.
  using Call = std::function<std::optional<Answer>(const std::vector<double>&)>;
  /// The optimiser. Returns, or throws, when it has finished; the text says why.
  using Body = std::function<std::string(const Call&)>;

  enum class Status {
    kAsked,     ///< point() holds what it wants to know
    kFinished,  ///< it has nothing more to ask; ending() says why
    kAbandoned  ///< it did not answer in time
  };

  /// @param patience_s  > 0: how long an answer may take
  AskTellThread(Body body, double patience_s);
  /// Returns within the patience, whatever the body does.
  ~AskTellThread();
  AskTellThread(const AskTellThread&) = delete;
  AskTellThread& operator=(const AskTellThread&) = delete;

  /// Waits for the next question.
  Status ask();
  /// Answers it. Must follow an ask() that gave kAsked.
  void tell(Answer answer);
  /// Asks the body to end; true when it did so within the patience. After that, or after
  /// abandoning, ask() gives kFinished or kAbandoned only.
  bool stop();
  /// Leaves the body behind without waiting.
  void abandon();

  const std::vector<double>& point() const { return point_; }

  const std::string& ending() const { return ending_; }

 private:
  struct Shared;

  std::shared_ptr<Shared> shared_;
  std::thread thread_;
  Status end_ = Status::kAbandoned;  ///< what ask() gives once the thread is gone
  double patience_s_;
  std::vector<double> point_;
  std::string ending_;
};

}  // namespace glint

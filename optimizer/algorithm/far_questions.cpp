// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/far_questions.h"

#include <algorithm>

namespace glint {
namespace {

constexpr std::uint64_t kAsksPerFarOne = 4;
constexpr std::uint64_t kMaxFarWait = 32;

}  // namespace

bool FarQuestions::is_due(std::uint64_t asks) const {
  return has_patience_ ? asks >= next_ : asks % kAsksPerFarOne == 0;
}

void FarQuestions::note(const Point& point, std::uint64_t asks) {
  if (has_patience_) {
    pending_.push_back(point);
    next_ = asks + wait_;
  }
}

void FarQuestions::judge(const Point& point, bool keeps_limits) {
  if (pending_.empty() || pending_.front() != point) {
    return;
  }
  pending_.pop_front();
  const std::uint64_t wait = keeps_limits ? kAsksPerFarOne : std::min(kMaxFarWait, 2 * wait_);
  next_ = next_ - wait_ + wait;
  wait_ = wait;
}

}  // namespace glint

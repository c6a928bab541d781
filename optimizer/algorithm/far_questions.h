// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which of a search's questions reach everywhere; the others stay near what is known to be good.
//
// By rules 5 every fourth one does. By rules 6, with several objectives and limits, one whose
// design misses a limit or fails makes the next one wait twice as long, up to 32 questions, and one
// within the limits makes the wait four again. An objective that follows from the design alone
// promises most where no model knows that nothing is allowed there: in corners, again and again.
#pragma once

#include <cstdint>
#include <deque>

#include "optimizer/problem/space.h"

namespace glint {

class FarQuestions {
 public:
  /// @param has_patience  by rules 6
  explicit FarQuestions(bool has_patience) : has_patience_(has_patience) {}

  /// @param asks  questions so far
  bool is_due(std::uint64_t asks) const;
  /// The question that was due has this design.
  void note(const Point& point, std::uint64_t asks);
  /// A design was told, in the order of asking; of others than those noted nothing follows.
  void judge(const Point& point, bool keeps_limits);

 private:
  bool has_patience_ = false;
  std::uint64_t next_ = 0;  ///< not before so many asks
  std::uint64_t wait_ = 4;  ///< asks from one to the next
  std::deque<Point> pending_;
};

}  // namespace glint

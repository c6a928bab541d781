// SPDX-License-Identifier: GPL-3.0-or-later
//
// Which trigger a picture belongs to. A camera numbers its pictures one after the other, so within
// one stream each trigger has one id, which its first picture fixes. Ids of 16 bits run from 1 to
// 65535 and begin again, 0 is left out.
#pragma once

#include <cstdint>
#include <optional>

namespace glint {

enum class FrameAge {
  kOfThisTrigger,
  kLate,  ///< of an older trigger
  kAhead  ///< of no trigger that was sent: the count is lost
};

class TriggerIds {
 public:
  /// A trigger is sent; its picture has the id after that of the last one.
  void triggered();

  /// @param frame_id  of a picture that has come in after triggered()
  FrameAge judge(std::uint64_t frame_id);

 private:
  std::optional<std::uint64_t> expected_;  ///< of the last trigger; empty: no picture came yet
  std::uint64_t triggers_ = 0;             ///< before the first picture
};

}  // namespace glint

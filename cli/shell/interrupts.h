// SPDX-License-Identifier: GPL-3.0-or-later
//
// Ctrl-C during long work, and while a robot is driven.
#pragma once

#include <atomic>

namespace glint {

/// Takes SIGINT and SIGTERM from now on: the first is for whoever watches the count, at the second
/// the program ends at once: what was finished is recorded already, and a robot's controller ends
/// the motion that it has.
/// @return how many have come
const std::atomic<int>& take_interrupts();

}  // namespace glint

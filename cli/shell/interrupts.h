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

/// From now on a reader of the output who has gone (`| head`) does not end the program, and neither
/// Ctrl-Z nor writing from the background halts it: for work that has to be attended, as an arm on
/// its way is.
void keep_attending();

}  // namespace glint

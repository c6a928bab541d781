// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "hardware/robot/motion_permit.h"

namespace glint {

/// Sets standard digital outputs of a controller by an input recipe of RTDE, and waits until the
/// controller tells them as set. Connects for this alone, as inputs that are held are taken from
/// everybody else; outputs stay as they are when it is gone.
/// @param mask    bit i: output i is set, the others stay
/// @param values  bit i: on
/// @param permit  a cell's outputs may switch more than lights
/// @throws IoError: nobody there, another client holds the inputs, or the outputs do not follow
void set_digital_outputs(const std::string& host,
                         int rtde_port,
                         std::uint8_t mask,
                         std::uint8_t values,
                         const MotionPermit& permit,
                         double timeout_s = 2.0);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The closed forms of OpenCV, to select by name and to compare with. OpenCV is included in the .cpp
// alone.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string_view>

#include "hardware/calibration/robust_hand_eye.h"

namespace glint {

/// Five methods for A X = X B and two that find the board in the same step.
enum class HandEyeMethod { kTsai, kPark, kHoraud, kAndreff, kDaniilidis, kShah, kLi };

inline constexpr std::array<HandEyeMethod, 7> kHandEyeMethods = {HandEyeMethod::kTsai,
                                                                 HandEyeMethod::kPark,
                                                                 HandEyeMethod::kHoraud,
                                                                 HandEyeMethod::kAndreff,
                                                                 HandEyeMethod::kDaniilidis,
                                                                 HandEyeMethod::kShah,
                                                                 HandEyeMethod::kLi};

/// "tsai", "park", "horaud", "andreff", "daniilidis", "shah", "li".
std::string_view name_of(HandEyeMethod method);

/// Inverse of name_of().
std::optional<HandEyeMethod> hand_eye_method(std::string_view name);

/// What a method makes of the pictures; the board is the mean of what all pictures say with the
/// method's hand-eye. Fed metres: Andreff's and Li's results depend on the unit. Empty when the
/// method throws or gives no finite motion. Wrong pictures are not looked for.
/// @param pairs  at least 3
std::optional<HandEye> hand_eye_by(HandEyeMethod method,
                                   Mounting mounting,
                                   std::span<const PosePair> pairs);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a solved hand-eye says against its pictures, its poses and its board, in words.
#pragma once

#include <cstddef>
#include <string>

#include "hardware/calibration/hand_eye_work.h"

namespace glint {

/// What may be wrong with poses that contradict the pictures.
inline constexpr const char* kHandEyeContradiction =
    "other order, unit, direction or rotation than assumed, or the board or the camera has moved";

/// Tells of each rejected picture by how much its robot pose is off, and whose pose would fit.
void explain_rejections(HandEyeWork& work);

/// Pictures with a board whose robot pose disagrees.
std::ptrdiff_t num_rejected(const HandEyeWork& work);

/// Whether so many pictures with a board are rejected (15 %) that the fault may be one of all.
bool rejects_many(const HandEyeWork& work);

/// Whether the robot's error of place and rotation makes more than 0.2 % of the distance to the
/// board there.
bool has_large_errors(const HandEyeWork& work);

/// Why the solution is of no use; empty when it is.
std::string refusal_of_solution(const HandEyeWork& work);

/// The place in the row of pictures where board or camera moved, looked for when many pictures, or
/// much of all, disagree; empty when nothing has moved.
std::string refusal_of_moves(const HandEyeWork& work);

/// Whether squares of another size than given may explain what is wrong: a refusal, rejected
/// pictures, or a size that one further step of least squares finds 2 sigma off.
bool may_have_other_squares(const HandEyeWork& as_given);

/// Whether the solution with a free size shows that the squares are of another one: off by 3 sigma
/// (more while few pictures tell sigma) and by 0.03 % in at least 10 pictures, the robot's error
/// small enough for a ruler (0.2 % of the distance), no more pictures rejected.
bool has_other_squares(const HandEyeWork& as_given, const HandEyeWork& with_free_size);

/// Of squares that are off by more than 0.5 %: by how much, and what they would be. Empty below.
std::string refusal_of_squares(const HandEyeWork& with_free_size);

/// Of squares that are off by less: that they were taken as the robot's motion says.
std::string note_of_squares(const HandEyeWork& with_free_size);

/// Names a robot whose poses are off by more than 0.2 % of the distance, and what a free size of
/// the squares would leave of it; empty when they are better.
/// @param with_free_size  nullptr: not solved
std::string note_of_robot(const HandEyeWork& as_given, const HandEyeWork* with_free_size);

/// Adds what is weak or odd.
void add_warnings(HandEyeWork& work);

}  // namespace glint

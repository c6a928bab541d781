// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a note of the program tells of: a ripple of the flawless surface excuses a wrong h, no wrong
// contrast.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "studies/definition/scene_notes.h"

namespace glint::stability {

/// A kind of note, and the quantities of a cell (CellError::quantity) that it tells may be wrong.
struct NoteCoverage {
  NoteKind kind = NoteKind::kScene;
  std::vector<std::string_view> quantities;
};

/// All notes that tell of an error. Any other one describes the scene.
const std::vector<NoteCoverage>& note_coverages();

/// Texts of those of the notes that tell that the quantity may be wrong.
std::vector<std::string> told_of(std::string_view quantity, std::span<const SceneNote> notes);

}  // namespace glint::stability

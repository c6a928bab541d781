// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sentences about how a scene is lit and rendered, for reports and drawings.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "metrics/scores.h"
#include "studies/definition/scene.h"

namespace glint {

/// What each light is called: "ring", and with its name in front where that is not its type:
/// "upper: ring".
std::vector<std::string> light_titles(const SceneSettings& scene);

/// One line about each light: "ring, radii 25 to 40 mm, at 30 mm, on the camera", its title in
/// front.
std::vector<std::string> light_lines(const SceneSettings& scene);

/// How many images the tunnel's scan takes; empty without a tunnel.
std::string scan_line(const SceneSettings& scene);

/// What a note tells of the numbers beside it.
enum class NoteKind {
  kScene,           ///< how the scene is lit and rendered: nothing is wrong
  kRipple,          ///< the scan leaves a ripple on the flawless surface
  kOccluded,        ///< the tunnel's wall occludes pixels, which are dark
  kSaturated,       ///< pixels are at full scale in every frame
  kRepeatedBorder,  ///< a wide blur repeats the pixels of the border
  kCoarseCells,     ///< pixels of a strongly bent part have few cells
  kFrameNoise,      ///< the change of a defect in its best frame holds the noise of a frame
  kFineStripes,     ///< stripes that pixels cannot separate
  kDefectStripes,   ///< the same, in the middle of a defect
  kNarrowDefect     ///< a defect is hardly wider than a pixel
};

/// Remark on a scene that a reader of its numbers must know.
struct SceneNote {
  NoteKind kind = NoteKind::kScene;
  std::string text;  ///< sentences

  bool operator==(const SceneNote&) const = default;
};

/// @param scores  of the scene
std::vector<SceneNote> scene_notes(const SceneSettings& scene, const Scores& scores);

/// What reports and files show of notes.
std::vector<std::string> note_texts(std::span<const SceneNote> notes);

}  // namespace glint

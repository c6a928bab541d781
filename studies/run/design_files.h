// SPDX-License-Identifier: GPL-3.0-or-later
//
// The folder of one design in a run directory:
//
//   scene.toml  sequence/frame_000.png ...  aspect.png  aspect.exr  part_mask.png  defects.json
//   scores.json  cross_section.svg  cross_section.dxf
//   cross_section.csv (of a tunnel: points and radii of its wall)
//
// scores.json holds { title, role, trial, feasible, scores, rescored, rendering, variables, notes
// }. rendering tells how pictures and scores came about:
//
//   frames                    "integrated" | "sampled" | "paths": the written sequence
//   samples, batches,         of "paths": a pixel, independent pictures they are divided into,
//   max_reflections           on the part
//   search_form               "floors" | "table" | "frames": how a search gets the mean of this
//   scan;
//                             this and what follows only where render.method is auto or closed
//   table_pixels              of the region: by formula, or dark in every frame
//   frame_pixels              rendered frame by frame, around the defects too where they are scored
//   h_rms_difference_points   closed form minus full sequence, hundredths of homogeneity.h_rms
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "optimizer/problem/trial.h"
#include "studies/evaluation/evaluation.h"
#include "studies/imaging/path_warnings.h"

namespace glint {

/// Sees how a design is written.
struct DesignWatch {
  std::function<void(int frames)> on_frame = {};  ///< after each frame, with how many there are
  std::function<void()> on_rescoring = {};        ///< before it is scored again
  std::function<void(const Outcome& outcome)> on_rescored = {};  ///< with what that gave
  double rescoring_cpu_s = 0.0;                                  ///< grows by what that takes
};

/// Renders and scores a design, re-scores it with fresh seeds and finer sampling, and writes its
/// folder. @throws IoError, ConfigError
/// @param head    title, role, trial, feasible, variables: what only the caller knows
/// @param wanted  the scores that a search of this study looks at
/// @param watch   nullptr: nobody looks
/// @return the object of scores.json
nlohmann::ordered_json write_design(SceneStore& store,
                                    const SceneSettings& scene,
                                    const nlohmann::ordered_json& head,
                                    const std::filesystem::path& folder,
                                    bool is_rescored,
                                    const WantedScores& wanted,
                                    DesignWatch* watch = nullptr);

/// Drawings of a lighting, as files of the same stem.
struct LightingDrawing {
  std::string svg;
  std::string dxf;
  std::string csv;  ///< the wall's arcs; empty: there is no wall
};

/// The lighting to scale: area lights where they stand, else the tunnel's cross-section.
/// @param area_lights  SceneLamps::area_lights()
LightingDrawing draw_lighting(const SceneSettings& scene,
                              const PhysicalScene* area_lights,
                              const BuiltPart& built,
                              const std::string& title);

/// The SVG of it, of a design that was evaluated. @param scene  of a single view
std::string drawing_svg(const SceneSettings& scene,
                        const Evaluation& evaluation,
                        const std::string& title);

/// Remarks on a design that a reader of its numbers must know.
/// @param lamps  of the scene
std::vector<std::string> notes_of(const SceneSettings& scene,
                                  const Scores& scores,
                                  const SceneLamps& lamps);

/// How a search gets the mean of this scan, as one sentence; empty when it renders all frames.
std::string rendering_note(const nlohmann::ordered_json& rendering);

/// Scores as a JSON object, in alphabetical order.
nlohmann::ordered_json scores_json(const Scores& scores);

}  // namespace glint

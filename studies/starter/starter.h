// SPDX-License-Identifier: GPL-3.0-or-later
//
// `glint new`: a study to start from. It maximises how far the worst defect stands out, with
// homogeneity and clipping as limits. Its dent lies where it has been seen to show: dents are tried
// at several places at once, made steeper where none shows, and scored under other lightings of the
// study's variables where the start does not show them.
#pragma once

#include <string>
#include <vector>

#include "simulator/geometry/part/part.h"
#include "studies/starter/starter_plan.h"

namespace glint {

struct StarterRequest {
  PartSettings part;
  std::string part_file;  ///< as the study is to name it
  std::string unit = "mm";
  std::string study_file;   ///< where the study is to lie; its folder need not be there
  std::string camera_keys;  ///< TOML lines of a data sheet; empty: one that shows the whole part
  double working_distance_mm = 600.0;
  StarterLight light = StarterLight::kTunnel;
  int threads = 1;
};

struct Starter {
  std::string text;                ///< TOML
  std::vector<std::string> notes;  ///< what the user should know, sentences
  double start_score = 0.0;        ///< of objective_of(), at the start
  bool is_dent_visible = true;     ///< at the start, or under a lighting that was tried
};

/// The score of objective_of() from which on a defect is told from its background: Rose's criterion
/// asks for three to five times the noise.
double visible_score(StarterLight light);

/// @throws ConfigError when the light does not fit, or no place of the part is seen and lit;
/// IoError
Starter make_starter(const StarterRequest& request);

}  // namespace glint

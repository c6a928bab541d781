// SPDX-License-Identifier: GPL-3.0-or-later
//
// A study whose light is a tunnel over a mirror or a ring, with evaluations that are made up.
#pragma once

#include <string>

#include "studies/definition/ladder/render_ladder.h"
#include "studies/definition/study.h"
#include "tests/studies/plate_under_two_lights.h"

namespace glint::test {

inline constexpr const char* kBranchScore = "homogeneity.mean";
inline constexpr std::size_t kTunnelBranch = 0;
inline constexpr std::size_t kRingBranch = 1;

/// The ring may be searched by 8 or 16 samples, and is compared with 64.
/// @param accuracy  the rest of that table
inline std::string branch_study(const std::string& accuracy) {
  return kPlateUnderTwoLights + std::string(R"([variables]
lighting_use = { choices = ["tunnel", "ring"] }
"sensor.gain" = { min = 0.5, max = 2 }
[objective]
maximise = "homogeneity.mean"
[search]
algorithm = "random"
[budget]
evaluations = 90
[accuracy]
)") + accuracy +
         "\n";
}

/// The same with a choice of the material: under the tunnel only a mirror has closed forms.
inline std::string two_choices_study(const std::string& accuracy) {
  std::string text = branch_study(accuracy);
  text.insert(text.find("[objective]"),
              "\"material.type\" = { choices = [\"mirror\", \"diffuse\"] }\n");
  return text;
}

/// Values of a design of those studies.
struct BranchDesign {
  bool is_ring = false;
  double gain = 0.0;
  bool is_diffuse = false;  ///< of two_choices_study()
};

inline BranchDesign branch_design(const Overrides& overrides) {
  constexpr std::size_t kMaterial = 2;
  return {
      .is_ring = overrides.at(0).second.text == "ring",
      .gain = overrides.at(1).second.number,
      .is_diffuse = overrides.size() > kMaterial && overrides[kMaterial].second.text == "diffuse"};
}

/// 1 or -1, as if at random.
inline double branch_sign(double gain) {
  return static_cast<int>(gain * 1e4) % 2 == 0 ? 1.0 : -1.0;
}

inline Scores branch_scores(double score) {
  return {{kBranchScore, score}, {"homogeneity.clipped_share", 0.0}};  // of the usual limit
}

}  // namespace glint::test

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Rough metal (simulator/material/conductor.h) for sixteen paths at a time in float.
#pragma once

#include "simulator/render/path_tracing/path_packet.h"

namespace glint {

/// A Conductor as plain numbers. Source of all formulas: simulator/material.
struct ConductorNumbers {
  static constexpr int kRows = 36;
  static constexpr int kMaxColumns = 10;
  static constexpr int kCells = 32;

  enum class Fresnel { kConstant, kSchlick, kConductor };

  float alpha_x = 0.1F;
  float alpha_y = 0.1F;
  Fresnel fresnel = Fresnel::kConstant;
  float normal[3] = {1.0F, 1.0F, 1.0F};
  float n[3] = {1.0F, 1.0F, 1.0F};
  float k[3] = {};
  float tint[3] = {1.0F, 1.0F, 1.0F};

  // Light of several reflections; columns = 0: left out.
  int columns = 0;
  float knee = 1.0F;
  float rows_per_log = 1.0F;
  float albedo[kRows * kMaxColumns] = {};
  float compensation[3] = {};          ///< tinted
  float per_lost = 0.0F;               ///< 1 / (pi (1 - average albedo)); 0: nothing is lost
  float compensation_strength = 0.0F;  ///< untinted, which the share of samples follows
  float single_strength = 0.0F;
  float loss_knee = 1.0F;
  float loss_scale = 1.0F;
  float mass[kCells] = {};
  float mass_below[kCells] = {};
};

/// The share of samples that choose the light of several reflections.
struct alignas(64) LobeLanes {
  float viewer_albedo[kPacketSize];
  float share[kPacketSize];
};

void choose_lobes16(const ConductorNumbers& metal, const VectorLanes& viewer, LobeLanes& lobes);

/// As evaluate(); black where a direction is below the surface.
void evaluate16(const ConductorNumbers& metal,
                const LobeLanes& lobes,
                const VectorLanes& viewer,
                const VectorLanes& to_light,
                ReflectionLanes& reflection);

/// As sample(); weight 0 for a lost direction.
void sample16(const ConductorNumbers& metal,
              const LobeLanes& lobes,
              const VectorLanes& viewer,
              const RandomLanes& random,
              LeavingLanes& leaving);

}  // namespace glint

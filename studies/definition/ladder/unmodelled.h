// SPDX-License-Identifier: GPL-3.0-or-later
//
// What no way to render shows, however dear, with the size it has in a scene by a rough estimate
// (docs/accuracy.md, "What no rung models").
#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "simulator/light/area/build_lights.h"
#include "studies/definition/scene.h"

namespace glint {

/// One sentence each: light between part and wall or lamps, polarisation, features near the
/// wavelength, reflections beyond the last.
/// @param size_mm    of the part
/// @param load_mesh  of lamps from mesh files, which do not count without it
std::vector<std::string> unmodelled_notes(const SceneSettings& scene,
                                          const Eigen::Vector3d& size_mm,
                                          const MeshLoader& load_mesh = {});

/// Degree of polarisation of unpolarised light that a metal has reflected once at an angle:
/// (Rs - Rp) / (Rs + Rp), for n = 1 and the k that gives the reflectance at normal incidence.
/// @param reflectance  in [0, 1]
double metal_polarisation(double reflectance, double angle_rad);

}  // namespace glint

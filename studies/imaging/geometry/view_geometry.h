// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a camera sees of the part's shape, pixel by pixel.
#pragma once

#include <filesystem>

#include "simulator/render/path_tracing/film.h"
#include "studies/definition/scene.h"
#include "studies/imaging/scene_store.h"

namespace glint {

/// One pass of camera rays from the viewpoint that is scored: ids, normals and depth, no light. Of
/// any scene, however its pictures are rendered.
/// @param samples  camera rays a pixel, at least 1
/// @throws ConfigError beginning with the key at fault, IoError
Film render_geometry(SceneStore& store, SceneSettings scene, int samples);

/// Writes geometry.exr as `glint render` has it (studies/run/render_files.h). @throws IoError
void write_geometry(const Film& sums, const std::filesystem::path& file);

}  // namespace glint

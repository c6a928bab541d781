// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "simulator/geometry/mesh/triangle_mesh.h"
#include "simulator/geometry/part/exact_surface.h"

namespace glint {

/// Shading normals for a mesh of which some faces stand for exact surfaces (patch >= 0) and some
/// are free (-1). Corners of exact faces get the gradient of their surface; corners of free faces
/// are smoothed as smooth_normals() does, but not across the border to an exact face: that is a
/// crease, and so is the border between two exact surfaces. Cost: linear.
/// @param patches     what TriangleMesh::patch points to
/// @param crease_rad  free faces that meet at more than this are not smoothed together
void set_normals(TriangleMesh& mesh, std::span<const ExactPatch> patches, double crease_rad);

/// Unit normal of an exact surface at a point near it; empty where its gradient vanishes.
std::optional<Eigen::Vector3d> exact_normal(const ExactPatch& patch, const Eigen::Vector3d& p_mm);

/// The point of all given exact surfaces that is nearest to p: p itself when there is none, or when
/// it would have to move by more than max_move_mm, or they do not meet there.
/// @param patch_ids  indices into patches, without repetition
Eigen::Vector3d onto_patches(std::span<const ExactPatch> patches,
                             std::span<const std::int32_t> patch_ids,
                             const Eigen::Vector3d& p_mm,
                             double max_move_mm);

}  // namespace glint

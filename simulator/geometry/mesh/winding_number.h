// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <Eigen/Core>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// How often a mesh goes around a point: the sum of the solid angles under which its triangles are
/// seen, front sides negative, / 4 pi. 1 inside a closed mesh, 0 outside, between them for an open
/// one; -1 inside a closed mesh whose faces point inwards.
///
/// Source: A. van Oosterom and J. Strackee, "The solid angle of a plane triangle", IEEE
/// Transactions on Biomedical Engineering 30(2), 1983; A. Jacobson, L. Kavan and O.
/// Sorkine-Hornung, "Robust inside-outside segmentation using generalized winding numbers", ACM
/// Transactions on Graphics 32(4), 2013.
double winding_number(const TriangleMesh& mesh, const Eigen::Vector3d& point_mm);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What may touch something else: links of the arm, what its flange carries, what stands in the
// cell.
#pragma once

#include <string>
#include <vector>

#include "hardware/robot/ur_settings.h"
#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// A mesh and everything nearer to it than a radius. The mesh of a capsule is its segment, as a
/// triangle without width.
struct SolidBody {
  enum class Kind {
    kBase,     ///< of the arm: stands still
    kArm,      ///< a link of the arm
    kTool,     ///< the room of the tool, as [robot] has it
    kCarried,  ///< on the flange: camera, lights, cable
    kStanding  ///< in the cell: obstacles, the part, lights beside it
  };

  std::string name;
  Kind kind = Kind::kStanding;
  int link = 0;       ///< 0 to 6: it is fixed to that one of link_frames()
  TriangleMesh mesh;  ///< mm, in that frame
  double radius_mm = 0.0;
};

/// The segment between two points with a radius; a ball where they are one.
SolidBody capsule_body(const Eigen::Vector3d& from_mm,
                       const Eigen::Vector3d& to_mm,
                       double radius_mm);

/// A box whose edges are along the axes of its frame. @param size_mm  > 0
TriangleMesh box_mesh(const Eigen::Vector3d& centre_mm, const Eigen::Vector3d& size_mm);

/// Base, links and tool of an arm, as arm_shape() has them: each fixed to the link that moves it.
std::vector<SolidBody> arm_bodies(const ArmWithTool& arm);

/// The vertices, or the eight corners of their bounding box where there are more than eight: what
/// encloses the mesh.
std::vector<Eigen::Vector3d> hull_of(const TriangleMesh& mesh);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The tools imprints are made with: closed meshes turned outwards, in millimetres, that are cut out
// of a part (dents, pits, scratches, gouges) or added to it (bumps). Procedural and seeded, or the
// user's own from a folder (docs/theory/imprint.md).
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "defects/definition/defect.h"
#include "defects/definition/defect_settings.h"
#include "defects/tools/custom_tools.h"
#include "defects/tools/surface_sag.h"
#include "simulator/geometry/mesh/triangle_mesh.h"
#include "simulator/geometry/surface/surface_path.h"

namespace glint {

/// The bend along a path on the surface, by least squares through its points [1/mm].
double path_bend(std::span<const SurfacePathPoint> path);

/// The tools of one group.
class ToolCollection {
 public:
  /// Reads and checks the tools of group.tool_folder when one is given, sorted by name.
  /// @throws ConfigError naming the group's key and the file: folder missing or empty, file
  ///         unreadable; tool open, turned inwards, degenerate, crossing itself, or not reaching
  ///         both below and above its z = 0
  ToolCollection(std::string group_name, const DefectGroup& group);

  bool is_procedural() const { return custom_tools_.empty(); }

  /// False for bumps.
  bool works_inwards() const { return group_.type != DefectType::kBump; }

  /// Names of the tools: file names in order, or the one type's name ("dent").
  std::vector<std::string> names() const;

  /// The tool a defect takes, each of the folder's equally likely.
  std::string choose(std::uint64_t defect_seed) const;

  /// The tool for a defect, placed in the scene. Its lowest point (a bump's highest) lies at
  /// exactly depth_mm from the surface along the normal; same defect, same bytes. Stains have no
  /// tool.
  ///
  /// A tilt leans the tool: it is sheared along the surface by tan(tilt) times the height over it,
  /// which keeps the depth and the opening; of a line only the part across it counts.
  ///
  /// @param defect  its `tool` must be one of names()
  /// @param path    of lines: on the surface along u, arc_mm = 0 at the place, best 10 % longer
  ///                than the line at both ends (continued straight on where shorter); empty:
  ///                straight
  /// @param bend    the tool is bent with the surface, so that a shallow defect keeps its depth and
  ///                opening on a curved part; of lines only the exact surface counts, across them
  /// @throws ConfigError when defect.tool is none of names()
  TriangleMesh tool(const Defect& defect,
                    std::span<const SurfacePathPoint> path = {},
                    const SurfaceBend& bend = {}) const;

  /// n tools with sizes from the small to the large end of the group's ranges, in scene units, each
  /// for a place at the origin with normal +z. Seeds count from `seed`.
  std::vector<TriangleMesh> samples(int n, std::uint64_t seed) const;

 private:
  const CustomTool& custom_tool(const std::string& name) const;

  std::string name_;
  DefectGroup group_;
  std::vector<CustomTool> custom_tools_;
};

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// A tool of the user's folder, checked, in its own frame: z = 0 is the surface, +z outwards, x
/// along the line.
struct CustomTool {
  std::string name;  ///< file name without its folder
  TriangleMesh mesh;
};

/// The tools (.stl, .ply, .obj, .off) of a folder sorted by name; other files are passed over.
/// @param key  begins every message: "defects.dents.tool_folder"
/// @throws ConfigError with file and reason: folder missing or without tools; file unreadable; tool
///         open, turned inwards, degenerate, crossing itself, or not on both sides of its z = 0
std::vector<CustomTool> read_custom_tools(const std::string& key,
                                          const std::filesystem::path& folder);

/// The size an own tool is brought to.
struct CustomToolSize {
  double along_mm = 1.0;   ///< lines: extent in x
  double across_mm = 1.0;  ///< lines: extent in y; round ones: the larger of both
  double depth_mm = 0.1;   ///< of the lowest point below z = 0
  bool is_line = false;
};

/// The mesh scaled, its box centred in x and y. What is above z = 0 is drawn out to half of
/// across_mm where it is lower and the tool allows it: a shallow tool must still clear the facets.
TriangleMesh scaled_tool(const TriangleMesh& mesh, const CustomToolSize& size);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "defects/tools/tools.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "core/rng.h"
#include "defects/boolean/imprint_checks.h"
#include "defects/tools/line_frames.h"
#include "defects/tools/line_sweep.h"
#include "defects/tools/mesh_bend.h"
#include "defects/tools/round_tool.h"

namespace glint {
namespace {

constexpr std::uint64_t kChooseIndex = 0x746f6f6d00;  ///< draws of a defect's seed: which tool
constexpr double kSlabShare = 1.0 / 64.0;             ///< of the length of an own tool that is bent
constexpr double kMaxRoundBend = 0.5;                 ///< of a round tool, times its radius
constexpr double kChordShare = 0.005;                 ///< of the depth, of a bent tool's triangles
constexpr std::size_t kMaxTriangles = 400'000;        ///< of a bent tool

/// Pits are rougher than their setting, of features a little larger.
constexpr double kPitRoughness = 1.2;

RoundTool round_shape(const Defect& defect, const DefectGroup& group) {
  RoundTool shape = {.diameter_mm = defect.diameter_mm,
                     .depth_mm = defect.depth_mm,
                     .roughness = group.roughness,
                     .level = group.tool_level,
                     .seed = defect.seed};
  if (defect.type == DefectType::kPit) {
    shape.exponent = 4.0;
    shape.roughness *= kPitRoughness;
    shape.noise_per_radius = 1.2;
  }
  if (defect.type == DefectType::kBump && defect.wall_mm > 0.0) {
    shape.reach_mm = defect.wall_mm;  // its other end must stay inside the part
  }
  return shape;
}

LineTool line_shape(const Defect& defect, const DefectGroup& group) {
  LineTool shape = {.length_mm = defect.length_mm,
                    .width_mm = defect.width_mm,
                    .depth_mm = defect.depth_mm,
                    .roughness = group.roughness,
                    .lean = std::tan(defect.tilt_rad) * std::sin(defect.tilt_direction_rad),
                    .level = group.tool_level,
                    .seed = defect.seed};
  if (defect.type == DefectType::kGouge) {
    shape.section = 2.0;
    shape.taper = 2.0;
  }
  return shape;
}

/// A round tool with triangles that follow the surface when it is bent: a chord of length e lies
/// k e^2 / 8 off a bend k, and that must be little against the depth.
TriangleMesh fine_enough(TriangleMesh mesh, const Defect& defect, const SurfaceBend& bend) {
  const double largest = std::max(std::abs(bend.along_per_mm), std::abs(bend.across_per_mm));
  const double allowed_mm = std::sqrt(kChordShare * 8.0 * defect.depth_mm / largest);
  const auto is_coarse = [&](const Triangle& t) {
    const auto at = [&](std::size_t k) -> const Eigen::Vector3d& {
      return mesh.vertices_mm[static_cast<std::size_t>(t[k])];
    };
    const bool works = std::min({at(0).z(), at(1).z(), at(2).z()}) < 0.0;
    return works && std::max({(at(1) - at(0)).head<2>().norm(),
                              (at(2) - at(1)).head<2>().norm(),
                              (at(0) - at(2)).head<2>().norm()}) > allowed_mm;
  };
  while (4 * mesh.num_triangles() <= kMaxTriangles &&
         std::ranges::any_of(mesh.triangles, is_coarse)) {
    mesh = quartered(mesh);
  }
  return mesh;
}

/// Leans a round tool, bends it with so much of the surface's sag and puts it to its place.
TriangleMesh placed(TriangleMesh mesh, const Defect& defect, const SurfaceSag& sag, double share) {
  const double lean = std::tan(defect.tilt_rad);
  const double lean_u = lean * std::cos(defect.tilt_direction_rad);
  const double lean_v = lean * std::sin(defect.tilt_direction_rad);
  for (Eigen::Vector3d& p : mesh.vertices_mm) {
    const double u = p.x() + lean_u * p.z();
    const double v = p.y() + lean_v * p.z();
    const double w = p.z() - (share > 0.0 ? share * sag.at_mm(u, v) : 0.0);
    p = defect.place.centre_mm + u * defect.place.u_axis + v * defect.place.v_axis +
        w * defect.place.normal;
  }
  return mesh;
}

/// With as much of the bend as the tool stands: coarse triangles of a rough tool may not follow.
TriangleMesh placed_soundly(const TriangleMesh& mesh,
                            const Defect& defect,
                            const SurfaceBend& bend,
                            bool stands_any_bend) {
  const SurfaceSag sag(defect.place, bend, 2.0 * kMaxRoundBend / defect.diameter_mm);
  double share = 1.0;
  for (int halvings = 0; halvings < 6; ++halvings) {
    TriangleMesh bent = placed(mesh, defect, sag, share);
    if (sag.is_flat() || stands_any_bend || tool_fault(bent).empty()) {
      return bent;
    }
    share *= 0.5;
  }
  return placed(mesh, defect, sag, 0.0);
}

/// An own tool of a line, bent with the smallest smoothing of the path that keeps it sound.
TriangleMesh bent_custom_tool(const CustomTool& tool,
                              const Defect& defect,
                              const LineFrames& frames) {
  const double length = std::min(defect.length_mm, 2.0 * frames.half_length_mm() / 1.01);
  TriangleMesh mesh = scaled_tool(tool.mesh,
                                  {.along_mm = length,
                                   .across_mm = defect.width_mm,
                                   .depth_mm = defect.depth_mm,
                                   .is_line = true});
  const double lean = std::tan(defect.tilt_rad) * std::sin(defect.tilt_direction_rad);
  for (Eigen::Vector3d& p : mesh.vertices_mm) {
    p.y() += lean * p.z();
  }
  for (double window = 0.5 * defect.width_mm; !frames.is_straight() && window < 2.0 * length;
       window *= 4.0) {
    TriangleMesh bent = bent_along(mesh, frames, kSlabShare * length, window);
    if (tool_fault(bent).empty()) {
      return bent;
    }
  }
  const LineFrames straight({}, defect.place);
  return bent_along(mesh, straight, length, 0.0);
}

/// The defect at a share of the way through the group's ranges, at the origin.
Defect sample_defect(const DefectGroup& group, double share, std::uint64_t seed) {
  Defect defect;
  defect.type = group.type;
  defect.seed = seed;
  defect.depth_mm = group.height_mm.at(share);
  defect.diameter_mm = group.diameter_mm.at(share);
  defect.length_mm = group.length_mm.at(share);
  defect.width_mm = group.width_mm.at(share);
  defect.tilt_rad = group.tilt_rad.at(share);
  return defect;
}

}  // namespace

double path_bend(std::span<const SurfacePathPoint> path) {
  if (path.size() < 3) {
    return 0.0;
  }
  const auto middle = std::min_element(path.begin(), path.end(), [](const auto& a, const auto& b) {
    return std::abs(a.arc_mm) < std::abs(b.arc_mm);
  });
  double products = 0.0;
  double squares = 0.0;
  for (const SurfacePathPoint& p : path) {
    const Eigen::Vector3d step = p.point_mm - middle->point_mm;
    const double half_square = 0.5 * std::pow(step.dot(middle->tangent), 2);
    products -= half_square * step.dot(middle->normal);
    squares += half_square * half_square;
  }
  return squares > 0.0 ? products / squares : 0.0;
}

ToolCollection::ToolCollection(std::string group_name, const DefectGroup& group)
    : name_(std::move(group_name)), group_(group) {
  if (!group.tool_folder.empty()) {
    custom_tools_ =
        read_custom_tools(fmt::format("defects.{}.tool_folder", name_), group.tool_folder);
  }
}

std::vector<std::string> ToolCollection::names() const {
  if (is_procedural()) {
    return {std::string(type_name(group_.type))};
  }
  std::vector<std::string> all;
  for (const CustomTool& tool : custom_tools_) {
    all.push_back(tool.name);
  }
  return all;
}

std::string ToolCollection::choose(std::uint64_t defect_seed) const {
  const std::vector<std::string> all = names();
  Rng rng(defect_seed, Stream::kDefects, kChooseIndex);
  const auto share = static_cast<double>(all.size()) * rng.uniform();
  return all[std::min(all.size() - 1, static_cast<std::size_t>(share))];
}

const CustomTool& ToolCollection::custom_tool(const std::string& name) const {
  const auto found = std::find_if(custom_tools_.begin(),
                                  custom_tools_.end(),
                                  [&](const CustomTool& tool) { return tool.name == name; });
  if (found == custom_tools_.end()) {
    throw ConfigError("defects." + name_, fmt::format("has no tool \"{}\"", name));
  }
  return *found;
}

TriangleMesh ToolCollection::tool(const Defect& defect,
                                  std::span<const SurfacePathPoint> path,
                                  const SurfaceBend& bend) const {
  GLINT_CHECK(defect.type != DefectType::kStain, "a stain has no tool");
  if (is_line(defect.type)) {
    const LineFrames frames(path, defect.place);
    return is_procedural() ? line_tool(line_shape(defect, group_), frames, bend.patch)
                           : bent_custom_tool(custom_tool(defect.tool), defect, frames);
  }
  const bool is_bump = defect.type == DefectType::kBump;
  const RoundTool shape = round_shape(defect, group_);
  TriangleMesh mesh;
  if (is_procedural()) {
    mesh = round_tool(shape);
  } else {
    const CustomTool& own = custom_tool(defect.tool);
    mesh = scaled_tool(is_bump ? upside_down(own.mesh) : own.mesh,
                       {.across_mm = defect.diameter_mm, .depth_mm = defect.depth_mm});
  }
  if (bend.patch != nullptr) {
    mesh = fine_enough(std::move(mesh), defect, bend);
  }
  const bool stands_any_bend = is_procedural() && is_shallow_cap(shape) && defect.tilt_rad == 0.0;
  return placed_soundly(
      is_bump ? upside_down(std::move(mesh)) : mesh, defect, bend, stands_any_bend);
}

std::vector<TriangleMesh> ToolCollection::samples(int n, std::uint64_t seed) const {
  std::vector<TriangleMesh> meshes;
  for (int i = 0; i < n && group_.type != DefectType::kStain; ++i) {
    const double share = n > 1 ? static_cast<double>(i) / (n - 1) : 0.5;
    Defect defect = sample_defect(group_, share, seed + static_cast<std::uint64_t>(i));
    defect.tool = is_procedural()
                      ? std::string(type_name(group_.type))
                      : custom_tools_[static_cast<std::size_t>(i) % custom_tools_.size()].name;
    meshes.push_back(tool(defect));
  }
  return meshes;
}

}  // namespace glint

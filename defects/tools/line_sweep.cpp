// SPDX-License-Identifier: GPL-3.0-or-later
//
// Sections across the path, each a lower side with noise, two walls and a tip above the surface,
// are joined to slabs from end to end; the ends close where depth and width vanish. How many: as
// the level asks, more where a chord would leave a bent path by 5 % of the depth or a twisted slab
// would warp. Neighbouring sections must not meet inside the tool: else frames are averaged over
// longer stretches and the part above the surface is lowered. Our own construction. Cost: linear in
// the triangles, times the attempts. docs/theory/imprint.md, "Tools".
#include "defects/tools/line_sweep.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "defects/boolean/imprint_checks.h"
#include "defects/tools/tool_noise.h"

namespace glint {
namespace {

constexpr double kMargin = 0.25;      ///< how far over the surface flanks go on, share of the depth
constexpr double kLastMargin = 0.8;   ///< where the tool ends, share of the margin
constexpr double kSagShare = 0.05;    ///< of the depth that a chord may differ from a bent path
constexpr double kExactShare = 0.01;  ///< the same where the surface is exact
constexpr double kOnPatch = 1e-4;     ///< of the length: a path's chords are nearer to its surface
constexpr double kMaxBend = 0.35;     ///< of the distance across that a section is bent by
constexpr double kWarpShare = 0.2;    ///< of the width that a side of a twisted slab may warp
constexpr int kMaxLineSlabs = 1000;
constexpr double kTightBend = 0.1;  ///< size of the tool over the path's radius, see is_tight()
constexpr double kMinStep = 0.1;    ///< of the step that remains between neighbouring sections

/// Points (across, height) of one section, counter-clockwise seen against the tangent: the lower
/// side from left to right, then right wall, tip, left wall.
using Section = std::vector<Eigen::Vector2d>;

/// The tool before it is swept.
struct Sections {
  const ExactPatch* patch = nullptr;
  double on_patch_mm = 0.0;  ///< a path this near runs on it
  std::vector<double> arc_mm;
  std::vector<Section> sections;
  int lower = 0;  ///< points of the lower side: 2 * flank + 1
  double top_mm = 0.0;
};

int flank_steps(int level) {
  return 1 << std::max(0, level - 1);
}

/// Share of the depth by which the tool goes on above the surface.
double margin_of(const LineTool& shape) {
  return kMargin * std::min(1.0, shape.width_mm / shape.depth_mm);
}

double top_of(const LineTool& shape) {
  return std::max(0.5 * shape.width_mm, std::min(shape.depth_mm, shape.width_mm));
}

int number_of_slabs(const LineTool& shape, const LineFrames& frames, double sag_share) {
  double needed = 20.0 * std::pow(4.0, shape.level) / (4 * flank_steps(shape.level) + 8);
  if (!frames.is_straight()) {
    const double bend = frames.largest_bend_per_mm();
    const double sag_step = std::sqrt(8.0 * sag_share * shape.depth_mm / bend);
    // Where the frame twists, the flanks of a thin blade warp against each other.
    const double height = std::max(shape.depth_mm, top_of(shape));
    const double twist_step = kWarpShare * shape.width_mm / (bend * height);
    needed = std::max(needed, shape.length_mm / std::min(sag_step, twist_step));
  }
  needed = std::min<double>(kMaxLineSlabs, needed);
  return 2 * std::max(4, static_cast<int>(std::ceil(0.5 * needed)));
}

/// From end to end, denser towards the ends where the taper is steep; the middle is one of them.
std::vector<double> section_arcs(const LineTool& shape, int slabs) {
  const double end =
      0.5 * shape.length_mm * std::pow(1.0 + kLastMargin * margin_of(shape), 1.0 / shape.taper);
  std::vector<double> arcs;
  for (int i = 0; i <= slabs; ++i) {
    const double x = 2.0 * i / slabs - 1.0;
    arcs.push_back(end * 0.5 * x * (3.0 - x * x) * 0.6 + end * x * 0.4);
  }
  return arcs;
}

/// Lower side without noise, its height in shares of the depth.
Section plain_lower(const LineTool& shape, double share, int flank) {
  const double margin = margin_of(shape);
  const double half = 0.5 * shape.width_mm * std::pow(share + margin, 1.0 / shape.section);
  Section points;
  for (int j = -flank; j <= flank; ++j) {
    const double t = static_cast<double>(j) / flank;
    points.emplace_back(half * t, (share + margin) * std::pow(std::abs(t), shape.section) - share);
  }
  return points;
}

/// Numbers of mean 0 and deviation 1.
struct FlankNoise {
  std::vector<double> heights;  ///< by section and its points
  std::vector<double> sides;    ///< two a section
};

FlankNoise noise_of(const LineTool& shape, const Sections& s) {
  const ToolNoise bottom(shape.seed, 1, 3, 0.6);
  const ToolNoise outline(shape.seed, 2, 3, 0.6);
  const double steps = static_cast<double>(s.arc_mm.size() - 1);
  const double feature = std::max(shape.width_mm, 3.0 * shape.length_mm / steps);
  FlankNoise noise;
  for (std::size_t i = 0; i < s.sections.size(); ++i) {
    const double along = 1.5 * s.arc_mm[i] / feature;
    for (const Eigen::Vector2d& p : s.sections[i]) {
      noise.heights.push_back(bottom({along, 3.0 * p.x() / shape.width_mm, 0.5}));
    }
    noise.sides.push_back(outline({along, 0.5, 0.5}));
    noise.sides.push_back(outline({along, 50.5, 0.5}));
  }
  standardise(noise.heights);
  standardise(noise.sides);
  return noise;
}

/// Rough flanks: heights move by most at the bottom and not at the rim, and each half of a section
/// is stretched as a whole, so that the lower side remains a graph over the surface.
void add_noise(const LineTool& shape, Sections& s) {
  if (shape.roughness <= 0.0) {
    return;
  }
  const auto [heights, sides] = noise_of(shape, s);
  const double margin = margin_of(shape);
  for (std::size_t i = 0; i < s.sections.size(); ++i) {
    Section& section = s.sections[i];
    const double share = std::max(0.0, -section[section.size() / 2].y());
    for (std::size_t j = 0; j < section.size(); ++j) {
      const double weight = share * (margin - section[j].y()) / (share + margin);
      section[j].y() += shape.roughness * weight * heights[i * section.size() + j];
      const double side = sides[2 * i + (2 * j < section.size() ? 0 : 1)];
      section[j].x() *= std::clamp(1.0 + shape.roughness * side, 0.3, 2.5);
    }
  }
}

/// Heights from shares of the depth to millimetres, the lowest at exactly the depth.
void fit_depth(const LineTool& shape, Sections& s) {
  double lowest = 0.0;
  for (const Section& section : s.sections) {
    for (const Eigen::Vector2d& p : section) {
      lowest = std::min(lowest, p.y());
    }
  }
  for (Section& section : s.sections) {
    for (Eigen::Vector2d& p : section) {
      p.y() *= shape.depth_mm / (p.y() < 0.0 ? -lowest : 1.0);
    }
  }
}

Sections make_sections(const LineTool& shape, int slabs) {
  Sections s;
  const int flank = flank_steps(shape.level);
  s.lower = 2 * flank + 1;
  s.arc_mm = section_arcs(shape, slabs);
  for (const double arc : s.arc_mm) {
    const double share = 1.0 - std::pow(std::abs(2.0 * arc / shape.length_mm), shape.taper);
    s.sections.push_back(plain_lower(shape, share, flank));
  }
  add_noise(shape, s);
  fit_depth(shape, s);
  s.top_mm = top_of(shape);
  return s;
}

/// How far the exact surface lies below a section's points (across, height) of height 0; empty
/// where the path has left it, or it bends too much.
std::optional<std::vector<double>> sags_mm(const Sections& s,
                                           const LineFrame& frame,
                                           const Section& section) {
  const auto sag = [&](double across_mm) {
    const double reach_mm = s.on_patch_mm + kMaxBend * std::abs(across_mm);
    const Ray down = {.origin_mm = frame.at(across_mm, 0.0), .direction = -frame.normal};
    return polish(*s.patch, down, 0.0, reach_mm);
  };
  std::vector<double> sags;
  if (s.patch == nullptr || !sag(0.0)) {
    return std::nullopt;
  }
  for (const Eigen::Vector2d& p : section) {
    const auto hit = sag(p.x());
    if (!hit) {
      return std::nullopt;
    }
    sags.push_back(hit->t_mm);
  }
  return sags;
}

/// All sections in their frames, each as long as the others, with `lower` + 3 points.
std::vector<Eigen::Vector3d> place_sections(const Sections& s,
                                            const std::vector<LineFrame>& frames,
                                            double lean,
                                            double top_mm) {
  std::vector<Eigen::Vector3d> points;
  for (std::size_t i = 0; i < s.sections.size(); ++i) {
    Section section = s.sections[i];
    double highest = 0.0;
    for (const Eigen::Vector2d& p : section) {
      highest = std::max(highest, p.y());
    }
    const double top = std::max(top_mm, 1.5 * highest);
    const double left = section.front().x();
    section.emplace_back(section.back().x(), top);
    section.emplace_back(0.0, 1.15 * top);
    section.emplace_back(left, top);
    for (Eigen::Vector2d& p : section) {
      p.x() += lean * p.y();
    }
    const auto sags = sags_mm(s, frames[i], section);
    for (std::size_t j = 0; j < section.size(); ++j) {
      points.push_back(frames[i].at(section[j].x(), section[j].y() - (sags ? (*sags)[j] : 0.0)));
    }
  }
  return points;
}

/// Every point lies clearly before the plane of the next section and behind that of the one before.
bool are_in_order(const std::vector<Eigen::Vector3d>& points,
                  const std::vector<LineFrame>& frames,
                  std::size_t per_section) {
  for (std::size_t i = 0; i + 1 < frames.size(); ++i) {
    const LineFrame& a = frames[i];
    const LineFrame& b = frames[i + 1];
    const double minimum = kMinStep * (b.point_mm - a.point_mm).norm();
    for (std::size_t j = 0; j < per_section; ++j) {
      const Eigen::Vector3d& p = points[i * per_section + j];
      const Eigen::Vector3d& q = points[(i + 1) * per_section + j];
      if ((b.point_mm - p).dot(b.tangent) < minimum || (q - a.point_mm).dot(a.tangent) < minimum) {
        return false;
      }
    }
  }
  return true;
}

std::vector<LineFrame> frames_at(const LineFrames& frames,
                                 const std::vector<double>& arcs,
                                 double window_mm) {
  std::vector<LineFrame> at;
  at.reserve(arcs.size());
  for (const double arc : arcs) {
    at.push_back(frames.at(arc, window_mm));
  }
  return at;
}

std::vector<Triangle> swept_triangles(int sections, int count) {
  std::vector<Triangle> triangles;
  for (int i = 0; i + 1 < sections; ++i) {
    for (int j = 0; j < count; ++j) {
      const int here = i * count + j;
      const int beside = i * count + (j + 1) % count;
      triangles.push_back({here, beside, beside + count});
      triangles.push_back({here, beside + count, here + count});
    }
  }
  const int last = (sections - 1) * count;
  const int first_centre = sections * count;
  for (int j = 0; j < count; ++j) {
    const int next = (j + 1) % count;
    triangles.push_back({first_centre, next, j});
    triangles.push_back({first_centre + 1, last + j, last + next});
  }
  return triangles;
}

/// A point of an end's section that sees all of its corners: between its deepest point and tip.
Eigen::Vector3d end_centre(const std::vector<Eigen::Vector3d>& points,
                           std::size_t begin,
                           std::size_t per_section) {
  return 0.5 * (points[begin + (per_section - 3) / 2] + points[begin + per_section - 2]);
}

TriangleMesh closed_sweep(std::vector<Eigen::Vector3d> points,
                          std::size_t num_sections,
                          std::size_t per_section) {
  points.push_back(end_centre(points, 0, per_section));
  points.push_back(end_centre(points, (num_sections - 1) * per_section, per_section));
  return {
      .vertices_mm = std::move(points),
      .triangles = swept_triangles(static_cast<int>(num_sections), static_cast<int>(per_section))};
}

/// Sections in order rule out crossings of neighbours; where the path bends on the tool's own
/// scale, far parts may still meet, and only a look at the whole mesh tells.
bool is_tight(const LineTool& shape, const Sections& s, const LineFrames& frames) {
  const double size =
      std::max(shape.depth_mm, s.top_mm) * (1.0 + std::abs(shape.lean)) + 0.5 * shape.width_mm;
  return size * frames.largest_bend_per_mm() > kTightBend;
}

/// The first of ever smoother frames and ever lower tops that makes a sound tool.
TriangleMesh swept(const LineTool& shape, const Sections& s, const LineFrames& frames) {
  const std::size_t per_section = s.sections.front().size() + 3;
  const bool look = is_tight(shape, s, frames);
  double window = std::min(0.5 * shape.width_mm, 0.05 * shape.length_mm);
  while (window < 2.0 * shape.length_mm) {
    const std::vector<LineFrame> at = frames_at(frames, s.arc_mm, window);
    for (const double height : {1.0, 0.5, 0.25}) {
      std::vector<Eigen::Vector3d> points = place_sections(s, at, shape.lean, height * s.top_mm);
      if (are_in_order(points, at, per_section)) {
        TriangleMesh mesh = closed_sweep(std::move(points), at.size(), per_section);
        if (!look || tool_fault(mesh).empty()) {
          return mesh;
        }
      }
    }
    window *= 2.0;
  }
  // Nothing fits a path that bends tighter than the tool: straight on through its middle.
  const LineFrame middle = frames.at(0.0, shape.length_mm);
  const LineFrames straight({},
                            {.centre_mm = middle.point_mm,
                             .u_axis = middle.tangent,
                             .v_axis = middle.across,
                             .normal = middle.normal});
  return closed_sweep(place_sections(s, frames_at(straight, s.arc_mm, 0.0), shape.lean, s.top_mm),
                      s.arc_mm.size(),
                      per_section);
}

}  // namespace

TriangleMesh line_tool(const LineTool& shape, const LineFrames& frames, const ExactPatch* patch) {
  LineTool fitting = shape;
  const double longest = 2.0 * frames.half_length_mm() / 1.2;
  fitting.length_mm = std::min(shape.length_mm, longest);
  const double sag_share = patch != nullptr ? kExactShare : kSagShare;
  Sections s = make_sections(fitting, number_of_slabs(fitting, frames, sag_share));
  s.patch = patch;
  s.on_patch_mm = kOnPatch * fitting.length_mm;
  return swept(fitting, s, frames);
}

}  // namespace glint

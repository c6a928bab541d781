// SPDX-License-Identifier: GPL-3.0-or-later
#include "studies/compare/surface_edges.h"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include "metrics/overlap/outline_motion.h"
#include "studies/compare/camera/scene_camera.h"
#include "studies/compare/guided_outline.h"
#include "studies/compare/surface/named_surfaces.h"
#include "studies/compare/surface/simulated_surface.h"
#include "studies/compare/surface/surface_lines.h"
#include "studies/definition/scene_file.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMotionScale_px = 0.5;  ///< what the motion as a whole leaves, about
constexpr double kNeighbour_px = 5.0;    ///< points farther apart are of two stretches

/// Points of one edge of the part.
struct EdgePoints {
  const char* kind = "";
  int surface = 0;
  int beyond = 0;
  std::vector<BoundaryGap> gaps;
};

/// What is known of the simulated side.
class EdgeFinder {
 public:
  EdgeFinder(const ComparedPair& pair, const SceneSettings& scene)
      : pair_(pair),
        camera_(intrinsics_of(scene)),
        camera_from_scene_(camera_from_world(scene.viewpoint())),
        surface_(pair.simulated.source.geometry,
                 pair.simulated.width(),
                 pair.simulated.height(),
                 camera_from_scene_),
        surfaces_(find_surfaces(surface_, focal_px())) {}

  ListedEdges find() {
    add_outlines();
    add_creases();
    std::vector<PartEdge> edges;
    for (const auto& [key, points] : groups_) {
      edges.push_back(edge_of(points));
    }
    return list_edges(std::move(edges), outline_points_);
  }

 private:
  double focal_px() const { return camera_.intrinsics().focal_px.mean(); }

  /// The nearest surface on one side of a point. @param side  -1 behind the normal, 1 ahead of it
  int label_beside(const BoundaryPoint& point, double side) const {
    for (const double step_px : {1.5, 2.5, 3.5, 4.5}) {
      const int label = surfaces_.at(point.at_px + side * step_px * point.normal);
      if (label != NamedSurfaces::kNone && (label != NamedSurfaces::kBackground || side > 0.0)) {
        return label;
      }
    }
    return NamedSurfaces::kNone;
  }

  void add(const char* kind, std::size_t of, int surface, int beyond, const BoundaryGap& gap) {
    if (surface == NamedSurfaces::kNone || beyond == NamedSurfaces::kNone) {
      return;
    }
    EdgePoints& points = groups_[{kind, of, surface, beyond}];
    points.kind = kind;
    points.surface = surface;
    points.beyond = beyond;
    points.gaps.push_back(gap);
  }

  /// Where two surfaces meet an outline by brightness may run, too: that is a crease.
  void add_outlines() {
    const PartOutline& own = pair_.geometry.outlines.simulated;
    const auto rough = rough_of_pieces(own.rough, own.located);
    const double reach_px = kMaxDistanceShare * pair_.simulated.width();
    for (const BoundaryGap& gap :
         gaps_between(own.located, pair_.geometry.outlines.real.located, reach_px)) {
      const std::size_t of = rough[gap.boundary];
      const int surface = label_beside(gap.from, -1.0);
      const int beyond = label_beside(gap.from, 1.0);
      if (of >= own.rough.size()) {
        continue;
      }
      if (beyond == NamedSurfaces::kBackground) {
        ++outline_points_;
        add(kind_of_boundary(own.rough[of]), of, surface, beyond, gap);
      } else if (surface == beyond) {
        add(kEdgeOfLight, of, surface, beyond, gap);
      }
    }
  }

  void add_creases() {
    const std::vector<SurfaceLine> lines = lines_between(surfaces_);
    std::vector<Boundary> boundaries;
    for (const SurfaceLine& line : lines) {
      boundaries.push_back(line.line);
    }
    const OutlineMotion motion = fit_outline_motion(pair_.geometry.offsets, kMotionScale_px);
    for (const compare_detail::PairedEdge& edge :
         compare_detail::edges_along(pair_.simulated.grey, pair_.real.grey, boundaries, motion)) {
      add(kCrease,
          0,
          lines[edge.line].from,
          lines[edge.line].to,
          {.from = edge.own,
           .distance_px = std::abs(edge.offset_px),
           .offset_px = edge.offset_px,
           .boundary = edge.line,
           .point = edge.point});
    }
  }

  PartEdge edge_of(const EdgePoints& points) const {
    std::vector<const BoundaryGap*> gaps;
    for (const BoundaryGap& gap : points.gaps) {
      gaps.push_back(&gap);
    }
    PartEdge edge = edge_of_gaps(gaps);
    edge.name = points.kind;
    edge.surface = surfaces_.name_of(points.surface);
    edge.beyond = surfaces_.name_of(points.beyond);
    add_space(points.gaps, edge);
    return edge;
  }

  /// Length, place and offset in space.
  void add_space(const std::vector<BoundaryGap>& gaps, PartEdge& edge) const {
    // What is no number is near nothing.
    Vector3d last = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
    double count = 0.0;
    double depth_mm = 0.0;
    Vector3d sum = Vector3d::Zero();
    for (const BoundaryGap& gap : gaps) {
      const auto at = surface_.at_edge(camera_, gap.from.at_px, gap.from.normal);
      if (at) {
        const double step_mm = (*at - last).norm();
        edge.length_mm += step_mm < kNeighbour_px * at->z() / focal_px() ? step_mm : 0.0;
        sum += *at;
        depth_mm += at->z();
        count += 1.0;
        last = *at;
      }
    }
    if (count > 0.0) {
      edge.middle_mm = inverse(camera_from_scene_) * Vector3d(sum / count);
      edge.offset_mm = edge.offset_px * depth_mm / count / focal_px();
    }
  }

  const ComparedPair& pair_;
  PinholeCamera camera_;
  RigidTransform camera_from_scene_;
  SimulatedSurface surface_;
  NamedSurfaces surfaces_;
  std::map<std::tuple<std::string, std::size_t, int, int>, EdgePoints> groups_;
  std::size_t outline_points_ = 0;
};

}  // namespace

ListedEdges surface_edges(const ComparedPair& pair) {
  const CompareSource& source = pair.simulated.source;
  if (source.scene.empty() || source.geometry.empty()) {
    return {.edges = pair.geometry.edges, .unlisted = pair.geometry.unlisted};
  }
  return EdgeFinder(pair, load_scene(source.scene)).find();
}

}  // namespace glint

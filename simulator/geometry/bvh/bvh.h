// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "simulator/geometry/bvh/escape_cone.h"
#include "simulator/geometry/bvh/ray_packet.h"
#include "simulator/geometry/bvh/triangle_hit.h"
#include "simulator/geometry/bvh/triangle_planes.h"
#include "simulator/geometry/mesh/triangle_mesh.h"

namespace glint {

/// The point of a mesh that is nearest to another.
struct NearestPoint {
  std::int32_t triangle = -1;
  Eigen::Vector3d point_mm = Eigen::Vector3d::Zero();
  double distance_mm = 0.0;
};

/// Whether the rays of a packet run close to each other (camera rays) or apart (reflected rays).
/// kCoherentOnce: as kCoherent, but without a second try of rays that miss.
enum class Coherence { kCoherent, kCoherentOnce, kIncoherent };

/// Finds what a ray meets: an Embree 3 scene in robust mode (no ray slips between triangles), both
/// sides of a triangle. Embree works in float: recompute positions with hit_point() or polish(),
/// and start secondary rays a little off the surface. Immutable; all calls are safe from several
/// threads. Holds a copy of the mesh in float.
///
/// Coherent packets and single rays that miss are tried once more 1e-6 rad aside: Embree lets some
/// rays through that aim exactly at a vertex. Other packets and occluded() are not.
class Bvh {
 public:
  /// @throws Error when Embree cannot build it (out of memory).
  explicit Bvh(const TriangleMesh& mesh);
  ~Bvh();
  Bvh(Bvh&&) noexcept;
  Bvh& operator=(Bvh&&) noexcept;

  void intersect16(const RayPacket& rays, HitPacket& hits, Coherence coherence) const;

  /// The same without copies. A ray that was tried a second time keeps the direction of that try.
  void trace16(RayQuery& query, Coherence coherence) const;

  /// Lanes that anything stands in the way of, between t_min and t_max, become invalid (0). Quicker
  /// than intersect16().
  void occluded16(RayPacket& rays, Coherence coherence) const;

  Hit intersect(const Eigen::Vector3d& origin_mm,
                const Eigen::Vector3d& direction,
                double t_min_mm,
                double t_max_mm) const;

  /// True when anything lies between t_min and t_max; quicker than intersect().
  bool occluded(const Eigen::Vector3d& origin_mm,
                const Eigen::Vector3d& direction,
                double t_min_mm,
                double t_max_mm) const;

  /// The nearest point of the mesh, in double; the lowest triangle of those at equal distance.
  /// Empty when nothing lies within max_distance_mm. The same on every machine.
  /// @param mesh  the one this was built from
  std::optional<NearestPoint> nearest(const TriangleMesh& mesh,
                                      const Eigen::Vector3d& point_mm,
                                      double max_distance_mm) const;

  /// True for a closed convex mesh: a ray that leaves it never meets it again.
  bool is_convex() const { return is_convex_; }

  /// How rays that have left the part can be known to meet it no more.
  /// Found at the first call. @param mesh  the one this was built from
  const EscapeCone& escape_cone(const TriangleMesh& mesh) const;

  /// 1 for triangles whose shading normals are all their own, so that these need not be looked up.
  /// Found at the first call. @param mesh  the one this was built from
  const std::vector<std::uint8_t>& flat_triangles(const TriangleMesh& mesh) const;

  const TrianglePlane& plane(std::int32_t triangle) const {
    return planes_[static_cast<std::size_t>(triangle)];
  }

 private:
  struct Scene;
  std::vector<TrianglePlane> planes_;
  bool is_convex_ = false;
  double largest_mm_ = 0.0;  ///< of all coordinates, without sign
  std::unique_ptr<Scene> scene_;
};

/// The instruction set Embree chose, for run.json: "AVX512", "AVX2", "AVX" or "SSE". Hits differ in
/// their last bits between them.
std::string embree_isa();

}  // namespace glint

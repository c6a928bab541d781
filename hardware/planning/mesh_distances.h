// SPDX-License-Identifier: GPL-3.0-or-later
//
// Distances between meshes by FCL. Each pair of triangles counts as it is (the distance of two
// triangles in closed form), so there is no iteration that might not end; what is farther apart
// than the caller wants to know is cut off early in the trees of bounding volumes.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "hardware/planning/solid_body.h"

namespace glint {

/// The surfaces of some bodies. Immutable but for its counter; for one thread at a time.
class MeshDistances {
 public:
  explicit MeshDistances(std::span<const SolidBody> bodies);
  ~MeshDistances();
  MeshDistances(MeshDistances&& other) noexcept;
  MeshDistances& operator=(MeshDistances&& other) noexcept;

  /// Distance between two bodies' surfaces without their radii, mm; `enough_mm` where it is more.
  /// @param first, second  indices of bodies
  /// @param base_from_first, base_from_second  where their frames are
  double distance_mm(std::size_t first,
                     const Eigen::Isometry3d& base_from_first,
                     std::size_t second,
                     const Eigen::Isometry3d& base_from_second,
                     double enough_mm) const;

  /// The same to the bounding box of the first body's mesh: no more than distance_mm(), and quick.
  /// 0 where the second one's first corner is within the box.
  double distance_to_box_mm(std::size_t first,
                            const Eigen::Isometry3d& base_from_first,
                            std::size_t second,
                            const Eigen::Isometry3d& base_from_second,
                            double enough_mm) const;

  /// Of so many triangles that its bounding box is worth asking first.
  bool is_large(std::size_t body) const;

  std::int64_t num_queries() const;

 private:
  struct Meshes;
  std::unique_ptr<Meshes> meshes_;
};

}  // namespace glint

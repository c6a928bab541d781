// SPDX-License-Identifier: GPL-3.0-or-later
//
// Lists of rays through the part, traced sixteen at a time.
#pragma once

#include <cstddef>
#include <vector>

#include "core/pose.h"
#include "simulator/geometry/bvh.h"

namespace glint {

/// Rays to trace and what they met, in the order they were added.
class RayBatch {
 public:
  void clear();
  /// @param direction  unit @param max_mm  infinity: as far as it goes
  void add(const Eigen::Vector3d& origin_mm, const Eigen::Vector3d& direction, double max_mm);

  std::size_t size() const { return size_; }

  void trace(const Bvh& bvh, Coherence coherence);

  Hit hit(std::size_t ray) const {
    const HitPacket& hits = hits_[ray / kPacketSize];
    const std::size_t lane = ray % kPacketSize;
    return {.t_mm = hits.t_mm[lane],
            .triangle = hits.triangle[lane],
            .u = hits.u[lane],
            .v = hits.v[lane]};
  }

 private:
  std::vector<RayPacket> rays_;
  std::vector<HitPacket> hits_;
  std::size_t size_ = 0;
};

}  // namespace glint

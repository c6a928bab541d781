// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/physical/ray_batch.h"

namespace glint {

void RayBatch::clear() {
  size_ = 0;
}

void RayBatch::add(const Eigen::Vector3d& origin_mm,
                   const Eigen::Vector3d& direction,
                   double max_mm) {
  const std::size_t packet = size_ / kPacketSize;
  const std::size_t lane = size_ % kPacketSize;
  if (packet == rays_.size()) {
    rays_.emplace_back();
    hits_.emplace_back();
  }
  RayPacket& rays = rays_[packet];
  if (lane == 0) {
    rays.valid.fill(0);
  }
  rays.origin_x[lane] = static_cast<float>(origin_mm.x());
  rays.origin_y[lane] = static_cast<float>(origin_mm.y());
  rays.origin_z[lane] = static_cast<float>(origin_mm.z());
  rays.direction_x[lane] = static_cast<float>(direction.x());
  rays.direction_y[lane] = static_cast<float>(direction.y());
  rays.direction_z[lane] = static_cast<float>(direction.z());
  rays.t_max[lane] = static_cast<float>(max_mm);
  rays.valid[lane] = -1;
  ++size_;
}

void RayBatch::trace(const Bvh& bvh, Coherence coherence) {
  for (std::size_t packet = 0; packet * kPacketSize < size_; ++packet) {
    bvh.intersect16(rays_[packet], hits_[packet], coherence);
  }
}

}  // namespace glint

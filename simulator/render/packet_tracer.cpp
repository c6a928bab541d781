// SPDX-License-Identifier: GPL-3.0-or-later
#include "simulator/render/packet_tracer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "core/error.h"

namespace glint {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

void set_escape(EscapePacket& escapes,
                std::size_t lane,
                const Vector3d& origin_mm,
                const Vector3d& direction,
                double weight) {
  escapes.origin_x[lane] = origin_mm.x();
  escapes.origin_y[lane] = origin_mm.y();
  escapes.origin_z[lane] = origin_mm.z();
  escapes.direction_x[lane] = direction.x();
  escapes.direction_y[lane] = direction.y();
  escapes.direction_z[lane] = direction.z();
  escapes.weight[lane] = static_cast<float>(weight);
}

/// Sixteen numbers; of a size that is known, so that no function is called.
void copy16(const double* from, Lanes& to) {
  std::memcpy(to.data(), from, sizeof(to));
}

/// Misses are below zero, which a bit tells that only they all have in common.
bool has_hit(const HitPacket& hits) {
  std::int32_t all = -1;
  for (const std::int32_t triangle : hits.triangle) {
    all &= triangle;
  }
  return all >= 0;
}

/// All rays of a packet missed the part.
void set_missed(EscapePacket& escapes) {
  escapes.is_plain = false;
  escapes.is_missed = true;
  escapes.path.fill(RayPath::kMissed);
  escapes.is_seen.fill(0.0);
  escapes.is_grazing.fill(false);
  escapes.origin_x.fill(0.0);
  escapes.origin_y.fill(0.0);
  escapes.origin_z.fill(0.0);
  escapes.direction_x.fill(0.0);
  escapes.direction_y.fill(0.0);
  escapes.direction_z.fill(-1.0);
  escapes.weight.fill(0.0F);
}

/// What becomes of the rays if none meets the part again.
void set_escapes(const TraceScene& scene,
                 const MeetingLanes& lanes,
                 const HitPacket& hits,
                 int count,
                 EscapePacket& escapes) {
  copy16(lanes.point_x, escapes.origin_x);
  copy16(lanes.point_y, escapes.origin_y);
  copy16(lanes.point_z, escapes.origin_z);
  copy16(lanes.leaving_x, escapes.direction_x);
  copy16(lanes.leaving_y, escapes.direction_y);
  copy16(lanes.leaving_z, escapes.direction_z);
  copy16(lanes.point_x, escapes.seen_x);
  copy16(lanes.point_y, escapes.seen_y);
  copy16(lanes.point_z, escapes.seen_z);
  std::memcpy(escapes.piece.data(), lanes.patch, sizeof(escapes.piece));
  escapes.path.fill(RayPath::kOnce);
  escapes.is_seen.fill(1.0);
  escapes.is_grazing.fill(false);
  escapes.is_missed = false;
  escapes.is_plain = weigh_escapes16(
      lanes, hits.triangle.data(), count, scene.settings.reflectance, escapes.weight.data());
  if (escapes.is_plain) {
    return;
  }
  for (std::size_t lane = 0; lane < static_cast<std::size_t>(count); ++lane) {
    if (hits.triangle[lane] >= 0) {
      escapes.is_grazing[lane] = lanes.rise[lane] <= 0.0;
    } else {
      escapes.path[lane] = RayPath::kMissed;
      escapes.is_seen[lane] = 0.0;
      set_escape(escapes, lane, Vector3d::Zero(), -Vector3d::UnitZ(), 0.0);
    }
  }
}

/// Three arrays as to_float() takes them.
void round_three(const double* x,
                 const double* y,
                 const double* z,
                 int count,
                 float* to_x,
                 float* to_y,
                 float* to_z) {
  const std::array<const double*, 3> in = {x, y, z};
  const std::array<float*, 3> out = {to_x, to_y, to_z};
  to_float(in.data(), count, out.data());
}

}  // namespace

CameraRays::CameraRays(const PinholeCamera& camera, const RigidTransform& camera_from_world)
    : camera_(camera), world_from_camera_(inverse(camera_from_world)) {
  const PinholeIntrinsics& in = camera.intrinsics();
  numbers_ = {.focal_x_px = in.focal_px.x(),
              .focal_y_px = in.focal_px.y(),
              .center_x_px = in.center_px.x(),
              .center_y_px = in.center_px.y()};
  for (Eigen::Index i = 0; i < 9; ++i) {
    numbers_.rotation[i] = world_from_camera_.rotation(i / 3, i % 3);
  }
  const auto is_set = [](double value) { return value != 0.0; };
  is_distorted_ =
      std::ranges::any_of(in.radial, is_set) || std::ranges::any_of(in.tangential, is_set);
}

ImageArea CameraRays::area_of(const std::array<double, 6>& box_mm) const {
  ImageArea area;
  if (is_distorted_) {
    return area;  // whose outlines bulge
  }
  const RigidTransform camera_from_world = inverse(world_from_camera_);
  ImageArea seen = {
      .min_x = area.max_x, .max_x = area.min_x, .min_y = area.max_y, .max_y = area.min_y};
  for (std::size_t corner = 0; corner < 8; ++corner) {
    const Vector3d p_mm(box_mm[(corner & 1U) != 0U ? 3 : 0],
                        box_mm[(corner & 2U) != 0U ? 4 : 1],
                        box_mm[(corner & 4U) != 0U ? 5 : 2]);
    const auto pixel = camera_.project(camera_from_world * p_mm);
    if (!pixel) {
      return area;
    }
    seen.min_x = std::min(seen.min_x, pixel->x());
    seen.max_x = std::max(seen.max_x, pixel->x());
    seen.min_y = std::min(seen.min_y, pixel->y());
    seen.max_y = std::max(seen.max_y, pixel->y());
  }
  return seen;
}

void CameraRays::through(const double* x_px,
                         const double* y_px,
                         int count,
                         CameraPacket& rays) const {
  rays.origin_mm = world_from_camera_.translation_mm;
  rays.count = count;
  if (!is_distorted_) {
    alignas(64) Lanes x;
    alignas(64) Lanes y;
    const bool is_full = count == kPacketSize;
    if (!is_full) {
      x.fill(x_px[0]);
      y.fill(y_px[0]);
      std::copy_n(x_px, count, x.begin());
      std::copy_n(y_px, count, y.begin());
    }
    camera_directions16(numbers_,
                        is_full ? x_px : x.data(),
                        is_full ? y_px : y.data(),
                        rays.direction_x.data(),
                        rays.direction_y.data(),
                        rays.direction_z.data());
    return;
  }
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    const std::size_t used = lane < static_cast<std::size_t>(count) ? lane : 0;
    const auto direction = camera_.ray_through(Vector2d(x_px[used], y_px[used]));
    GLINT_CHECK(direction.has_value(), "the camera has a ray for every point of its image");
    const Vector3d in_world = world_from_camera_.rotation * *direction;
    rays.direction_x[lane] = in_world.x();
    rays.direction_y[lane] = in_world.y();
    rays.direction_z[lane] = in_world.z();
  }
}

void set_packet(const CameraPacket& rays, RayPacket& packet) {
  packet.origin_x.fill(static_cast<float>(rays.origin_mm.x()));
  packet.origin_y.fill(static_cast<float>(rays.origin_mm.y()));
  packet.origin_z.fill(static_cast<float>(rays.origin_mm.z()));
  round_three(rays.direction_x.data(),
              rays.direction_y.data(),
              rays.direction_z.data(),
              kPacketSize,
              packet.direction_x.data(),
              packet.direction_y.data(),
              packet.direction_z.data());
  packet.t_max.fill(std::numeric_limits<float>::infinity());
  for (int lane = 0; lane < kPacketSize; ++lane) {
    packet.valid[static_cast<std::size_t>(lane)] = lane < rays.count ? -1 : 0;
  }
}

void set_reflected(const MeetingLanes& lanes, const HitPacket& hits, RayPacket& packet) {
  round_three(lanes.start_x,
              lanes.start_y,
              lanes.start_z,
              kPacketSize,
              packet.origin_x.data(),
              packet.origin_y.data(),
              packet.origin_z.data());
  round_three(lanes.leaving_x,
              lanes.leaving_y,
              lanes.leaving_z,
              kPacketSize,
              packet.direction_x.data(),
              packet.direction_y.data(),
              packet.direction_z.data());
  packet.t_max.fill(std::numeric_limits<float>::infinity());
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    packet.valid[lane] = hits.triangle[lane] >= 0 && lanes.rise[lane] > 0.0 ? -1 : 0;
  }
}

void PacketTracer::trace(const CameraPacket& rays, EscapePacket& escapes) {
  set_packet(rays, packet_);
  scene_.bvh.intersect16(packet_, hits_, Coherence::kCoherent);
  if (!has_hit(hits_)) {
    set_missed(escapes);
    return;
  }
  meet_part(scene_, rays, hits_, false, lanes_);
  set_escapes(scene_, lanes_, hits_, rays.count, escapes);
  if (scene_.bvh.is_convex() || leaves_for_good()) {
    return;
  }
  // Mirror-like rays stay close together: the coherent traversal is twice as fast for them.
  set_reflected(lanes_, hits_, packet_);
  scene_.bvh.intersect16(packet_, again_, Coherence::kCoherentOnce);
  if (has_hit(again_)) {
    escapes.is_plain = false;
    follow(escapes);
  }
}

/// True when all rays that met the part leave it in directions in which nothing is met.
bool PacketTracer::leaves_for_good() const {
  const EscapeCone& cone = scene_.escape_cone;
  return !cone.is_empty &&
         leave_along16(lanes_, hits_.triangle.data(), cone.low.data(), cone.high.data());
}

/// Follows the rays that meet the part again until they escape or are given up.
void PacketTracer::follow(EscapePacket& escapes) {
  const double reflectance = scene_.settings.reflectance;
  Lanes weight;
  std::ranges::transform(
      lanes_.reflectance, weight.begin(), [&](double of_place) { return reflectance * of_place; });
  MeetingLanes* from = &lanes_;
  MeetingLanes* to = &followed_;
  for (int bounce = 1; has_hit(again_); ++bounce) {
    if (bounce >= scene_.settings.max_bounces) {
      give_up(escapes);
      return;
    }
    meet_again(scene_, *from, again_, *to);
    for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
      if (again_.triangle[lane] < 0) {
        continue;
      }
      weight[lane] *= reflectance * to->reflectance[lane];
      escapes.path[lane] = RayPath::kFollowed;
      escapes.is_grazing[lane] = escapes.is_grazing[lane] || to->rise[lane] <= 0.0;
      set_escape(escapes,
                 lane,
                 {to->point_x[lane], to->point_y[lane], to->point_z[lane]},
                 {to->leaving_x[lane], to->leaving_y[lane], to->leaving_z[lane]},
                 weight[lane]);
    }
    set_reflected(*to, again_, packet_);
    scene_.bvh.intersect16(packet_, again_, Coherence::kCoherentOnce);
    std::swap(from, to);
  }
}

/// The rays that would still meet the part.
void PacketTracer::give_up(EscapePacket& escapes) const {
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    if (again_.triangle[lane] >= 0) {
      escapes.path[lane] = RayPath::kBlocked;
      set_escape(escapes, lane, Vector3d::Zero(), -Vector3d::UnitZ(), 0.0);
    }
  }
}

void add_counts(const EscapePacket& escapes, int count, RayCounts& counts) {
  if (escapes.is_plain || escapes.is_missed) {
    counts.camera += count;
    counts.part += escapes.is_plain ? count : 0;
    return;
  }
  for (std::size_t lane = 0; lane < static_cast<std::size_t>(count); ++lane) {
    ++counts.camera;
    counts.part += escapes.path[lane] != RayPath::kMissed ? 1 : 0;
    counts.followed += escapes.path[lane] == RayPath::kFollowed ? 1 : 0;
    counts.blocked += escapes.path[lane] == RayPath::kBlocked ? 1 : 0;
    counts.grazing += escapes.is_grazing[lane] ? 1 : 0;
  }
}

RayCounts& operator+=(RayCounts& sum, const RayCounts& counts) {
  sum.camera += counts.camera;
  sum.part += counts.part;
  sum.followed += counts.followed;
  sum.blocked += counts.blocked;
  sum.grazing += counts.grazing;
  return sum;
}

void resize_rays(RayCache& cache, std::size_t count) {
  for (auto* component : {&cache.origin_x,
                          &cache.origin_y,
                          &cache.origin_z,
                          &cache.direction_x,
                          &cache.direction_y,
                          &cache.direction_z,
                          &cache.weight}) {
    component->resize(count);
  }
}

void store_rays(const EscapePacket& escapes, int count, RayCache& cache, std::size_t first) {
  round_three(escapes.origin_x.data(),
              escapes.origin_y.data(),
              escapes.origin_z.data(),
              count,
              cache.origin_x.data() + first,
              cache.origin_y.data() + first,
              cache.origin_z.data() + first);
  round_three(escapes.direction_x.data(),
              escapes.direction_y.data(),
              escapes.direction_z.data(),
              count,
              cache.direction_x.data() + first,
              cache.direction_y.data() + first,
              cache.direction_z.data() + first);
  float* weight = cache.weight.data() + first;
  if (count == kPacketSize) {
    std::memcpy(weight, escapes.weight.data(), sizeof(escapes.weight));
    return;
  }
  std::copy_n(escapes.weight.begin(), count, weight);
}

void store_missed(std::size_t first, std::size_t count, RayCache& cache) {
  std::fill_n(cache.direction_z.begin() + static_cast<std::ptrdiff_t>(first), count, -1.0F);
}

void check_ray_memory(double num_rays, const std::string& what) {
  constexpr double kBytesPerRay = 28.0;
  constexpr double kShare = 0.5;
  const double needed = kBytesPerRay * num_rays;
  const double available =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGE_SIZE));
  if (needed > kShare * available) {
    throw ConfigError(fmt::format(
        "{} need {:.1f} GB for their rays, this machine has {:.1f} GB; allowed is half of it",
        what,
        needed * 1e-9,
        available * 1e-9));
  }
}

void check_part_is_seen(const RayCounts& counts) {
  if (counts.part == 0) {
    throw ConfigError(
        "camera: the part is outside the image: no camera ray meets it; check viewpoint, "
        "working_distance_mm and part.position_mm");
  }
}

}  // namespace glint

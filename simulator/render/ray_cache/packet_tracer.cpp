// SPDX-License-Identifier: GPL-3.0-or-later
//
// Follows sixteen camera rays from the pinhole until they have left the part. Embree finds the
// triangles in float, surface_intersection.h makes the hits exact in double. Most packets are done
// after one reflection, and often without a second search: the part is convex, or the directions in
// which they leave (EscapeCone) or the faces they leave from rule out another hit. Others are
// followed for up to render.max_bounces reflections. docs/theory/tunnel.md, "What is kept", and
// decision 0003. Cost: one search per ray and reflection; 28 bytes per ray are kept.
#include "simulator/render/ray_cache/packet_tracer.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <utility>

#include <fmt/format.h>
#include <unistd.h>

#include "core/error.h"
#include "simulator/render/ray_cache/unseen_part.h"

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
                 const IntersectionLanes& lanes,
                 const HitPacket& hits,
                 int count,
                 EscapePacket& escapes) {
  escape16(lanes, arrays_of(escapes));
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

/// True when all rays that met the part leave the front of triangles that nothing rises above.
bool leave_open(const std::vector<std::uint8_t>& is_open,
                const IntersectionLanes& lanes,
                const HitPacket& hits) {
  constexpr double kMargin = 1e-6;  // of normals and directions
  if (is_open.empty()) {
    return false;
  }
  for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
    const std::int32_t triangle = hits.triangle[lane];
    if (triangle < 0) {
      continue;
    }
    if (is_open[static_cast<std::size_t>(triangle)] == 0 || !(lanes.slope[lane] < 0.0) ||
        !(lanes.rise[lane] > kMargin)) {
      return false;
    }
  }
  return true;
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

EscapeArrays arrays_of(EscapePacket& escapes) {
  return {.seen_x = escapes.seen_x.data(),
          .seen_y = escapes.seen_y.data(),
          .seen_z = escapes.seen_z.data(),
          .origin_x = escapes.origin_x.data(),
          .origin_y = escapes.origin_y.data(),
          .origin_z = escapes.origin_z.data(),
          .direction_x = escapes.direction_x.data(),
          .direction_y = escapes.direction_y.data(),
          .direction_z = escapes.direction_z.data()};
}

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

void PacketTracer::trace(const CameraPacket& rays, EscapePacket& escapes) {
  ask_from_point16(rays.origin_mm.data(),
                   rays.direction_x.data(),
                   rays.direction_y.data(),
                   rays.direction_z.data(),
                   rays.count,
                   query_);
  scene_.bvh.trace16(query_, Coherence::kCoherent);
  if (!take_hits16(query_, hits_)) {
    set_missed(escapes);
    return;
  }
  intersect_part(scene_, rays, hits_, false, lanes_);
  set_escapes(scene_, lanes_, hits_, rays.count, escapes);
  if (scene_.bvh.is_convex() || leaves_for_good()) {
    return;
  }
  // Mirror-like rays stay close together: the coherent traversal is twice as fast for them.
  ask_reflected16(lanes_, hits_.triangle.data(), query_);
  scene_.bvh.trace16(query_, Coherence::kCoherentOnce);
  if (take_hits16(query_, again_)) {
    escapes.is_plain = false;
    follow(escapes);
  }
}

/// True when all rays that met the part leave it in directions in which nothing is met, or all of
/// them triangles that nothing rises above.
bool PacketTracer::leaves_for_good() const {
  const EscapeCone& cone = *scene_.escape_cone;
  return (!cone.is_empty &&
          leave_along16(lanes_, hits_.triangle.data(), cone.low.data(), cone.high.data())) ||
         leave_open(cone.is_open, lanes_, hits_);
}

/// Follows the rays that meet the part again until they escape or are given up.
void PacketTracer::follow(EscapePacket& escapes) {
  const double reflectance = scene_.settings.reflectance;
  alignas(64) Lanes weight;
  std::ranges::transform(
      lanes_.reflectance, weight.begin(), [&](double of_place) { return reflectance * of_place; });
  IntersectionLanes* from = &lanes_;
  IntersectionLanes* to = &followed_;
  bool has_hit = true;
  for (int bounce = 1; has_hit; ++bounce) {
    if (bounce >= scene_.settings.max_bounces) {
      give_up(escapes);
      return;
    }
    intersect_again(scene_, *from, again_, *to);
    escape_again16(*to,
                   again_.triangle.data(),
                   reflectance,
                   weight.data(),
                   arrays_of(escapes),
                   escapes.weight.data());
    for (std::size_t lane = 0; lane < kPacketSize; ++lane) {
      const bool is_hit = again_.triangle[lane] >= 0;
      escapes.path[lane] = is_hit ? RayPath::kFollowed : escapes.path[lane];
      escapes.is_grazing[lane] = escapes.is_grazing[lane] || (is_hit && to->rise[lane] <= 0.0);
    }
    ask_reflected16(*to, again_.triangle.data(), query_);
    scene_.bvh.trace16(query_, Coherence::kCoherentOnce);
    has_hit = take_hits16(query_, again_);
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
  const auto place = static_cast<std::ptrdiff_t>(first);
  for (auto* component : {&cache.origin_x,
                          &cache.origin_y,
                          &cache.origin_z,
                          &cache.direction_x,
                          &cache.direction_y,
                          &cache.weight}) {
    std::fill_n(component->begin() + place, count, 0.0F);
  }
  std::fill_n(cache.direction_z.begin() + place, count, -1.0F);
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
    throw UnseenPart();
  }
}

}  // namespace glint

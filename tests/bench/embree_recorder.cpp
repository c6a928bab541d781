// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/embree_recorder.h"

#include <algorithm>
#include <cmath>

#include <dlfcn.h>
#include <embree3/rtcore.h>

#include "core/error.h"

namespace glint::bench {
namespace {

EmbreeRecord* now_recording = nullptr;

/// Embree's own function of that name, behind the one of this file.
template <class Function>
Function* of_embree(const char* name) {
  void* found = dlsym(RTLD_NEXT, name);
  GLINT_CHECK(found != nullptr, "Embree lacks a function that is to be recorded");
  return reinterpret_cast<Function*>(found);
}

decltype(rtcIntersect16)* embrees_intersect16() {
  static auto* const found = of_embree<decltype(rtcIntersect16)>("rtcIntersect16");
  return found;
}

decltype(rtcOccluded16)* embrees_occluded16() {
  static auto* const found = of_embree<decltype(rtcOccluded16)>("rtcOccluded16");
  return found;
}

RecordedPacket packet_of(const int* valid, const RTCRay16& rays, bool is_coherent) {
  RecordedPacket packet;
  std::copy_n(rays.org_x, 16, packet.origin_x.begin());
  std::copy_n(rays.org_y, 16, packet.origin_y.begin());
  std::copy_n(rays.org_z, 16, packet.origin_z.begin());
  std::copy_n(rays.dir_x, 16, packet.direction_x.begin());
  std::copy_n(rays.dir_y, 16, packet.direction_y.begin());
  std::copy_n(rays.dir_z, 16, packet.direction_z.begin());
  std::copy_n(rays.tnear, 16, packet.near.begin());
  std::copy_n(rays.tfar, 16, packet.far.begin());
  std::copy_n(valid, 16, packet.valid.begin());
  packet.is_coherent = is_coherent;
  return packet;
}

bool is_close(const std::array<float, 16>& a, const std::array<float, 16>& b, std::size_t lane) {
  return std::abs(a[lane] - b[lane]) <= 3e-6F;
}

/// True when all rays are those of the earlier packet, asked for in the same way, turned so little
/// that no other rays of a picture are that close.
bool repeats(const RecordedPacket& packet, const RecordedPacket& earlier) {
  if (packet.is_occlusion != earlier.is_occlusion) {
    return false;
  }
  for (std::size_t i = 0; i < 16; ++i) {
    const bool is_same = earlier.valid[i] != 0 && packet.origin_x[i] == earlier.origin_x[i] &&
                         packet.origin_y[i] == earlier.origin_y[i] &&
                         is_close(packet.direction_x, earlier.direction_x, i) &&
                         is_close(packet.direction_y, earlier.direction_y, i) &&
                         is_close(packet.direction_z, earlier.direction_z, i);
    if (packet.valid[i] != 0 && !is_same) {
      return false;
    }
  }
  return true;
}

void take_down(RTCScene scene, const RecordedPacket& packet) {
  EmbreeRecord& record = *now_recording;
  record.scene = scene;
  if (!record.packets.empty() && repeats(packet, record.packets.back())) {
    ++record.num_retries;
    return;
  }
  record.packets.push_back(packet);
}

bool has_coherent_flag(const RTCIntersectContext& context) {
  return (context.flags & RTC_INTERSECT_CONTEXT_FLAG_COHERENT) != 0;
}

void set_rays(const RecordedPacket& packet, RTCRay16& rays) {
  std::ranges::copy(packet.origin_x, rays.org_x);
  std::ranges::copy(packet.origin_y, rays.org_y);
  std::ranges::copy(packet.origin_z, rays.org_z);
  std::ranges::copy(packet.direction_x, rays.dir_x);
  std::ranges::copy(packet.direction_y, rays.dir_y);
  std::ranges::copy(packet.direction_z, rays.dir_z);
  std::ranges::copy(packet.near, rays.tnear);
  std::ranges::copy(packet.far, rays.tfar);
  std::ranges::fill(rays.time, 0.0F);
  std::ranges::fill(rays.mask, ~0U);
  std::ranges::fill(rays.id, 0U);
  std::ranges::fill(rays.flags, 0U);
}

RTCIntersectContext context_for(bool is_coherent) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags =
      is_coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  return context;
}

float ask_nearest(RTCScene scene, const RecordedPacket& packet, bool is_coherent) {
  RTCRayHit16 query;
  set_rays(packet, query.ray);
  std::ranges::fill(query.hit.geomID, RTC_INVALID_GEOMETRY_ID);
  std::ranges::fill(query.hit.instID[0], RTC_INVALID_GEOMETRY_ID);
  RTCIntersectContext context = context_for(is_coherent);
  embrees_intersect16()(packet.valid.data(), scene, &context, &query);
  return query.ray.tfar[0];
}

float ask_any(RTCScene scene, const RecordedPacket& packet, bool is_coherent) {
  RTCRay16 query;
  set_rays(packet, query);
  RTCIntersectContext context = context_for(is_coherent);
  embrees_occluded16()(packet.valid.data(), scene, &context, &query);
  return query.tfar[0];
}

}  // namespace

int RecordedPacket::num_rays() const {
  return static_cast<int>(std::ranges::count_if(valid, [](std::int32_t v) { return v != 0; }));
}

EmbreeRecording::EmbreeRecording(EmbreeRecord& record) {
  GLINT_CHECK(now_recording == nullptr, "one recording at a time");
  now_recording = &record;
}

EmbreeRecording::~EmbreeRecording() {
  now_recording = nullptr;
}

float ask_again(RTCScene scene, const std::vector<RecordedPacket>& packets, Asking asking) {
  float sum = 0.0F;
  const bool keeps = asking == Asking::kAsRecorded;
  for (const RecordedPacket& packet : packets) {
    const bool is_occlusion =
        keeps ? packet.is_occlusion
              : asking == Asking::kOccludedCoherent || asking == Asking::kOccludedIncoherent;
    const bool is_coherent =
        keeps ? packet.is_coherent
              : asking == Asking::kCoherent || asking == Asking::kOccludedCoherent;
    sum += is_occlusion ? ask_any(scene, packet, is_coherent)
                        : ask_nearest(scene, packet, is_coherent);
  }
  return sum;
}

}  // namespace glint::bench

// The program's own functions of these names come before those of Embree's library, also for calls
// from other libraries of ours.
extern "C" {

void rtcIntersect16(const int* valid,
                    RTCScene scene,
                    RTCIntersectContext* context,
                    RTCRayHit16* rays) {
  namespace bench = glint::bench;
  if (bench::now_recording != nullptr) {
    bench::take_down(scene, bench::packet_of(valid, rays->ray, bench::has_coherent_flag(*context)));
  }
  bench::embrees_intersect16()(valid, scene, context, rays);
}

void rtcOccluded16(const int* valid, RTCScene scene, RTCIntersectContext* context, RTCRay16* rays) {
  namespace bench = glint::bench;
  if (bench::now_recording != nullptr) {
    bench::RecordedPacket packet =
        bench::packet_of(valid, *rays, bench::has_coherent_flag(*context));
    packet.is_occlusion = true;
    bench::take_down(scene, packet);
  }
  bench::embrees_occluded16()(valid, scene, context, rays);
}

}  // extern "C"

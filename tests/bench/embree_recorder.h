// SPDX-License-Identifier: GPL-3.0-or-later
//
// What a renderer asks Embree, taken down packet by packet and asked again without the renderer.
// A program that has this file in it answers these calls of Embree itself and passes them on, with
// our libraries linked statically or shared.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

struct RTCSceneTy;  // Embree's; its headers stay in the .cpp

namespace glint::bench {

using EmbreeScene = RTCSceneTy*;  ///< an RTCScene

/// Sixteen rays without what they met, and how they were asked for.
struct alignas(64) RecordedPacket {
  alignas(64) std::array<float, 16> origin_x, origin_y, origin_z;
  alignas(64) std::array<float, 16> direction_x, direction_y, direction_z;
  alignas(64) std::array<float, 16> near, far;
  alignas(64) std::array<std::int32_t, 16> valid;
  bool is_occlusion = false;
  bool is_coherent = false;

  int num_rays() const;
};

/// Packets of one scene.
struct EmbreeRecord {
  EmbreeScene scene = nullptr;
  std::vector<RecordedPacket> packets;
  std::int64_t num_retries = 0;  ///< packets left out that repeat misses of the one before
};

/// From construction to destruction everything this program asks of Embree sixteen at a time goes
/// into the record; one thread only. A packet that repeats the misses of the one before a
/// millionth of a radian aside (simulator/geometry/bvh/bvh.h) is left out and counted.
class EmbreeRecording {
 public:
  explicit EmbreeRecording(EmbreeRecord& record);
  ~EmbreeRecording();
  EmbreeRecording(const EmbreeRecording&) = delete;
  EmbreeRecording& operator=(const EmbreeRecording&) = delete;
};

/// How recorded packets are asked again.
enum class Asking { kAsRecorded, kCoherent, kIncoherent, kOccludedCoherent, kOccludedIncoherent };

/// Traces all packets by Embree and nothing else. @return something that depends on all answers
float ask_again(EmbreeScene scene, const std::vector<RecordedPacket>& packets, Asking asking);

}  // namespace glint::bench

// SPDX-License-Identifier: GPL-3.0-or-later
//
// What the kernels of packets are tried with.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "core/rng.h"
#include "simulator/render/path_tracing/tile_tracer.h"
#include "tests/simulator/render/path_tracing/path_bench.h"

namespace glint::path_test {

inline constexpr std::size_t kLanes = kPacketSize;
inline constexpr int kPackets = 1000;  // of 16

/// In steps of 2^-24.
inline float uniform(Rng& rng) {
  return static_cast<float>(static_cast<std::int32_t>(rng.uniform() * 0x1p24)) * 0x1p-24F;
}

inline RandomLanes random_lanes(Rng& rng) {
  RandomLanes lanes;
  for (float* numbers :
       {lanes.light_u, lanes.light_v, lanes.lobe_u, lanes.lobe_v, lanes.choice, lanes.roulette}) {
    for (std::size_t i = 0; i < kLanes; ++i) {
      numbers[i] = uniform(rng);
    }
  }
  return lanes;
}

inline MaterialSettings metal_of(std::vector<double> alpha, bool schlick, bool several) {
  return {.type = MaterialSettings::Type::kConductor,
          .reflectance = {0.55},
          .alpha = std::move(alpha),
          .schlick = schlick,
          .multiple_reflections = several};
}

}  // namespace glint::path_test

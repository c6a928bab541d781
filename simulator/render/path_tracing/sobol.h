// SPDX-License-Identifier: GPL-3.0-or-later
//
// Stratified random numbers that are addressed, not drawn: pairs of the Sobol sequence, scrambled
// and shuffled by hashes of (pixel, dimension). Nothing is remembered from sample to sample, so
// pixels and samples can be computed in any order.
//
// Sources: B. Burley, "Practical hash-based Owen scrambling", JCGT 9(4), 2020; the scrambling hash
// is N. Vegdahl's; A. Ahmed, "An implementation algorithm of 2D Sobol sequence fast, elegant, and
// compact", EGSR 2024.
#pragma once

#include <array>
#include <cstdint>

namespace glint {

/// A bijection of 32 bits that scatters neighbours. Source: C. Wellons, "hash-prospector".
constexpr std::uint32_t hash_bits(std::uint32_t x) {
  x ^= x >> 16U;
  x *= 0x21f0aaadU;
  x ^= x >> 15U;
  x *= 0xd35a2d97U;
  x ^= x >> 15U;
  return x;
}

constexpr std::uint32_t reversed_bits(std::uint32_t x) {
  x = (x >> 16U) | (x << 16U);
  x = ((x >> 8U) & 0x00ff00ffU) | ((x & 0x00ff00ffU) << 8U);
  x = ((x >> 4U) & 0x0f0f0f0fU) | ((x & 0x0f0f0f0fU) << 4U);
  x = ((x >> 2U) & 0x33333333U) | ((x & 0x33333333U) << 2U);
  return ((x >> 1U) & 0x55555555U) | ((x & 0x55555555U) << 1U);
}

/// Owen's nested scrambling of a number whose bits stand in reverse: a bit is flipped by a hash of
/// the bits below it.
constexpr std::uint32_t scramble_reversed(std::uint32_t x, std::uint32_t seed) {
  x ^= x * 0x3d20adeaU;
  x += seed;
  x *= (seed >> 16U) | 1U;
  x ^= x * 0x05526c56U;
  x ^= x * 0x53a22864U;
  return x;
}

/// The second Sobol dimension of an index, bits in reverse: the index as a polynomial over two
/// elements with x + 1 put for x.
constexpr std::uint32_t second_sobol_reversed(std::uint32_t index) {
  index ^= index >> 16U;
  index ^= (index >> 8U) & 0x00ff00ffU;
  index ^= (index >> 4U) & 0x0f0f0f0fU;
  index ^= (index >> 2U) & 0x33333333U;
  index ^= (index >> 1U) & 0x55555555U;
  return index;
}

/// The numbers of one sample of one pixel. Any 2^m consecutive samples that start at a multiple of
/// 2^m are a (0, m, 2)-net in every pair.
struct SobolSampler {
  std::uint32_t seed = 0;   ///< of the pixel
  std::uint32_t index = 0;  ///< of the sample

  /// Two numbers in [0, 1), independent of those of other dimensions.
  std::array<double, 2> pair(std::uint32_t dimension) const {
    const std::uint32_t key = hash_bits(seed ^ hash_bits(dimension + 0x9e3779b9U));
    const std::uint32_t shuffled = reversed_bits(scramble_reversed(reversed_bits(index), key));
    const std::uint32_t x = scramble_reversed(shuffled, hash_bits(key + 1U));
    const std::uint32_t y = scramble_reversed(second_sobol_reversed(shuffled), hash_bits(key + 2U));
    return {reversed_bits(x) * 0x1p-32, reversed_bits(y) * 0x1p-32};
  }
};

/// The seed of a pixel's samples.
constexpr std::uint32_t pixel_seed(std::uint32_t pixel, std::uint32_t seed) {
  return hash_bits(pixel ^ hash_bits(seed));
}

}  // namespace glint

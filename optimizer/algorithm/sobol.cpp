// SPDX-License-Identifier: GPL-3.0-or-later
#include "optimizer/algorithm/sobol.h"

#include <algorithm>
#include <array>

#include "core/rng.h"

namespace glint {

namespace {

constexpr int kBits = 32;

/// A primitive polynomial (degree and inner coefficients) and its first direction numbers.
struct Polynomial {
  unsigned degree;
  unsigned coefficients;
  std::array<std::uint32_t, 8> first;
};

/// Dimensions 2 to 40; dimension 1 is the van der Corput sequence.
constexpr std::array<Polynomial, kMaxSobolDimension - 1> kPolynomials = {{
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
    {5, 14, {1, 3, 5, 5, 31}},
    {6, 1, {1, 3, 3, 9, 7, 49}},
    {6, 13, {1, 1, 1, 15, 21, 21}},
    {6, 16, {1, 3, 1, 13, 27, 49}},
    {6, 19, {1, 1, 1, 15, 7, 5}},
    {6, 22, {1, 3, 1, 15, 13, 25}},
    {6, 25, {1, 1, 5, 5, 19, 61}},
    {7, 1, {1, 3, 7, 11, 23, 15, 103}},
    {7, 4, {1, 3, 7, 13, 13, 15, 69}},
    {7, 7, {1, 1, 3, 13, 7, 35, 63}},
    {7, 8, {1, 3, 5, 9, 1, 25, 53}},
    {7, 14, {1, 3, 1, 13, 9, 35, 107}},
    {7, 19, {1, 3, 1, 5, 27, 61, 31}},
    {7, 21, {1, 1, 5, 11, 19, 41, 61}},
    {7, 28, {1, 3, 5, 3, 3, 13, 69}},
    {7, 31, {1, 1, 7, 13, 1, 19, 1}},
    {7, 32, {1, 3, 7, 5, 13, 19, 59}},
    {7, 37, {1, 1, 3, 9, 25, 29, 41}},
    {7, 41, {1, 3, 5, 13, 23, 1, 55}},
    {7, 42, {1, 3, 7, 3, 13, 59, 17}},
    {7, 50, {1, 3, 1, 3, 5, 53, 69}},
    {7, 55, {1, 1, 5, 5, 23, 33, 13}},
    {7, 56, {1, 1, 7, 7, 1, 61, 123}},
    {7, 59, {1, 1, 7, 9, 13, 61, 49}},
    {7, 62, {1, 3, 3, 5, 3, 55, 33}},
    {8, 14, {1, 3, 1, 15, 31, 13, 49, 245}},
    {8, 21, {1, 3, 5, 15, 31, 59, 63, 97}},
    {8, 22, {1, 3, 1, 11, 11, 11, 77, 249}},
}};

using Directions = std::array<std::uint32_t, kBits>;

/// Joe and Kuo's recurrence: v_i = v_{i-s} ^ (v_{i-s} >> s) ^ a_1 v_{i-1} ^ ... ^ a_{s-1}
/// v_{i-s+1}.
Directions directions_of(int dimension) {
  Directions v = {};
  if (dimension == 0) {
    for (unsigned i = 0; i < kBits; ++i) {
      v[i] = 1U << (31 - i);
    }
    return v;
  }
  const Polynomial& p = kPolynomials[static_cast<std::size_t>(dimension - 1)];
  for (unsigned i = 0; i < p.degree; ++i) {
    v[i] = p.first[i] << (31 - i);
  }
  for (unsigned i = p.degree; i < kBits; ++i) {
    v[i] = v[i - p.degree] ^ (v[i - p.degree] >> p.degree);
    for (unsigned k = 1; k < p.degree; ++k) {
      if (((p.coefficients >> (p.degree - 1 - k)) & 1U) != 0) {
        v[i] ^= v[i - k];
      }
    }
  }
  return v;
}

const std::vector<Directions>& all_directions() {
  static const std::vector<Directions> table = [] {
    std::vector<Directions> result;
    result.reserve(kMaxSobolDimension);
    for (int d = 0; d < kMaxSobolDimension; ++d) {
      result.push_back(directions_of(d));
    }
    return result;
  }();
  return table;
}

std::uint32_t sobol_bits(std::uint32_t index, int dimension) {
  const Directions& v = all_directions()[static_cast<std::size_t>(dimension)];
  std::uint32_t bits = 0;
  std::uint32_t gray = index ^ (index >> 1);
  for (std::size_t i = 0; gray != 0; ++i, gray >>= 1) {
    if ((gray & 1U) != 0) {
      bits ^= v[i];
    }
  }
  return bits;
}

}  // namespace

Sobol::Sobol(std::uint64_t seed, int num_dimensions)
    : seed_(seed), num_dimensions_(num_dimensions) {
  Rng rng(seed, Stream::kSearch, 0);
  shifts_.reserve(kMaxSobolDimension);
  for (int d = 0; d < std::min(num_dimensions, kMaxSobolDimension); ++d) {
    shifts_.push_back(rng.next_u32());
  }
}

std::vector<double> Sobol::point(std::uint32_t index) const {
  std::vector<double> point;
  point.reserve(static_cast<std::size_t>(num_dimensions_));
  for (std::size_t d = 0; d < shifts_.size(); ++d) {
    const std::uint32_t bits = sobol_bits(index, static_cast<int>(d)) ^ shifts_[d];
    point.push_back(static_cast<double>(bits) * 0x1p-32);
  }
  // The first 2^33 indices of the stream are kept apart from other users of the same seed.
  Rng rng(seed_, Stream::kSearch, (1ULL << 33) + index);
  while (point.size() < static_cast<std::size_t>(num_dimensions_)) {
    point.push_back(rng.uniform());
  }
  return point;
}

}  // namespace glint

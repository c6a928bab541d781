// SPDX-License-Identifier: GPL-3.0-or-later
//
// Random numbers by Philox, addressed by pixel and frame (docs/theory/sensor.md), and kept in
// blocks of 64 pixels of a frame. Blocks are found by a hash of their address among the next eight
// places, and stay: a place is filled once, by an exchange of its pointer, so that nobody waits.
// Of two threads that draw the same block, the later one drops its own. Memory: 784 bytes a block.
#include "simulator/sensor/pixel_noise.h"

#include <algorithm>
#include <array>
#include <bit>
#include <memory>

#include "core/rng.h"
#include "simulator/sensor/sensor_kernels.h"

namespace glint {
namespace {

namespace kernels = sensor_kernels;

constexpr std::int64_t kBlock_px = 64;

/// Numbers that are drawn together, from whole counters of four words.
constexpr std::int64_t kChunk = 256;

/// Words of a stream.
void draw_words(const kernels::NoiseAddress& address,
                std::int64_t first_pixel,
                std::int64_t count,
                std::uint32_t* words) {
  std::array<std::uint32_t, kChunk + 8> chunk;  // NOLINT(*-member-init): set as far as it is read
  for (std::int64_t begin = 0; begin < count; begin += kChunk) {
    const std::int64_t first = first_pixel + begin;
    const std::int64_t size = std::min(kChunk, count - begin);
    const auto blocks = static_cast<int>((size + 6) / 4);  // up to 3 words before the first pixel
    kernels::philox_words(address, static_cast<std::uint32_t>(first / 4), blocks, chunk.data());
    std::copy_n(chunk.data() + first % 4, size, words + begin);
  }
}

}  // namespace

void draw_noise(
    int seed, int frame, std::int64_t first_pixel, std::int64_t count, const PixelNoise& noise) {
  const auto key = static_cast<std::uint64_t>(seed);
  kernels::NoiseAddress address = {
      .key = {static_cast<std::uint32_t>(key), static_cast<std::uint32_t>(key >> 32)},
      .stream = static_cast<std::uint32_t>(Stream::kShotNoise),
      .frame = static_cast<std::uint32_t>(frame)};
  if (noise.read != nullptr) {
    // Its words have no other use: they are drawn where those of the shot noise will be.
    address.stream = static_cast<std::uint32_t>(Stream::kReadNoise);
    draw_words(address, first_pixel, count, noise.words);
    kernels::normal_quantiles(noise.words, static_cast<int>(count), noise.read);
    address.stream = static_cast<std::uint32_t>(Stream::kShotNoise);
  }
  draw_words(address, first_pixel, count, noise.words);
  kernels::normal_quantiles(noise.words, static_cast<int>(count), noise.shot);
}

struct KeptNoise::Address {
  int seed = 0;
  int frame = 0;
  std::int64_t index = 0;  ///< pixel / 64

  bool operator==(const Address&) const = default;

  /// Finalizer of MurmurHash3. Neighbours of a row, and frames, end far apart.
  std::size_t hash() const {
    std::uint64_t h = static_cast<std::uint64_t>(index) * 0x9E3779B97F4A7C15U +
                      (static_cast<std::uint64_t>(static_cast<std::uint32_t>(seed)) << 32) +
                      static_cast<std::uint32_t>(frame);
    h = (h ^ (h >> 33)) * 0xFF51AFD7ED558CCDU;
    h = (h ^ (h >> 33)) * 0xC4CEB9FE1A85EC53U;
    return h ^ (h >> 33);
  }
};

struct KeptNoise::Block {
  Address address;
  std::array<std::uint32_t, kBlock_px> words;
  std::array<float, kBlock_px> shot;
  std::array<float, kBlock_px> read;
};

KeptNoise::KeptNoise(std::size_t max_bytes)
    : max_blocks_(max_bytes / sizeof(Block)),
      places_(std::bit_ceil(std::max<std::size_t>(1, 2 * max_blocks_))) {}

KeptNoise::~KeptNoise() {
  for (const std::atomic<Block*>& place : places_) {
    const std::unique_ptr<Block> kept(place.load());
  }
}

std::size_t KeptNoise::kept_bytes() const {
  return num_blocks_ * sizeof(Block);
}

/// nullptr: is not kept, and there is no room for it.
const KeptNoise::Block* KeptNoise::block(const Address& address) {
  constexpr std::size_t kTries = 8;
  const std::size_t first = address.hash();
  for (std::size_t i = 0; i < kTries; ++i) {
    const std::size_t place = (first + i) & (places_.size() - 1);
    const Block* known = places_[place].load(std::memory_order_acquire);
    known = known == nullptr ? keep(address, place) : known;
    if (known == nullptr || known->address == address) {
      return known;
    }
  }
  return nullptr;
}

/// Draws a block for a place that was free.
/// @return what is there now, maybe another thread's; nullptr: no more may be kept
const KeptNoise::Block* KeptNoise::keep(const Address& address, std::size_t place) {
  if (num_blocks_.fetch_add(1) >= max_blocks_) {
    --num_blocks_;
    return nullptr;
  }
  auto drawn = std::make_unique_for_overwrite<Block>();
  drawn->address = address;
  draw_noise(
      address.seed,
      address.frame,
      address.index * kBlock_px,
      kBlock_px,
      {.words = drawn->words.data(), .shot = drawn->shot.data(), .read = drawn->read.data()});
  Block* there = nullptr;
  if (places_[place].compare_exchange_strong(there, drawn.get(), std::memory_order_acq_rel)) {
    return drawn.release();
  }
  --num_blocks_;
  return there;
}

void KeptNoise::load(
    int seed, int frame, std::int64_t first_pixel, std::int64_t count, const PixelNoise& noise) {
  for (std::int64_t done = 0; done < count;) {
    const std::int64_t pixel = first_pixel + done;
    const std::int64_t in_block = pixel % kBlock_px;
    const std::int64_t size = std::min(kBlock_px - in_block, count - done);
    const PixelNoise to = {.words = noise.words + done,
                           .shot = noise.shot + done,
                           .read = noise.read != nullptr ? noise.read + done : nullptr};
    const Block* kept = block({.seed = seed, .frame = frame, .index = pixel / kBlock_px});
    if (kept == nullptr) {
      draw_noise(seed, frame, pixel, size, to);
    } else {
      std::copy_n(kept->words.data() + in_block, size, to.words);
      std::copy_n(kept->shot.data() + in_block, size, to.shot);
      if (to.read != nullptr) {
        std::copy_n(kept->read.data() + in_block, size, to.read);
      }
    }
    done += size;
  }
}

KeptNoise& shared_noise() {
  constexpr std::size_t kMaxBytes = std::size_t{64} << 20;
  static KeptNoise noise(kMaxBytes);
  return noise;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// The random numbers behind a sensor's noise. They depend on seed, frame and pixel alone, so a scan
// that is taken again under another light has the same ones: KeptNoise draws them once.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace glint {

/// Of some neighbouring pixels, each as many as there are pixels.
struct PixelNoise {
  std::uint32_t* words = nullptr;  ///< of the shot noise, uniform
  float* shot = nullptr;           ///< their standard normal quantiles
  float* read = nullptr;           ///< standard normal, of the read noise; nullptr: not wanted
};

/// Draws the numbers of pixels [first_pixel, first_pixel + count) of a frame.
/// @param first_pixel  index y * width + x
void draw_noise(
    int seed, int frame, std::int64_t first_pixel, std::int64_t count, const PixelNoise& noise);

/// Numbers that were drawn before, found again as far as memory allows; others are drawn each time.
/// Nothing but time depends on what is kept. Safe to share between threads.
class KeptNoise {
 public:
  /// @param max_bytes  of what is kept; the index of it takes another 2 %
  explicit KeptNoise(std::size_t max_bytes);
  ~KeptNoise();
  KeptNoise(const KeptNoise&) = delete;
  KeptNoise& operator=(const KeptNoise&) = delete;

  /// The same as draw_noise(), whose parameters these are.
  void load(
      int seed, int frame, std::int64_t first_pixel, std::int64_t count, const PixelNoise& noise);

  std::size_t kept_bytes() const;

 private:
  struct Block;
  struct Address;

  const Block* block(const Address& address);
  const Block* keep(const Address& address, std::size_t place);

  std::size_t max_blocks_;
  std::atomic<std::size_t> num_blocks_ = 0;
  std::vector<std::atomic<Block*>> places_;  ///< by a hash of their addresses; nullptr: free
};

/// The program's own: up to 64 MB, kept until it ends.
KeptNoise& shared_noise();

}  // namespace glint

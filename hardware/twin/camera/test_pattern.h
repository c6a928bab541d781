// SPDX-License-Identifier: GPL-3.0-or-later
//
// Pictures that tell their own number in every pixel, for tests and benchmarks of cameras.
#pragma once

#include "hardware/twin/camera/picture_source.h"

namespace glint {

/// Pixel (x, y) of picture n: (3 x + 5 y + (x y mod 251) + 7 n + 1) modulo 2^bits. Two pictures
/// whose numbers differ by less than 2^bits differ in every pixel.
Image<std::uint16_t> test_pattern(int width_px, int height_px, int bits, std::uint64_t number);

/// The pattern whose number is that of the shot.
class TestPatternSource final : public PictureSource {
 public:
  TestPatternSource(int width_px, int height_px) : width_px_(width_px), height_px_(height_px) {}

  void prepare(const CaptureSettings&) override {}

  SensorPicture finished(const CaptureSettings& settings, std::uint64_t shot) override;

  bool is_finished(const CaptureSettings&) override { return true; }

 private:
  int width_px_ = 0;
  int height_px_ = 0;
  Image<std::uint16_t> first_;  ///< number 0, without the modulo
};

}  // namespace glint

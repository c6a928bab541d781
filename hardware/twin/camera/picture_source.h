// SPDX-License-Identifier: GPL-3.0-or-later
//
// Where a simulated camera gets its pictures from.
#pragma once

#include <cstdint>
#include <memory>

#include "core/image/image.h"
#include "hardware/camera/pixel_format.h"

namespace glint {

/// What of a camera's settings changes its pictures.
struct CaptureSettings {
  double exposure_us = 10000.0;
  double gain_db = 0.0;
  double black_level = 0.0;  ///< in codes of 12 bits
  int bits = 8;              ///< of a code

  bool operator==(const CaptureSettings&) const = default;
};

/// Codes of the whole sensor.
using SensorPicture = std::shared_ptr<const Image<std::uint16_t>>;

/// Called from the thread that answers the camera's client: none of these may take more than some
/// milliseconds, so whoever renders does so on a thread of its own.
class PictureSource {
 public:
  PictureSource() = default;
  virtual ~PictureSource() = default;
  PictureSource(const PictureSource&) = delete;
  PictureSource& operator=(const PictureSource&) = delete;

  /// Begins to make the picture that a trigger with these settings would take.
  virtual void prepare(const CaptureSettings& settings) = 0;

  /// The picture as things stand now; empty: it is not finished.
  /// @param shot  how many pictures the camera has taken before
  virtual SensorPicture finished(const CaptureSettings& settings, std::uint64_t shot) = 0;

  /// Whether finished() would give one.
  virtual bool is_finished(const CaptureSettings& settings) = 0;
};

}  // namespace glint

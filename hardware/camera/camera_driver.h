// SPDX-License-Identifier: GPL-3.0-or-later
//
// What SupervisedCamera needs of a library that speaks to cameras. All calls but has_lost_control()
// come from one thread and may block as long as they like: the caller does not wait for them.
#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "core/error.h"
#include "hardware/camera/camera.h"

namespace glint {

/// The camera answers, and does not take the trigger.
class TriggerRefused : public Error {
 public:
  using Error::Error;
};

/// A picture as it came from the network.
struct DriverFrame {
  bool is_complete = false;
  std::string what;  ///< what is wrong with an incomplete one
  Image<std::uint16_t> codes;
  PixelFormat format = PixelFormat::kMono8;
  std::uint64_t frame_id = 0;
  std::uint64_t camera_time_ns = 0;
  std::chrono::system_clock::time_point host_time = {};
};

/// What the camera made of a configuration.
struct DriverSettings {
  CameraDescription description;
  double exposure_us = 0.0;
  double gain = 0.0;
  NamedFeatures others = {};  ///< that change pictures, whoever has set them
};

/// An opened camera; closes it when destroyed.
class CameraDriver {
 public:
  CameraDriver() = default;
  virtual ~CameraDriver() = default;
  CameraDriver(const CameraDriver&) = delete;
  CameraDriver& operator=(const CameraDriver&) = delete;

  virtual CameraDescription describe() = 0;

  /// @throws ConfigError for what the camera does not take, IoError when it does not answer
  virtual DriverSettings configure(const CameraConfiguration& configuration) = 0;

  /// A new stream, in which no picture of an older one can arrive. @throws as configure()
  virtual void start() = 0;
  /// @throws IoError
  virtual void stop() = 0;

  /// @throws TriggerRefused, IoError
  virtual void trigger() = 0;

  /// The next picture, whole or not; empty: none within that time.
  virtual std::optional<DriverFrame> next_frame(std::chrono::milliseconds within) = 0;

  /// Asks the camera something.
  virtual bool answers() = 0;

  /// Whether the camera is known to be under nobody's or somebody else's control by now; from any
  /// thread.
  virtual bool has_lost_control() const = 0;
};

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// A camera as everything else sees it: opened, configured, started, and asked for one picture after
// the other by software trigger. What it is behind this, a real one or a simulated one, nobody can
// tell.
//
//   closed --open--> ready --start--> acquiring --stop--> ready --close--> closed
//                      \_________________\________ lost --reopen--> as before
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/image/image.h"
#include "hardware/camera/pixel_format.h"

namespace glint {

enum class CameraState { kClosed, kReady, kAcquiring, kLost };

/// "closed", "ready", "acquiring", "lost"
std::string_view name_of(CameraState state);

/// A rectangle of the sensor.
struct SensorRegion {
  int x_px = 0;
  int y_px = 0;
  int width_px = 0;
  int height_px = 0;

  bool operator==(const SensorRegion&) const = default;
};

/// What a camera can do.
struct CameraDescription {
  std::string id;  ///< what it is opened by: "vendor-serial"
  std::string address;
  std::string vendor;
  std::string model;
  std::string serial;
  int sensor_width_px = 0;
  int sensor_height_px = 0;
  std::vector<PixelFormat> formats;  ///< of ours
  double min_exposure_us = 0.0;
  double max_exposure_us = 0.0;
  double min_gain = 0.0;  ///< in the unit of `is_gain_in_db`
  double max_gain = 0.0;
  bool has_gain = false;
  bool is_gain_in_db = false;  ///< else in steps of the maker's own
  bool has_software_trigger = false;
  bool has_packet_sockets = false;  ///< of this process: raw sockets take packets without copying
  int packet_size = 0;              ///< bytes with all headers; 0: no network camera
};

/// Features by their names and values, in the order in which they are set.
using NamedFeatures = std::vector<std::pair<std::string, std::string>>;

/// How pictures are taken. What is left empty stays as the camera has it.
struct CameraConfiguration {
  PixelFormat format = PixelFormat::kMono8;
  std::optional<SensorRegion> region = {};  ///< empty: the whole sensor
  double exposure_us = 10000.0;             ///< > 0
  std::optional<double> gain_db = {};       ///< for cameras that have it in dB
  std::optional<double> gain_raw = {};      ///< for the others: in steps of the maker's own
  std::optional<int> packet_size = {};      ///< bytes; tested before it is used
  bool uses_packet_sockets = true;          ///< where the system allows them
  /// Any other feature by its name, in this order.
  NamedFeatures features = {};
  /// Set before all others: what a camera that comes back after a loss had before, by itself.
  NamedFeatures restored = {};
};

enum class FrameStatus {
  kComplete,
  kIncomplete,  ///< packets are missing, also after all retakes
  kTimeout,     ///< the camera answers, and sent nothing
  kRefused,     ///< the camera refuses the trigger
  kLost         ///< the camera does not answer
};

/// "complete", "incomplete", "timeout", "refused", "lost"
std::string_view name_of(FrameStatus status);

/// One picture with all that is known about it. Without pixels unless it is complete.
struct Frame {
  FrameStatus status = FrameStatus::kTimeout;
  std::string what;  ///< a sentence about what went wrong
  Image<std::uint16_t> codes;
  PixelFormat format = PixelFormat::kMono8;
  double exposure_us = 0.0;
  double gain = 0.0;
  std::uint64_t frame_id = 0;
  std::uint64_t camera_time_ns = 0;  ///< of the camera's own clock; 0: it has none
  std::chrono::system_clock::time_point host_time = {};  ///< when its first packet came
  int retakes = 0;      ///< triggers before the one of this picture
  int late_frames = 0;  ///< pictures of older triggers that came in between and were thrown away

  bool is_complete() const { return status == FrameStatus::kComplete; }
};

/// Codes divided by the largest one.
ImageF linear_values(const Frame& frame);

/// May be used from one thread at a time.
class Camera {
 public:
  Camera() = default;
  virtual ~Camera() = default;
  Camera(const Camera&) = delete;
  Camera& operator=(const Camera&) = delete;

  virtual CameraState state() const = 0;

  /// What was found when it was opened, or configured.
  virtual const CameraDescription& description() const = 0;

  /// Only when ready. @throws ConfigError for what the camera does not take, with what it does;
  /// IoError when it does not answer: it is lost then
  virtual void configure(const CameraConfiguration& configuration) = 0;

  /// Ready for triggers. @throws IoError as configure()
  virtual void start() = 0;

  /// Triggers and waits for that trigger's picture: exposure + 1 s for each try, at most 3 retakes
  /// of an incomplete or absent one. A camera that does not answer is lost within exposure + 2 s of
  /// the trigger, or of the new stream that is begun before it when the last picture was not
  /// complete. Never throws for what a camera or a cable does.
  virtual Frame capture() = 0;

  virtual void stop() = 0;

  /// Opens a lost camera again, configures and starts it as before, trying with pauses that grow to
  /// 2 s. Without power it may have forgotten what it had by itself: gain and other features that
  /// change pictures are set, too. @return false: not within that time
  virtual bool reopen(std::chrono::milliseconds within) = 0;

  /// Also when it is lost. Returns within 3 s, whatever the camera does.
  virtual void close() = 0;
};

}  // namespace glint

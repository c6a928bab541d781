// SPDX-License-Identifier: GPL-3.0-or-later
//
// Cameras that speak GenICam, over a network (GigE Vision) or USB (USB3 Vision), through Aravis.
//
// Exposure and gain are set by whichever names the camera has for them (ExposureTime or
// ExposureTimeAbs; Gain in dB, or GainRaw in steps). Range and access checks, which Aravis leaves
// out unless told, are on. Network cameras: the packet size is tried with a test packet before
// pictures are sent, packets that get lost are asked for again, and eight pictures have room.
#pragma once

#include <memory>
#include <string>

#include "hardware/camera/camera_driver.h"
#include "hardware/camera/supervised_camera.h"

namespace glint {

/// How many pictures may be on their way.
inline constexpr int kBuffers = 8;

/// Opens a camera; blocks up to some seconds.
/// @param name  an IPv4 address, or an id as find_cameras() tells it; empty: the first camera
/// @throws IoError when there is none of that name, or another program controls it
std::unique_ptr<CameraDriver> open_aravis_driver(const std::string& name);

/// The same with deadlines, retakes and the way back after a loss.
class AravisCamera final : public Camera {
 public:
  /// @throws IoError as open_aravis_driver(), or when nothing answers within 5 s
  explicit AravisCamera(const std::string& name)
      : camera_([name] { return open_aravis_driver(name); }) {}

  CameraState state() const override { return camera_.state(); }

  const CameraDescription& description() const override { return camera_.description(); }

  void configure(const CameraConfiguration& wanted) override { camera_.configure(wanted); }

  void start() override { camera_.start(); }

  Frame capture() override { return camera_.capture(); }

  void stop() override { camera_.stop(); }

  bool reopen(std::chrono::milliseconds within) override { return camera_.reopen(within); }

  void close() override { camera_.close(); }

 private:
  SupervisedCamera camera_;
};

}  // namespace glint

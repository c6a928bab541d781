// SPDX-License-Identifier: GPL-3.0-or-later
//
// Deadlines, retakes and the way back after a loss, for any driver. The driver's calls run on a
// worker thread. One that does not come back in time is abandoned there together with the driver,
// and the camera is lost; reopen() makes a new driver on a new thread.
#pragma once

#include <functional>
#include <memory>

#include "hardware/camera/abandonable_worker.h"
#include "hardware/camera/camera.h"
#include "hardware/camera/camera_driver.h"
#include "hardware/camera/trigger_ids.h"

namespace glint {

/// How long a camera may take; defaults are what the product uses.
struct CameraDeadlines {
  std::chrono::milliseconds frame =
      std::chrono::milliseconds(1000);  ///< beyond the exposure, for a picture
  std::chrono::milliseconds answer =
      std::chrono::milliseconds(900);  ///< beyond that, for any sign of life
  std::chrono::milliseconds settings =
      std::chrono::milliseconds(5000);  ///< to be opened, configured, started
  std::chrono::milliseconds close = std::chrono::milliseconds(2500);
  std::chrono::milliseconds first_pause =
      std::chrono::milliseconds(250);  ///< between tries to reopen; doubles
  std::chrono::milliseconds longest_pause = std::chrono::milliseconds(2000);
};

inline constexpr int kMaxRetakes = 3;

class SupervisedCamera final : public Camera {
 public:
  /// Opens the camera: blocks, and throws IoError when there is none.
  using OpenDriver = std::function<std::unique_ptr<CameraDriver>()>;

  /// @throws IoError when it cannot be opened
  explicit SupervisedCamera(OpenDriver open, const CameraDeadlines& deadlines = CameraDeadlines());

  ~SupervisedCamera() override { SupervisedCamera::close(); }

  CameraState state() const override { return state_; }

  const CameraDescription& description() const override { return settings_.description; }

  void configure(const CameraConfiguration& configuration) override;
  void start() override;
  Frame capture() override;
  void stop() override;
  bool reopen(std::chrono::milliseconds within) override;
  void close() override;

 private:
  using Clock = AbandonableWorker::Clock;
  struct Session;

  std::shared_ptr<Session> opened(Clock::time_point until) const;
  CameraConfiguration configuration_as_it_was() const;
  std::chrono::milliseconds exposure_time() const;
  std::chrono::milliseconds longest_silence() const;
  Frame capture_once();
  void start_by(Clock::time_point until);
  void stop_by(Clock::time_point until);
  bool renew_stream(Frame& frame);
  bool answers(Clock::time_point until);
  void lose();
  /// @throws IoError when it does not come back in time; the camera is lost then
  template <class Function>
  auto on_worker(Function function, Clock::time_point until, const char* doing);

  Clock::time_point settings_end() const { return Clock::now() + deadlines_.settings; }

  Frame frame_of(FrameStatus status, std::string what) const;

  OpenDriver open_;
  CameraDeadlines deadlines_;
  CameraState state_ = CameraState::kClosed;
  CameraState wanted_ = CameraState::kReady;  ///< what a lost camera comes back to
  bool is_configured_ = false;
  bool needs_new_stream_ = false;  ///< pictures of older triggers may still come in this one
  CameraConfiguration configuration_;
  DriverSettings settings_;
  std::shared_ptr<Session> session_;
};

}  // namespace glint

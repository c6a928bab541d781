// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/camera/supervised_camera.h"

#include <algorithm>
#include <thread>

#include <fmt/format.h>

#include "core/log.h"

namespace glint {
namespace {

using Clock = AbandonableWorker::Clock;
using std::chrono::milliseconds;

milliseconds until_then(Clock::time_point moment) {
  return std::max(milliseconds(0), std::chrono::ceil<milliseconds>(moment - Clock::now()));
}

/// What one trigger brought.
struct Taken {
  FrameStatus status = FrameStatus::kTimeout;
  std::string what;
  std::optional<DriverFrame> frame = {};
  int late_frames = 0;
};

}  // namespace

/// A driver and its thread. The tasks hold it, so that it is destroyed on that thread.
struct SupervisedCamera::Session {
  std::shared_ptr<CameraDriver> driver;
  TriggerIds ids;
  std::unique_ptr<AbandonableWorker> worker = std::make_unique<AbandonableWorker>();

  /// The driver's last owner is a task of the worker: closing a camera may block.
  ~Session() {
    if (driver) {
      worker->call([closing = std::move(driver)]() mutable { closing.reset(); }, Clock::now());
    }
  }
};

namespace {

/// Waits for the picture of the trigger that was sent last.
Taken wait_for_frame(CameraDriver& driver, TriggerIds& ids, Clock::time_point until) {
  constexpr milliseconds kSlice{100};
  Taken taken = {.status = FrameStatus::kTimeout, .what = "no picture came"};
  while (Clock::now() < until) {
    if (driver.has_lost_control()) {
      return {.status = FrameStatus::kLost,
              .what = "the camera is no longer under control",
              .late_frames = taken.late_frames};
    }
    std::optional<DriverFrame> frame = driver.next_frame(std::min(kSlice, until_then(until)));
    if (!frame) {
      continue;
    }
    const FrameAge age = ids.judge(frame->frame_id);
    if (age == FrameAge::kLate) {
      ++taken.late_frames;
      continue;
    }
    if (age == FrameAge::kAhead) {
      taken.what = fmt::format("picture {} is of no trigger that was sent", frame->frame_id);
      return taken;
    }
    taken.status = frame->is_complete ? FrameStatus::kComplete : FrameStatus::kIncomplete;
    taken.what = frame->what;
    taken.frame = std::move(frame);
    return taken;
  }
  return taken;
}

/// Triggers and waits. A trigger that is answered late leaves the picture less time.
Taken take(CameraDriver& driver, TriggerIds& ids, milliseconds wanted, Clock::time_point latest) {
  try {
    ids.triggered();
    driver.trigger();
    return wait_for_frame(driver, ids, std::min(Clock::now() + wanted, latest));
  } catch (const TriggerRefused& refusal) {
    return {.status = FrameStatus::kRefused, .what = refusal.what()};
  } catch (const IoError& error) {
    return {.status = FrameStatus::kLost, .what = error.what()};
  }
}

}  // namespace

template <class Function>
auto SupervisedCamera::on_worker(Function function, Clock::time_point until, const char* doing) {
  try {
    auto result = session_->worker->call(std::move(function), until);
    if (result) {
      if constexpr (!std::is_same_v<decltype(result), bool>) {
        return std::move(*result);
      } else {
        return;
      }
    }
  } catch (const IoError&) {
    lose();
    throw;
  }
  lose();
  throw IoError(fmt::format("the camera does not answer while it {}", doing));
}

SupervisedCamera::SupervisedCamera(OpenDriver open, const CameraDeadlines& deadlines)
    : open_(std::move(open)), deadlines_(deadlines) {
  session_ = opened(Clock::now() + deadlines_.settings);
  if (!session_) {
    throw IoError("the camera does not answer while it is opened");
  }
  state_ = CameraState::kReady;
  settings_.description = on_worker([session = session_] { return session->driver->describe(); },
                                    settings_end(),
                                    "is asked what it is");
}

std::shared_ptr<SupervisedCamera::Session> SupervisedCamera::opened(Clock::time_point until) const {
  auto session = std::make_shared<Session>();
  // A driver that comes too late is closed by the task that opened it.
  auto driver = session->worker->call(
      [open = open_] { return std::shared_ptr<CameraDriver>(open()); }, until);
  if (!driver) {
    return nullptr;
  }
  session->driver = std::move(*driver);
  return session;
}

void SupervisedCamera::configure(const CameraConfiguration& configuration) {
  GLINT_CHECK(state_ == CameraState::kReady, "a camera is configured when it is ready");
  settings_ = on_worker(
      [session = session_, configuration] { return session->driver->configure(configuration); },
      settings_end(),
      "is configured");
  configuration_ = configuration;
  is_configured_ = true;
}

void SupervisedCamera::start() {
  start_by(settings_end());
}

void SupervisedCamera::start_by(Clock::time_point until) {
  GLINT_CHECK(state_ == CameraState::kReady && is_configured_, "only a configured camera starts");
  on_worker(
      [session = session_] {
        session->ids = {};
        session->driver->start();
      },
      until,
      "starts");
  needs_new_stream_ = false;
  state_ = wanted_ = CameraState::kAcquiring;
}

void SupervisedCamera::stop() {
  stop_by(settings_end());
}

void SupervisedCamera::stop_by(Clock::time_point until) {
  if (state_ != CameraState::kAcquiring) {
    return;
  }
  wanted_ = CameraState::kReady;
  on_worker([session = session_] { session->driver->stop(); }, until, "stops");
  state_ = CameraState::kReady;
}

milliseconds SupervisedCamera::exposure_time() const {
  return milliseconds(static_cast<std::int64_t>(settings_.exposure_us / 1000.0) + 1);
}

/// After which a camera that has said nothing is lost.
milliseconds SupervisedCamera::longest_silence() const {
  return exposure_time() + deadlines_.frame + deadlines_.answer;
}

Frame SupervisedCamera::frame_of(FrameStatus status, std::string what) const {
  Frame frame;
  frame.status = status;
  frame.what = std::move(what);
  frame.format = configuration_.format;
  frame.exposure_us = settings_.exposure_us;
  frame.gain = settings_.gain;
  return frame;
}

void SupervisedCamera::lose() {
  if (state_ == CameraState::kLost || state_ == CameraState::kClosed) {
    return;
  }
  log(LogLevel::kWarning, "camera {} is lost", settings_.description.id);
  state_ = CameraState::kLost;
  session_.reset();
}

bool SupervisedCamera::answers(Clock::time_point until) {
  return session_->worker->call([session = session_] { return session->driver->answers(); }, until)
      .value_or(false);
}

Frame SupervisedCamera::capture_once() {
  const auto latest = Clock::now() + longest_silence();
  const milliseconds wanted = exposure_time() + deadlines_.frame;
  std::optional<Taken> taken = session_->worker->call(
      [session = session_, wanted, last = latest - milliseconds(50)] {
        return take(*session->driver, session->ids, wanted, last);
      },
      latest);
  if (!taken) {
    return frame_of(FrameStatus::kLost, "the camera does not answer");
  }
  if (taken->status == FrameStatus::kTimeout && !answers(latest)) {
    return frame_of(FrameStatus::kLost, "no picture came, and the camera does not answer");
  }
  Frame frame = frame_of(taken->status, taken->what);
  frame.late_frames = taken->late_frames;
  if (taken->frame) {
    frame.codes = std::move(taken->frame->codes);
    frame.format = taken->frame->format;
    frame.frame_id = taken->frame->frame_id;
    frame.camera_time_ns = taken->frame->camera_time_ns;
    frame.host_time = taken->frame->host_time;
  }
  return frame;
}

/// Stops and starts, in no more time than a picture may take. @return false: the camera is lost,
/// and the frame says so
bool SupervisedCamera::renew_stream(Frame& frame) {
  const auto until = Clock::now() + longest_silence();
  try {
    stop_by(until);
    start_by(until);
    return true;
  } catch (const Error& error) {
    wanted_ = CameraState::kAcquiring;
    frame = frame_of(FrameStatus::kLost, error.what());
    return false;
  }
}

// The first picture that does not come may be late, and is then known by its id. When a second one
// does not come either, the camera may have missed a trigger and ids may be off by one: a new
// stream counts anew, and nothing of the old one can get into it. A retake that is refused found
// the camera at the picture before, which a new stream ends.
Frame SupervisedCamera::capture() {
  if (state_ == CameraState::kLost) {
    return frame_of(FrameStatus::kLost, "the camera is lost");
  }
  GLINT_CHECK(state_ == CameraState::kAcquiring, "only a started camera is triggered");
  Frame frame;
  int late_frames = 0;
  int timeouts = 0;
  for (int retake = 0; retake <= kMaxRetakes; ++retake) {
    if (needs_new_stream_ && !renew_stream(frame)) {
      break;
    }
    frame = capture_once();
    frame.retakes = retake;
    late_frames += frame.late_frames;
    timeouts += frame.status == FrameStatus::kTimeout ? 1 : 0;
    const bool is_still_busy = frame.status == FrameStatus::kRefused && retake > 0;
    needs_new_stream_ = is_still_busy || (frame.status == FrameStatus::kTimeout && timeouts > 1);
    if (frame.status != FrameStatus::kTimeout && frame.status != FrameStatus::kIncomplete &&
        !is_still_busy) {
      break;
    }
  }
  needs_new_stream_ = needs_new_stream_ || !frame.is_complete();
  frame.late_frames = late_frames;
  if (frame.status == FrameStatus::kLost) {
    lose();
  }
  return frame;
}

/// With what the configuration left to the camera, which may have lost it with its power.
CameraConfiguration SupervisedCamera::configuration_as_it_was() const {
  CameraConfiguration configuration = configuration_;
  const CameraDescription& camera = settings_.description;
  if (camera.has_gain && !configuration.gain_db && !configuration.gain_raw) {
    (camera.is_gain_in_db ? configuration.gain_db : configuration.gain_raw) = settings_.gain;
  }
  configuration.restored = settings_.others;
  return configuration;
}

bool SupervisedCamera::reopen(milliseconds within) {
  const auto until = Clock::now() + within;
  milliseconds pause = deadlines_.first_pause;
  const CameraConfiguration as_it_was = configuration_as_it_was();
  while (Clock::now() < until) {
    try {
      session_ = opened(std::min(until, Clock::now() + deadlines_.settings));
      if (session_) {
        state_ = CameraState::kReady;
        const CameraState wanted = wanted_;
        if (is_configured_) {
          configure(as_it_was);
        }
        if (wanted == CameraState::kAcquiring) {
          start();
        }
        return true;
      }
    } catch (const Error& error) {
      log(LogLevel::kInfo, "the camera is not back yet: {}", error.what());
      session_.reset();
      state_ = CameraState::kLost;
    }
    std::this_thread::sleep_for(std::min(pause, until_then(until)));
    pause = std::min(2 * pause, deadlines_.longest_pause);
  }
  return false;
}

void SupervisedCamera::close() {
  if (session_) {
    const bool is_acquiring = state_ == CameraState::kAcquiring;
    try {
      session_->worker->call(
          [driver = std::move(session_->driver), is_acquiring]() mutable {
            if (is_acquiring) {
              driver->stop();
            }
            driver.reset();
          },
          Clock::now() + deadlines_.close);
    } catch (const Error& error) {
      log(LogLevel::kInfo, "closing the camera: {}", error.what());
    }
    session_.reset();
  }
  state_ = CameraState::kClosed;
}

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/acquisition/acquisition.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <optional>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "core/error.h"
#include "core/units.h"
#include "hardware/acquisition/arm_guide.h"

namespace glint {
namespace {

/// Ends the acquisition; caught where the way back begins.
struct Failure {
  AcquisitionCause cause;
  std::string text;
};

class Acquisition {
 public:
  Acquisition(const AcquisitionPlan& plan,
              const AcquisitionDevices& devices,
              const AcquisitionOptions& options,
              const PictureSink& sink)
      : plan_(plan),
        devices_(devices),
        options_(options),
        sink_(sink),
        guide_(plan.tour, devices.robot, options.speed_share) {}

  AcquisitionResult run() {
    for (const ViewTask& task : plan_.tasks) {
      result_.missing += static_cast<int>(task.positions.size());
    }
    try {
      take_all();
    } catch (const Failure& failure) {
      end_early(failure.cause, failure.text);
    } catch (const ArmFailure& failure) {
      end_early(failure.is_off_tour ? AcquisitionCause::kOffTour : AcquisitionCause::kRobot,
                failure.text);
    } catch (const std::exception& error) {
      end_early(AcquisitionCause::kProgram, error.what());
    }
    result_.where = guide_.place();
    return result_;
  }

 private:
  void take_all() {
    if (result_.missing == 0) {
      bring_to_safety();
      return;
    }
    guide_.find_place();
    for (std::size_t i = 0; i < plan_.tasks.size(); ++i) {
      if (!plan_.tasks[i].positions.empty()) {
        take_view(i);
      }
    }
    all_lights_off();
    guide_.go_to_end([this] { look_for_interrupt(); });
    note_end();
  }

  /// With nothing to take: an earlier session may have left the arm on its way.
  void bring_to_safety() {
    guide_.find_place(plan_.tour.size() - 1);
    guide_.go_to_safe_point([this] { look_for_interrupt(); });
    note_end();
  }

  void note_end() {
    result_.end = guide_.is_at_end() ? AcquisitionEnd::kTour : AcquisitionEnd::kBackedOut;
  }

  /// Calls a device; what it throws becomes a failure of that kind. The user who wants it to end
  /// leaves what a person is asked to do undone.
  template <class Function>
  auto of_device(AcquisitionCause cause, const Function& function) const {
    try {
      return function();
    } catch (const Error& error) {
      if (is_interrupted()) {
        throw Failure{.cause = AcquisitionCause::kInterrupted,
                      .text = std::string(kInterruptedText) + "; " + error.what()};
      }
      throw Failure{.cause = cause, .text = error.what()};
    }
  }

  void take_view(std::size_t index) {
    const ViewTask& task = plan_.tasks[index];
    const std::vector<std::size_t> way = guide_.way(task.point);
    for (std::size_t i = 0; i < way.size(); ++i) {
      look_for_interrupt();
      if (i + 1 == way.size()) {
        configure(task.exposure_us);
        set_lights(task.lights);
      }
      guide_.go(way[i]);
    }
    if (way.empty()) {
      configure(task.exposure_us);
      set_lights(task.lights);
    }
    wait_for_lights();
    take_positions(index);
    all_lights_off();
  }

  void take_positions(std::size_t index) {
    const ViewTask& task = plan_.tasks[index];
    double sharpest = task.sharpest;
    is_first_held_ = task.positions.size() > 1 && sharpest == 0.0;
    for (const int position : task.positions) {
      take_position(index, position, 0, sharpest);
    }
    keep_first(sharpest);
  }

  /// @param attempt  the first one to make
  void take_position(std::size_t index, int position, int attempt, double& sharpest) {
    if (devices_.stage != nullptr && devices_.stage->position() != position) {
      of_device(AcquisitionCause::kStage, [&] { devices_.stage->go_to(position); });
    }
    for (; attempt <= options_.limits.max_retakes; ++attempt) {
      look_for_interrupt();
      TakenPicture picture = {.task = index, .position = position, .attempt = attempt};
      take_picture(picture);
      const double max_blur_px = max_blur_of(picture);
      picture.figures = figures_of(picture.frame, plan_.tasks[index].expected, max_blur_px > 0.0);
      picture.reason = rejection_of(picture.figures, options_.limits, sharpest, max_blur_px);
      if (picture.reason.empty()) {
        sharpest = std::max(sharpest, picture.figures.sharpness);
        if (std::exchange(is_first_held_, false)) {
          first_ = std::move(picture);
        } else {
          keep_first(sharpest);
          keep(picture);
        }
        return;
      }
      keep(picture);
    }
  }

  double max_blur_of(const TakenPicture& picture) const {
    return blur_limit_px(options_.limits, plan_.tasks[picture.task].expected.blur_px);
  }

  /// Gives a picture to the sink, accepted where it has no reason against it.
  void keep(TakenPicture& picture) {
    picture.is_accepted = picture.reason.empty();
    of_sink(picture);
    if (picture.is_accepted) {
      ++result_.accepted;
      --result_.missing;
    } else {
      ++result_.rejected;
    }
  }

  /// The first picture of a sequence waits for the second one, as no earlier one tells how sharp it
  /// should be; where that is much sharper, the first is taken again.
  void keep_first(double& sharpest) {
    if (!first_) {
      return;
    }
    TakenPicture first = std::move(*first_);
    first_.reset();
    first.reason = rejection_of(first.figures, options_.limits, sharpest, max_blur_of(first));
    keep(first);
    if (!first.is_accepted) {
      take_position(first.task, first.position, first.attempt + 1, sharpest);
    }
  }

  void of_sink(const TakenPicture& picture) {
    try {
      sink_(picture);
    } catch (const std::exception& error) {
      throw Failure{.cause = AcquisitionCause::kSink, .text = error.what()};
    }
  }

  /// Between two looks at the arm and at the lights.
  void take_picture(TakenPicture& picture) {
    picture.pose = guide_.still_at_point(options_.still_timeout_s);
    check_lights();
    picture.frame = complete_frame();
    guide_.check_still(picture.pose);
    check_lights();
  }

  Frame complete_frame() {
    Camera& camera = devices_.camera;
    int refused = 0;
    bool was_lost = false;
    for (;;) {
      Frame frame = camera.capture();
      if (frame.is_complete()) {
        return frame;
      }
      if (frame.status == FrameStatus::kRefused && ++refused < options_.max_refused) {
        look_for_interrupt();
        wait(kRefusedPauseS);
      } else if (frame.status == FrameStatus::kLost && !was_lost) {
        was_lost = true;
        reopen();
      } else {
        throw Failure{.cause = AcquisitionCause::kCamera,
                      .text = fmt::format("picture {}: {}", name_of(frame.status), frame.what)};
      }
    }
  }

  void reopen() {
    const auto within = std::chrono::milliseconds(static_cast<int>(1e3 * options_.reopen_s));
    if (!devices_.camera.reopen(within)) {
      throw Failure{
          .cause = AcquisitionCause::kCamera,
          .text = fmt::format("the camera was lost, and did not come back within {:.0f} s",
                              options_.reopen_s)};
    }
  }

  void configure(double exposure_us) {
    if (exposure_us == exposure_us_) {
      return;
    }
    of_device(AcquisitionCause::kCamera, [&] {
      try {
        configure_camera(exposure_us);
      } catch (const IoError&) {
        if (devices_.camera.state() != CameraState::kLost) {
          throw;
        }
        reopen();
        configure_camera(exposure_us);
      }
    });
    exposure_us_ = exposure_us;
  }

  void configure_camera(double exposure_us) {
    Camera& camera = devices_.camera;
    if (camera.state() == CameraState::kAcquiring) {
      camera.stop();
    }
    CameraConfiguration configuration = plan_.camera;
    configuration.exposure_us = exposure_us;
    camera.configure(configuration);
    camera.start();
  }

  /// Those that are not as they should be, or whose state nobody knows.
  void set_lights(const std::vector<std::string>& names) {
    lamp_states_.resize(devices_.lamps.size());
    for (std::size_t i = 0; i < devices_.lamps.size(); ++i) {
      set_light(i, std::ranges::find(names, devices_.lamps[i].light->name()) != names.end());
    }
  }

  void set_light(std::size_t index, bool is_on) {
    const CellLamp& lamp = devices_.lamps[index];
    if (lamp_states_[index] == is_on) {
      return;
    }
    lamp_states_[index].reset();
    of_device(AcquisitionCause::kLight, [&] { lamp.light->set(is_on); });
    lamp_states_[index] = is_on;
    settle_s_ = std::max(settle_s_, is_on ? lamp.settle_s : 0.0);
    changed_at_ = Clock::now();
  }

  /// But for those that are left on, as they may be: for them somebody would have to be asked.
  void all_lights_off() {
    for (std::size_t i = 0; i < lamp_states_.size(); ++i) {
      if (!devices_.lamps[i].is_left_on) {
        set_light(i, false);
      }
    }
  }

  void wait_for_lights() {
    const double passed_s = std::chrono::duration<double>(Clock::now() - changed_at_).count();
    if (settle_s_ > passed_s) {
      wait(settle_s_ - passed_s);
    }
    settle_s_ = 0.0;
  }

  /// An output that somebody else has switched meanwhile.
  void check_lights() {
    for (std::size_t i = 0; i < lamp_states_.size(); ++i) {
      const Light& light = *devices_.lamps[i].light;
      const bool is_on = of_device(AcquisitionCause::kLight, [&light] { return light.is_on(); });
      if (lamp_states_[i] != is_on) {
        throw Failure{.cause = AcquisitionCause::kLight,
                      .text = fmt::format("light {} was {} when a picture was due or taken",
                                          light.name(),
                                          is_on ? "on" : "off")};
      }
    }
  }

  bool is_interrupted() const { return options_.interrupt != nullptr && *options_.interrupt > 0; }

  void look_for_interrupt() const {
    if (is_interrupted()) {
      throw Failure{.cause = AcquisitionCause::kInterrupted, .text = kInterruptedText};
    }
  }

  void wait(double seconds) const {
    if (devices_.wait) {
      devices_.wait(seconds);
    } else {
      std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    }
  }

  /// The only way back; nothing moves when the arm itself is the cause.
  void end_early(AcquisitionCause cause, std::string text) {
    result_.cause = cause;
    result_.text = std::move(text);
    result_.end = AcquisitionEnd::kStopped;
    if (cause == AcquisitionCause::kRobot || cause == AcquisitionCause::kOffTour) {
      return;
    }
    try {
      guide_.back_out();
      result_.end = AcquisitionEnd::kBackedOut;
      all_lights_off();
    } catch (const ArmFailure& failure) {
      result_.text += "; the way back was not made: " + failure.text;
    } catch (const Failure& failure) {
      result_.text += "; " + failure.text;
    } catch (const std::exception& error) {
      result_.text += std::string("; ") + error.what();
    }
  }

  using Clock = std::chrono::steady_clock;
  static constexpr double kRefusedPauseS = 0.25;
  static constexpr const char* kInterruptedText = "interrupted by the user";

  const AcquisitionPlan& plan_;
  const AcquisitionDevices& devices_;
  const AcquisitionOptions& options_;
  const PictureSink& sink_;
  ArmGuide guide_;
  AcquisitionResult result_;
  bool is_first_held_ = false;         ///< the next accepted picture is the first of its sequence
  std::optional<TakenPicture> first_;  ///< taken, and not kept yet
  double exposure_us_ = -1.0;
  std::vector<std::optional<bool>> lamp_states_;  ///< as they were set; empty: not known
  double settle_s_ = 0.0;
  Clock::time_point changed_at_ = Clock::now();
};

}  // namespace

std::string_view name_of(AcquisitionCause cause) {
  constexpr std::array<std::string_view, 9> kNames = {
      "none", "interrupted", "camera", "light", "stage", "disk", "program", "robot", "off_tour"};
  return kNames.at(static_cast<std::size_t>(cause));
}

std::string_view name_of(AcquisitionEnd end) {
  constexpr std::array<std::string_view, 3> kNames = {"tour", "backed_out", "stopped"};
  return kNames.at(static_cast<std::size_t>(end));
}

AcquisitionResult acquire(const AcquisitionPlan& plan,
                          const AcquisitionDevices& devices,
                          const AcquisitionOptions& options,
                          const PictureSink& sink) {
  return Acquisition(plan, devices, options, sink).run();
}

}  // namespace glint

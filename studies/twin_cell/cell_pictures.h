// SPDX-License-Identifier: GPL-3.0-or-later
//
// The pictures of a simulated camera on a simulated robot, rendered ahead on a thread of their own:
// those of all positions of a scan at once, so that a stage that moves waits for nothing.
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "core/cache.h"
#include "hardware/twin/camera/picture_source.h"
#include "studies/twin_cell/cell_renderer.h"

namespace glint {

/// The robot's side tells where the arm will be, when it is there, and when it leaves; the camera's
/// side asks for the picture of that place. All functions may be called from any thread.
class CellPictures final : public PictureSource {
 public:
  /// @param renderer  must outlive this
  /// @param state     where the arm stands at first
  CellPictures(CellRenderer& renderer, const TwinCellState& state);

  /// The arm is on its way there, or a light is going on: begins to render.
  void announce(const TwinCellState& state);

  /// The arm stands there. Without announce() before, rendering begins now.
  void arrive(const TwinCellState& state);

  /// The arm moves: there is no picture until it arrives.
  void leave();

  /// Asked at each trigger where the arm stands, what is on and where the stage is; empty:
  /// something moves. Without it what arrive() and leave() told last holds, which may be some
  /// milliseconds old. Set before the first trigger.
  void set_live(std::function<std::optional<TwinCellState>()> live) { live_ = std::move(live); }

  /// Waits until the picture that was asked for last is finished: a simulated clock stands still
  /// meanwhile. @return false: it took longer, rendering failed, or the stop was asked for
  bool wait_until_finished(std::chrono::milliseconds within, const std::stop_token& stop = {});

  /// What went wrong with the last picture; empty: nothing.
  std::string error() const;

  /// How many pictures were rendered.
  int num_rendered() const;

  void prepare(const CaptureSettings& settings) override;
  SensorPicture finished(const CaptureSettings& settings, std::uint64_t shot) override;
  bool is_finished(const CaptureSettings& settings) override;

 private:
  struct Wanted {
    TwinCellState state;
    CaptureSettings settings;
    std::string key;
  };

  static std::string key_of_both(const TwinCellState& state, const CaptureSettings& settings);
  void want(const TwinCellState& state);  ///< holding the lock
  void run(const std::stop_token& stop);

  CellRenderer& renderer_;
  std::function<std::optional<TwinCellState>()> live_;
  mutable std::mutex mutex_;
  std::condition_variable_any changed_;
  CaptureSettings settings_;
  TwinCellState announced_;              ///< what is rendered for
  std::optional<TwinCellState> stands_;  ///< empty: the arm moves
  std::optional<Wanted> wanted_;         ///< not begun yet
  bool is_rendering_ = false;
  Cache<std::string, std::vector<SensorPicture>> kept_;  ///< each of all positions of the stage
  std::string error_;
  int num_rendered_ = 0;
  std::jthread thread_;
};

}  // namespace glint

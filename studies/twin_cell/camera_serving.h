// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "core/thread_pool.h"
#include "hardware/twin/camera/bad_cable.h"
#include "hardware/twin/camera/camera_twin.h"
#include "hardware/twin/side_channel/side_channel.h"
#include "studies/cell/twin_process.h"
#include "studies/twin_cell/cell_pictures.h"
#include "studies/twin_cell/truth.h"

namespace glint {

/// The camera's twin with its renderer; with a robot, what follows it. Its side channel takes
/// "token", "state", "placement N", "light NAME on|off", "cable ..." (cable_text.h) and "stop".
class CameraServing final : public ServingTwin {
 public:
  /// @param address    that it is found at
  /// @param has_cable  it listens elsewhere, and a cable that can be made bad at that address
  CameraServing(const Cell& cell,
                const Truth& truth,
                std::uint32_t address,
                const TwinCellState& state,
                bool has_cable,
                int threads);

  nlohmann::ordered_json description() const override;

  bool has_ended() const override { return is_stop_asked_; }

  CellPictures& pictures() { return pictures_; }

  const CellRenderer& renderer() const { return renderer_; }

  /// How many times the part has been put down. For any thread.
  int placement() const { return placement_; }

  /// Those of the lights that no person has switched off. For any thread.
  std::vector<std::string> shining(const std::vector<std::string>& lights) const;

  /// No robot is followed: the camera stands where `standing` says, which is asked again when a
  /// person has switched a light.
  void stay_at(std::function<TwinCellState()> standing);

 private:
  std::string answer(const std::string& line);
  std::string told_state() const;
  std::string put_down(const std::string& number);
  std::string switch_light(const std::string& text);
  std::string set_cable(const std::string& text);

  std::uint64_t token_ = 0;  ///< the camera tells it as its manufacturer info
  std::atomic<bool> is_stop_asked_ = false;
  std::atomic<int> placement_ = 1;
  std::set<std::string> manual_;  ///< lights that a person switches
  mutable std::mutex lights_mutex_;
  std::set<std::string> off_;                ///< of these; at first none is
  std::function<TwinCellState()> standing_;  ///< empty: the camera follows a robot
  ThreadPool pool_;
  CellRenderer renderer_;
  CellPictures pictures_;
  CameraTwin camera_;
  std::string address_;
  std::optional<BadCable> cable_;
  std::optional<SideChannel> side_;  ///< last: what it tells is still there when it ends
};

}  // namespace glint

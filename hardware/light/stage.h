// SPDX-License-Identifier: GPL-3.0-or-later
//
// What takes a tunnel's stripes from one position of a scan to the next: a linear stage that moves
// the wall, or a display that shows other stripes.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/image/image.h"
#include "hardware/light/text_link.h"

namespace glint {

class Stage {
 public:
  Stage() = default;
  virtual ~Stage() = default;
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  /// How many positions there are, numbered from 0.
  virtual int num_positions() const = 0;

  /// Returns when it is there. @throws IoError when it does not get there
  virtual void go_to(int position) = 0;

  /// The last one that was reached; -1: none was.
  virtual int position() const = 0;
};

/// Where a linear stage stands at each position.
struct StageWay {
  int positions = 1;
  double first_mm = 0.0;
  double step_mm = 1.0;
  double speed_mm_s = 20.0;    ///< > 0
  double tolerance_mm = 0.02;  ///< > 0; of the position that it tells
  double timeout_s = 60.0;     ///< for one move

  double at_mm(int position) const { return first_mm + position * step_mm; }
};

/// A linear stage whose controller speaks Grbl 1.1, over a serial line or TCP: `G1 X.. F..` is
/// answered by "ok", `?` by "<Idle|MPos:x,y,z|...>". Returns when it tells that it stands still
/// where it was sent; an alarm or error is an IoError with the controller's words. So is a greeting
/// ("Grbl 1.1h ['$' for help]"): the controller has restarted, and counts from where the carriage
/// stood then. Over TCP a greeting before the first answers does not count, as some controllers
/// greet whoever connects.
class LinearStage final : public Stage {
 public:
  /// @param link  to the controller; must outlive the stage. A serial one has twice the time for
  ///              its first answer: a board that restarts waits for a new program first
  LinearStage(TextLink& link, const StageWay& way);

  int num_positions() const override { return way_.positions; }

  void go_to(int position) override;

  int position() const override { return position_; }

 private:
  struct Status {
    std::string state;  ///< "Idle", "Run", "Alarm"
    double x_mm = 0.0;
  };

  void command(const std::string& line, std::chrono::milliseconds within);
  Status status();
  void check_not_restarted(const std::string& answer);

  TextLink& link_;
  StageWay way_;
  bool may_greet_ = false;
  int position_ = -1;
};

/// The text that its user keeps in a Grbl controller: `$I` is answered by
/// "[VER:1.1h.20190825:text]", "[OPT:...]" and "ok". It moves nothing.
/// @return empty: none is kept @throws IoError when it is not answered so
std::string kept_text(TextLink& link);

/// Pictures in a folder: `show.png` is replaced by that of the position, for a program that shows
/// it.
class FolderStage final : public Stage {
 public:
  /// @param pictures  of the positions; at least one
  /// @param settle    how long the display takes
  FolderStage(std::filesystem::path folder,
              std::vector<ImageF> pictures,
              std::chrono::milliseconds settle);

  int num_positions() const override { return static_cast<int>(pictures_.size()); }

  void go_to(int position) override;

  int position() const override { return position_; }

 private:
  std::filesystem::path folder_;
  std::vector<ImageF> pictures_;
  std::chrono::milliseconds settle_;
  int position_ = -1;
};

/// How a frame buffer holds pixels: rows of 4 bytes (blue, green, red, none) or 2 (5, 6, 5 bits).
struct FramebufferLayout {
  int width_px = 0;
  int height_px = 0;
  int bytes_per_pixel = 4;  ///< 2 or 4
  int bytes_per_row = 0;    ///< >= width_px * bytes_per_pixel
};

/// The bytes of a grey picture, cut or filled with black to the frame buffer's size. Pure.
std::vector<std::uint8_t> framebuffer_bytes(const ImageF& picture, const FramebufferLayout& layout);

/// A display behind a frame buffer, as /dev/fb0.
class FramebufferStage final : public Stage {
 public:
  /// @throws ConfigError for a layout that cannot be
  FramebufferStage(std::filesystem::path device,
                   const FramebufferLayout& layout,
                   std::vector<ImageF> pictures,
                   std::chrono::milliseconds settle);

  int num_positions() const override { return static_cast<int>(pictures_.size()); }

  void go_to(int position) override;

  int position() const override { return position_; }

 private:
  std::filesystem::path device_;
  FramebufferLayout layout_;
  std::vector<ImageF> pictures_;
  std::chrono::milliseconds settle_;
  int position_ = -1;
};

}  // namespace glint

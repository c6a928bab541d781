// SPDX-License-Identifier: GPL-3.0-or-later
//
// The twin of a linear stage's controller: the part of Grbl 1.1 that a stage needs, over TCP on
// 127.0.0.1. Its carriage takes as long as a real one.
#pragma once

#include <memory>
#include <optional>
#include <string>

namespace glint {

struct StageTwinSettings {
  int port = 0;  ///< 0: any free one
  double travel_mm = 300.0;
  double max_speed_mm_s = 500.0;
  std::string kept_text;  ///< told by `$I`
};

class StageTwin {
 public:
  /// @throws IoError when the port is taken
  explicit StageTwin(const StageTwinSettings& settings);
  ~StageTwin();
  StageTwin(const StageTwin&) = delete;
  StageTwin& operator=(const StageTwin&) = delete;

  int port() const;

  /// Where the carriage is.
  double position_mm() const;

  /// Where it stands since its last move; none: it moves, or has not been moved yet.
  std::optional<double> reached_mm() const;

  /// Makes it stop in alarm wherever it is, as at its end switch.
  void raise_alarm();

 private:
  class Server;

  std::unique_ptr<Server> server_;
};

/// The controller without its connection: fed with what a client sends, on a clock of the caller's.
class StageController {
 public:
  explicit StageController(const StageTwinSettings& settings) : settings_(settings) {}

  /// @param text   any part of what was sent
  /// @param now_s  does not run back
  /// @return what is answered
  std::string receive(const std::string& text, double now_s);

  double position_mm(double now_s) const;

  std::optional<double> reached_mm(double now_s) const;

  void raise_alarm(double now_s);

 private:
  std::string run(const std::string& line, double now_s);
  std::string move(const std::string& line, double now_s);
  std::string status(double now_s) const;
  bool is_moving(double now_s) const;

  StageTwinSettings settings_;
  std::string unfinished_;  ///< line
  bool is_in_alarm_ = false;
  bool has_moved_ = false;
  double from_mm_ = 0.0;
  double to_mm_ = 0.0;
  double began_s_ = 0.0;
  double speed_mm_s_ = 1.0;
};

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace glint {

/// Progress of a long job on stderr: a bar with ETA on a terminal, a plain line every ten seconds
/// elsewhere. Not thread-safe: one owner calls it.
class Progress {
 public:
  enum class Style { kAuto, kBar, kLines, kNone };

  /// @param total  number of steps, >= 1
  Progress(std::string label, std::int64_t total, Style style = Style::kAuto);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void update(std::int64_t done, std::string_view note = {});

  /// What is drawn after `elapsed_s` seconds: "label [####----] 40 % (12/30) ETA 0:18 note".
  static std::string line(std::string_view label,
                          std::int64_t done,
                          std::int64_t total,
                          double elapsed_s,
                          std::string_view note);

 private:
  void draw(std::string_view note);

  std::string label_;
  std::int64_t total_;
  std::int64_t done_ = 0;
  std::int64_t first_ = -1;  ///< steps that were done before we started (a resumed job)
  Style style_;
  bool is_drawn_ = false;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point last_drawn_;
};

/// "0:18", "12:05", "3:02:10".
std::string duration_text(double seconds);

}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
#include "core/progress.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>
#include <unistd.h>

namespace glint {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_between(Clock::time_point from, Clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

}  // namespace

std::string duration_text(double seconds) {
  const auto total = static_cast<std::int64_t>(std::llround(std::max(0.0, seconds)));
  const std::int64_t hours = total / 3600;
  const std::int64_t minutes = total / 60 % 60;
  if (hours > 0) {
    return fmt::format("{}:{:02}:{:02}", hours, minutes, total % 60);
  }
  return fmt::format("{}:{:02}", minutes, total % 60);
}

Progress::Progress(std::string label, std::int64_t total, Style style)
    : label_(std::move(label)), total_(std::max<std::int64_t>(1, total)), style_(style) {
  if (style_ == Style::kAuto) {
    style_ = ::isatty(STDERR_FILENO) != 0 ? Style::kBar : Style::kLines;
  }
  start_ = Clock::now();
  last_drawn_ = start_;
}

Progress::~Progress() {
  if (style_ == Style::kBar && is_drawn_) {
    std::fputc('\n', stderr);
  }
}

void Progress::update(std::int64_t done, std::string_view note) {
  if (first_ < 0) {
    first_ = done > 0 ? done - 1 : 0;
  }
  done_ = std::min(done, total_);
  const double wait_s = style_ == Style::kBar ? 0.1 : 10.0;
  if (done_ == total_ || seconds_between(last_drawn_, Clock::now()) >= wait_s) {
    draw(note);
  }
}

std::string Progress::line(std::string_view label,
                           std::int64_t done,
                           std::int64_t total,
                           double elapsed_s,
                           std::string_view note) {
  constexpr std::int64_t kWidth = 24;
  const std::int64_t filled = kWidth * done / total;
  const std::string bar = std::string(static_cast<std::size_t>(filled), '#') +
                          std::string(static_cast<std::size_t>(kWidth - filled), '-');
  std::string eta = "?";
  if (done > 0) {
    const auto remaining = static_cast<double>(total - done);
    eta = duration_text(elapsed_s * remaining / static_cast<double>(done));
  }
  return fmt::format("{} [{}] {} % ({}/{}) ETA {}{}{}",
                     label,
                     bar,
                     100 * done / total,
                     done,
                     total,
                     eta,
                     note.empty() ? "" : "  ",
                     note);
}

void Progress::draw(std::string_view note) {
  if (style_ == Style::kNone) {
    return;
  }
  last_drawn_ = Clock::now();
  is_drawn_ = true;
  // The ETA is judged by the steps of this process only, so a resumed job does not look fast.
  const std::int64_t mine = std::max<std::int64_t>(1, done_ - first_);
  const double elapsed_s =
      seconds_between(start_, last_drawn_) * static_cast<double>(done_) / static_cast<double>(mine);
  const std::string text = line(label_, done_, total_, elapsed_s, note);
  if (style_ == Style::kBar) {
    std::fprintf(stderr, "\r\x1b[K%s", text.c_str());
  } else {
    std::fprintf(stderr, "%s\n", text.c_str());
  }
  std::fflush(stderr);
}

}  // namespace glint

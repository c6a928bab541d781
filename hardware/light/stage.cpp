// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/light/stage.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <thread>

#include <fmt/format.h>

#include "core/error.h"
#include "core/file.h"
#include "core/image/image_io.h"

namespace glint {
namespace {

using std::chrono::milliseconds;
constexpr milliseconds kAnswer{2000};
constexpr milliseconds kBetweenQuestions{20};

void check_position(int position, int count) {
  if (position < 0 || position >= count) {
    throw ConfigError("position", fmt::format("is {}, must be 0 to {}", position, count - 1));
  }
}

/// The grey value of a pixel in 8 bits; black beyond the picture.
unsigned grey_at(const ImageF& picture, int x, int y) {
  if (x >= picture.width() || y >= picture.height()) {
    return 0;
  }
  const float value = std::clamp(picture(x, y), 0.0F, 1.0F);
  return static_cast<unsigned>(std::lround(255.0F * value));
}

/// Gives lines one after the other, while there is time for an answer among them: a controller that
/// talks on and on does not answer.
class StageAnswers {
 public:
  explicit StageAnswers(TextLink& link, milliseconds within = kAnswer)
      : link_(link), until_(std::chrono::steady_clock::now() + within) {}

  std::optional<std::string> next() {
    constexpr int kMaxLines = 200;
    const auto left = std::chrono::ceil<milliseconds>(until_ - std::chrono::steady_clock::now());
    if (++lines_ > kMaxLines || left <= milliseconds(0)) {
      return std::nullopt;
    }
    return link_.line(left);
  }

 private:
  TextLink& link_;
  std::chrono::steady_clock::time_point until_;
  int lines_ = 0;
};

}  // namespace

LinearStage::LinearStage(TextLink& link, const StageWay& way)
    : link_(link), way_(way), may_greet_(!link.is_serial()) {
  command("G90", link.is_serial() ? 2 * kAnswer : kAnswer);
  command("G21", kAnswer);
  may_greet_ = false;
}

void LinearStage::check_not_restarted(const std::string& answer) {
  if (!may_greet_ && answer.starts_with("Grbl")) {
    position_ = -1;
    throw IoError(fmt::format(
        "linear stage: its controller has restarted ({}), and its zero is where the carriage stood "
        "then; home the stage ($H), then try again",
        answer));
  }
}

void LinearStage::command(const std::string& line, milliseconds within) {
  link_.send(line + "\n");
  StageAnswers answers(link_, within);
  while (const auto answer = answers.next()) {
    check_not_restarted(*answer);
    if (*answer == "ok") {
      return;
    }
    if (answer->starts_with("error:") || answer->starts_with("ALARM:")) {
      throw IoError(fmt::format("linear stage: {} is answered by {}", line, *answer));
    }
  }
  throw IoError(fmt::format("linear stage: {} is not answered", line));
}

LinearStage::Status LinearStage::status() {
  link_.send("?");
  StageAnswers answers(link_);
  while (const auto answer = answers.next()) {
    check_not_restarted(*answer);
    if (answer->starts_with("ALARM:")) {
      throw IoError("linear stage: " + *answer);
    }
    const std::size_t at = answer->find("|MPos:");
    if (!answer->starts_with("<") || at == std::string::npos) {
      continue;
    }
    Status status = {.state = answer->substr(1, answer->find('|') - 1)};
    const char* begin = answer->data() + at + 6;
    if (std::from_chars(begin, answer->data() + answer->size(), status.x_mm).ec != std::errc()) {
      throw IoError("linear stage: no position in " + *answer);
    }
    return status;
  }
  throw IoError("linear stage: it does not report where it is");
}

void LinearStage::go_to(int position) {
  check_position(position, way_.positions);
  position_ = -1;
  const double goal_mm = way_.at_mm(position);
  command(fmt::format("G1 X{:.4f} F{:.1f}", goal_mm, 60.0 * way_.speed_mm_s), kAnswer);
  const auto until =
      std::chrono::steady_clock::now() +
      std::chrono::duration_cast<milliseconds>(std::chrono::duration<double>(way_.timeout_s));
  while (std::chrono::steady_clock::now() < until) {
    const Status now = status();
    if (now.state.starts_with("Alarm")) {
      throw IoError("linear stage: it is in alarm");
    }
    if (now.state == "Idle") {
      if (!(std::abs(now.x_mm - goal_mm) <= way_.tolerance_mm)) {
        throw IoError(
            fmt::format("linear stage: it stands at {} mm, not at {} mm", now.x_mm, goal_mm));
      }
      position_ = position;
      return;
    }
    std::this_thread::sleep_for(kBetweenQuestions);
  }
  throw IoError(
      fmt::format("linear stage: it did not get to {} mm in {} s", goal_mm, way_.timeout_s));
}

std::string kept_text(TextLink& link) {
  link.send("$I\n");
  StageAnswers answers(link);
  std::string text;
  while (const auto answer = answers.next()) {
    if (*answer == "ok") {
      return text;
    }
    if (answer->starts_with("[VER:") && answer->ends_with("]")) {
      const std::size_t colon = std::min(answer->find(':', 5), answer->size() - 2);
      text = answer->substr(colon + 1, answer->size() - colon - 2);
    }
  }
  throw IoError("linear stage: $I is not answered");
}

FolderStage::FolderStage(std::filesystem::path folder,
                         std::vector<ImageF> pictures,
                         milliseconds settle)
    : folder_(std::move(folder)), pictures_(std::move(pictures)), settle_(settle) {
  make_folder(folder_);
}

void FolderStage::go_to(int position) {
  check_position(position, num_positions());
  position_ = -1;
  write_png(folder_ / "show.png", pictures_[static_cast<std::size_t>(position)], PixelDepth::k8Bit);
  std::this_thread::sleep_for(settle_);
  position_ = position;
}

std::vector<std::uint8_t> framebuffer_bytes(const ImageF& picture,
                                            const FramebufferLayout& layout) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(layout.bytes_per_row) *
                                  static_cast<std::size_t>(layout.height_px));
  for (int y = 0; y < layout.height_px; ++y) {
    std::size_t at = static_cast<std::size_t>(y) * static_cast<std::size_t>(layout.bytes_per_row);
    for (int x = 0; x < layout.width_px; ++x) {
      const unsigned grey = grey_at(picture, x, y);
      if (layout.bytes_per_pixel == 4) {
        std::fill_n(
            bytes.begin() + static_cast<std::ptrdiff_t>(at), 3, static_cast<std::uint8_t>(grey));
      } else {
        const unsigned code = ((grey >> 3U) << 11U) | ((grey >> 2U) << 5U) | (grey >> 3U);
        bytes[at] = static_cast<std::uint8_t>(code & 0xffU);
        bytes[at + 1] = static_cast<std::uint8_t>(code >> 8U);
      }
      at += static_cast<std::size_t>(layout.bytes_per_pixel);
    }
  }
  return bytes;
}

FramebufferStage::FramebufferStage(std::filesystem::path device,
                                   const FramebufferLayout& layout,
                                   std::vector<ImageF> pictures,
                                   milliseconds settle)
    : device_(std::move(device)), layout_(layout), pictures_(std::move(pictures)), settle_(settle) {
  const bool is_possible = layout.width_px > 0 && layout.height_px > 0 &&
                           (layout.bytes_per_pixel == 2 || layout.bytes_per_pixel == 4) &&
                           layout.bytes_per_row >= layout.width_px * layout.bytes_per_pixel;
  if (!is_possible) {
    throw ConfigError("framebuffer",
                      "must have 2 or 4 bytes a pixel, and rows that hold all their pixels");
  }
}

void FramebufferStage::go_to(int position) {
  check_position(position, num_positions());
  position_ = -1;
  const std::vector<std::uint8_t> bytes =
      framebuffer_bytes(pictures_[static_cast<std::size_t>(position)], layout_);
  // A device: it is written in place.
  std::fstream file(device_, std::ios::in | std::ios::out | std::ios::binary);
  const std::string text(bytes.begin(), bytes.end());
  if (!file.write(text.data(), static_cast<std::streamsize>(text.size())).flush()) {
    throw IoError(fmt::format("{}: {}", device_.string(), last_system_error()));
  }
  std::this_thread::sleep_for(settle_);
  position_ = position;
}

}  // namespace glint

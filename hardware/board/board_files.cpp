// SPDX-License-Identifier: GPL-3.0-or-later
#include "hardware/board/board_files.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "core/error.h"
#include "hardware/board/find_board.h"

namespace glint {
namespace {

constexpr int kLargest16 = 65535;

struct ViewInFile {
  int width_px = 0;
  int height_px = 0;
  int largest_code = kLargest16;  ///< that one also of files of other than 16 bits
  BoardView view;
};

int largest_code_of(const Picture& picture) {
  if (picture.bits != 16 || picture.is_float) {
    return kLargest16;
  }
  if (const auto* codes = std::get_if<Image<std::uint16_t>>(&picture.pixels)) {
    return std::ranges::max(codes->values());
  }
  // Colour, of which the luminance is at most the largest code.
  const float brightest = std::ranges::max(std::get<ImageF>(picture.pixels).values());
  return static_cast<int>(std::lround(static_cast<float>(kLargest16) * brightest));
}

/// 0: all 16, or another format.
int code_bits_of(int largest_code) {
  for (const int bits : {10, 12}) {
    if (largest_code < 1 << bits) {
      return bits;
    }
  }
  return 0;
}

/// The largest code of so many bits becomes that of 16.
Pixels spread(Pixels pixels, int bits) {
  const int largest = (1 << bits) - 1;
  if (auto* codes = std::get_if<Image<std::uint16_t>>(&pixels)) {
    for (std::uint16_t& code : codes->values()) {
      code =
          static_cast<std::uint16_t>((kLargest16 * static_cast<int>(code) + largest / 2) / largest);
    }
  } else if (auto* values = std::get_if<ImageF>(&pixels)) {
    for (float& value : values->values()) {
      value *= static_cast<float>(kLargest16) / static_cast<float>(largest);
    }
  }
  return pixels;
}

void check_sizes(std::span<const std::filesystem::path> files,
                 const std::vector<ViewInFile>& found) {
  const ViewInFile& first = found.front();
  for (std::size_t i = 1; i < found.size(); ++i) {
    if (found[i].width_px != first.width_px || found[i].height_px != first.height_px) {
      throw ConfigError(
          fmt::format("{}: has {} x {} pixels, {} has {} x {}; pictures of one camera "
                      "have one size",
                      files[i].string(),
                      found[i].width_px,
                      found[i].height_px,
                      files.front().string(),
                      first.width_px,
                      first.height_px));
    }
  }
}

}  // namespace

BoardsInFiles find_boards(std::span<const std::filesystem::path> files,
                          const Board& board,
                          ThreadPool& pool,
                          const std::function<void(std::size_t, const Picture&)>& use) {
  const auto look = [&](int code_bits) {
    return pool.map<ViewInFile>(std::ssize(files), [&](std::int64_t i) {
      const auto at = static_cast<std::size_t>(i);
      Picture picture = read_picture(files[at]);
      use(at, picture);
      ViewInFile found{.width_px = picture.width(),
                       .height_px = picture.height(),
                       .largest_code = largest_code_of(picture)};
      const Pixels pixels =
          code_bits == 0 ? std::move(picture.pixels) : spread(std::move(picture.pixels), code_bits);
      found.view = find_board(pixels, board);
      return found;
    });
  };
  std::vector<ViewInFile> found = look(0);
  check_sizes(files, found);
  BoardsInFiles result{.width_px = found.front().width_px, .height_px = found.front().height_px};
  for (const ViewInFile& one : found) {
    result.largest_code = std::max(result.largest_code, one.largest_code);
  }
  result.code_bits = code_bits_of(result.largest_code);
  if (result.code_bits != 0) {
    found = look(result.code_bits);
  }
  for (ViewInFile& one : found) {
    result.views.push_back(std::move(one.view));
  }
  return result;
}

}  // namespace glint

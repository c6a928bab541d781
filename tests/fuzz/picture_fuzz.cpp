// SPDX-License-Identifier: GPL-3.0-or-later
//
// libFuzzer target of the readers of pictures and masks. The first byte chooses which; the rest is
// the file, whose format is told by its own first bytes. Whatever comes out must be a sound
// picture, or a ConfigError.
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "core/error.h"
#include "core/image/image_io.h"
#include "studies/inspect/picture_sequence.h"

namespace fs = std::filesystem;

namespace {

/// One file of this process, in memory where the system has such a folder.
const fs::path& fuzzed_file() {
  static const fs::path path = [] {
    const fs::path memory = "/dev/shm";
    const fs::path folder = fs::is_directory(memory) ? memory : fs::temp_directory_path();
    return folder / fmt::format("glint_picture_fuzz_{}.png", ::getpid());
  }();
  static const bool is_removed_at_exit = [] {
    return std::atexit([] {
             std::error_code ignored;
             fs::remove(fuzzed_file(), ignored);
           }) == 0;
  }();
  GLINT_CHECK(is_removed_at_exit, "the file goes with the process");
  return path;
}

void read_any(unsigned kind, const fs::path& path) {
  if (kind == 0) {
    const glint::Picture picture = glint::read_picture(path);
    const auto pixels =
        static_cast<std::size_t>(picture.width()) * static_cast<std::size_t>(picture.height());
    GLINT_CHECK(pixels > 0, "a picture holds pixels");
    GLINT_CHECK(glint::linear_values(picture.pixels).size() == pixels, "a value for each pixel");
  } else if (kind == 1) {
    const glint::Mask mask = glint::read_mask(path);
    GLINT_CHECK(std::ranges::count(mask.values(), 1) > 0, "no mask is empty");
  } else {
    static glint::ThreadPool pool(1);
    const glint::PictureSequence sequence = glint::read_sequence({path}, pool);
    for (const glint::ImageF& frame : glint::linear_frames(sequence)) {
      GLINT_CHECK(std::ranges::all_of(frame.values(), [](float v) { return std::isfinite(v); }),
                  "values are numbers");
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) {
    return 0;
  }
  const fs::path& path = fuzzed_file();
  {
    std::ofstream file(path, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(data + 1), static_cast<std::streamsize>(size - 1));
  }
  try {
    read_any(data[0] % 3U, path);
  } catch (const glint::ConfigError&) {
    return 0;
  }
  return 0;
}

// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <filesystem>
#include <string>
#include <system_error>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "core/image/image_io.h"
#include "core/rng.h"
#include "tests/metrics/overlap/drawn_edges.h"

namespace glint {

/// A folder of its own for each test.
class CompareFiles : public ::testing::Test {
 protected:
  CompareFiles()
      : folder_(std::filesystem::temp_directory_path() /
                fmt::format("glint_compare_{}_{}",
                            ::getpid(),
                            ::testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::create_directories(folder_);
  }

  ~CompareFiles() override {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }

  std::filesystem::path write(const std::string& name,
                              const ImageF& picture,
                              PixelDepth depth = PixelDepth::k16Bit) const {
    std::filesystem::path path = folder_ / name;
    std::filesystem::create_directories(path.parent_path());
    if (path.extension() == ".exr") {
      write_exr(path, picture);
    } else {
      write_png(path, picture, depth);
    }
    return path;
  }

  const std::filesystem::path& folder() const { return folder_; }

 private:
  std::filesystem::path folder_;
};

struct BladeDrawing {
  double shift_x_px = 0.0;
  double shift_y_px = 0.0;
  double scale = 1.0;
  double gain = 1.0;
  double noise = 0.004;
  std::uint64_t index = 0;
};

/// A bright part without symmetry on black, 200 x 160: a disc with a bar to one side, its
/// brightness falling from left to right.
inline ImageF drawn_blade(const BladeDrawing& drawing = {}) {
  ImageF picture = drawn(200, 160, [&](double x, double y) {
    const double u = (x - 100.0 - drawing.shift_x_px) / drawing.scale;
    const double v = (y - 80.0 - drawing.shift_y_px) / drawing.scale;
    const double disc = std::hypot(u + 20.0, v) - 38.0;
    const double bar = std::fmax(std::abs(u - 30.0) - 40.0, std::abs(v + 14.0) - 9.0);
    const double beyond = std::fmin(disc, bar) * drawing.scale;
    const double share = 0.5 * std::erfc(beyond / (std::sqrt(2.0) * 0.6));
    return drawing.gain * (0.01 + (0.5 - 0.002 * u) * share);
  });
  add_normal_noise(picture, drawing.noise, drawing.index);
  return picture;
}

}  // namespace glint

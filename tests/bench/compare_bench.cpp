// SPDX-License-Identifier: GPL-3.0-or-later
//
// Two pictures of 2448 x 2050 px, 16 bit, in files: read, outlines, greys and textures compared; no
// rendering. `ms` and `opencv_ms` are medians of the same run, taken in turns; `of_opencv` is their
// ratio. OpenCV's SSIM (module quality) gets the same pictures as floats in memory.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>
#include <opencv2/quality/qualityssim.hpp>

#include "core/image/image_io.h"
#include "core/median.h"
#include "core/rng.h"
#include "core/wall_clock.h"
#include "studies/compare/compared_pair.h"

namespace glint {
namespace {

constexpr int kWidth = 2448;
constexpr int kHeight = 2050;

/// A toothed wheel with a brushed face that fills most of the picture.
ImageF wheel(double shift_px, std::uint64_t index) {
  ImageF picture(kWidth, kHeight);
  Rng rng(6, Stream::kTest, index);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double u = x + 0.5 - 0.5 * kWidth - shift_px;
      const double v = y + 0.5 - 0.5 * kHeight;
      const double radius = std::hypot(u, v);
      const double edge = 880.0 + 60.0 * std::tanh(4.0 * std::sin(24.0 * std::atan2(v, u)));
      const double share = 0.5 * std::erfc((radius - edge) / 1.1);
      const double face = 0.5 + 0.06 * std::sin(0.9 * radius);
      picture(x, y) = static_cast<float>(0.01 + share * face + 0.01 * rng.normal());
    }
  }
  return picture;
}

cv::Mat mat_of(const ImageF& picture) {
  cv::Mat mat(picture.height(), picture.width(), CV_32FC1);
  for (int y = 0; y < picture.height(); ++y) {
    std::transform(
        picture.row(y), picture.row(y) + picture.width(), mat.ptr<float>(y), [](float g) {
          return 255.0F * g;
        });
  }
  return mat;
}

void compare_five_megapixels(benchmark::State& state) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / fmt::format("glint_compare_bench_{}", ::getpid());
  std::filesystem::create_directories(folder);
  const ImageF first = wheel(0.0, 0);
  const ImageF second = wheel(0.4, 1);
  write_png(folder / "s.png", first, PixelDepth::k16Bit);
  write_png(folder / "r.png", second, PixelDepth::k16Bit);
  const ComparePair pair = {.simulated = {.name = "s", .picture = folder / "s.png"},
                            .real = {.name = "r", .picture = folder / "r.png"}};
  const cv::Mat a = mat_of(first);
  const cv::Mat b = mat_of(second);
  std::vector<double> own;
  std::vector<double> theirs;
  for (auto unused : state) {
    auto start = std::chrono::steady_clock::now();
    const ComparedPair compared = compare_pair(pair, {});
    own.push_back(1000.0 * seconds_since(start));
    benchmark::DoNotOptimize(compared.appearance.ssim);
    start = std::chrono::steady_clock::now();
    benchmark::DoNotOptimize(cv::quality::QualitySSIM::compute(a, b, cv::noArray())[0]);
    theirs.push_back(1000.0 * seconds_since(start));
  }
  std::filesystem::remove_all(folder);
  state.counters["ms"] = median(own);
  state.counters["opencv_ms"] = median(theirs);
  state.counters["of_opencv"] = median(own) / median(theirs);
}

BENCHMARK(compare_five_megapixels)->Unit(benchmark::kMillisecond)->Iterations(5);

}  // namespace
}  // namespace glint

// SPDX-License-Identifier: GPL-3.0-or-later
//
// Two pictures of 2448 x 2050 px, 16 bit, in files: read, outlines, greys and textures compared; no
// rendering. `ms` and `opencv_ms` are medians of the same run, taken in turns; `of_opencv` is their
// ratio. OpenCV's SSIM (module quality) gets the same pictures as floats in memory. And the
// geometry of a rendered view, read at once and channel by channel.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>
#include <unistd.h>
#include <opencv2/quality/qualityssim.hpp>

#include "core/image/exr_layers.h"
#include "core/image/image_io.h"
#include "core/median.h"
#include "core/rng.h"
#include "core/wall_clock.h"
#include "studies/compare/compared_pair.h"
#include "studies/compare/surface/surface_lines.h"

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

/// Ten channels of a sphere, as geometry.exr of `glint render` has them; half of the picture is
/// beside it.
void write_geometry(const std::filesystem::path& path, int width, int height) {
  const double radius = 0.45 * height;
  std::vector<ImageF> images(10, ImageF(width, height));
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double u = (x + 0.5 - 0.5 * width) / radius;
      const double v = (y + 0.5 - 0.5 * height) / radius;
      const double w = std::sqrt(std::max(1.0 - u * u - v * v, 0.0));
      for (std::size_t c = 0; c < images.size() && w > 0.0; ++c) {
        const double normal = c % 3 == 0 ? u : c % 3 == 1 ? v : w;
        images[c](x, y) = static_cast<float>(normal * (1.0 + 20.0 * static_cast<double>(c / 3)));
      }
    }
  }
  std::vector<ExrChannel> channels;
  for (std::size_t c = 0; c < images.size(); ++c) {
    channels.push_back(exr_channel(fmt::format("c{}", c), images[c]));
  }
  write_exr_channels(path, width, height, channels);
}

/// Seven channels of ten, as the surface of a view is read: in one pass (`ms`) and one by one
/// (`one_by_one_ms`), in turns; `ratio` is between both.
void read_geometry(benchmark::State& state) {
  const int width = static_cast<int>(state.range(0));
  const std::filesystem::path path = std::filesystem::temp_directory_path() /
                                     fmt::format("glint_compare_bench_{}.exr", ::getpid());
  write_geometry(path, width, width * 512 / 612);
  const std::vector<std::string> names = {"c0", "c1", "c2", "c3", "c4", "c5", "c6"};
  std::vector<double> together;
  std::vector<double> single;
  for (auto unused : state) {
    auto start = std::chrono::steady_clock::now();
    benchmark::DoNotOptimize(read_exr_channels(path, names));
    together.push_back(1000.0 * seconds_since(start));
    start = std::chrono::steady_clock::now();
    for (const std::string& name : names) {
      benchmark::DoNotOptimize(read_exr_channels(path, std::span(&name, 1)));
    }
    single.push_back(1000.0 * seconds_since(start));
  }
  std::filesystem::remove(path);
  state.counters["ms"] = median(together);
  state.counters["one_by_one_ms"] = median(single);
  state.counters["ratio"] = median(single) / median(together);
}

BENCHMARK(read_geometry)->Arg(612)->Arg(2448)->Unit(benchmark::kMillisecond)->Iterations(5);

/// So many surfaces one around another: each has the one before in its window. Times per surface
/// say whether the cost grows with their number alone.
void nested_surfaces(benchmark::State& state) {
  const auto rings = static_cast<int>(state.range(0));
  NamedSurfaces surfaces = {.labels = Image<int>(kWidth, kHeight)};
  for (int i = 0; i < rings; ++i) {
    surfaces.names.push_back("plane");
  }
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double radius = std::hypot(x - 0.5 * kWidth, y - 0.5 * kHeight) / (0.5 * kHeight);
      surfaces.labels(x, y) =
          radius < 1.0 ? rings - static_cast<int>(radius * rings) : NamedSurfaces::kBackground;
    }
  }
  std::size_t lines = 0;
  for (auto unused : state) {
    lines = lines_between(surfaces).size();
  }
  state.counters["lines"] = static_cast<double>(lines);
  state.counters["surfaces"] = rings;
}

BENCHMARK(nested_surfaces)->Arg(5)->Arg(20)->Arg(80)->Unit(benchmark::kMillisecond)->Iterations(1);

}  // namespace
}  // namespace glint

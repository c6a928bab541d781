// SPDX-License-Identifier: GPL-3.0-or-later
//
// One scan of 24 frames, 1300 x 300 px, 8 bit, pictures in memory to list of defects. `ms` and
// `opencv_ms` are medians of the same run, taken in turns; `of_opencv` is their ratio.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include "core/median.h"
#include "core/rng.h"
#include "core/wall_clock.h"
#include "metrics/inspection/inspector.h"
#include "metrics/inspection/masked_filter.h"
#include "tests/bench/inspect_by_opencv.h"

namespace glint {
namespace {

constexpr int kWidth = 1300;
constexpr int kHeight = 300;
constexpr int kFrames = 24;
constexpr double kThreshold = 0.05;

/// The part of the seed's pictures: an ellipse that fills most of them.
Mask part_mask() {
  Mask mask(kWidth, kHeight);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double u = (x + 0.5 - 0.5 * kWidth) / (0.49 * kWidth);
      const double v = (y + 0.5 - 0.5 * kHeight) / (0.49 * kHeight);
      mask(x, y) = std::pow(std::abs(u), 4.0) + std::pow(std::abs(v), 4.0) < 1.0 ? 1 : 0;
    }
  }
  return mask;
}

/// 40 defects: what of a stripe's light each pixel sees more.
ImageF defects() {
  ImageF added(kWidth, kHeight);
  for (std::uint64_t i = 0; i < 40; ++i) {
    Rng rng(5, Stream::kTest, i);
    const double x0 = rng.uniform(100.0, kWidth - 100.0);
    const double y0 = rng.uniform(30.0, kHeight - 30.0);
    const double angle = rng.uniform(0.0, 3.2);
    const double across_px = rng.uniform(1.0, 3.0);
    const double along_px = i % 3 == 0 ? rng.uniform(10.0, 20.0) : across_px;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double u = (x - x0) * std::cos(angle) + (y - y0) * std::sin(angle);
        const double v = (y - y0) * std::cos(angle) - (x - x0) * std::sin(angle);
        const double square = u * u / (along_px * along_px) + v * v / (across_px * across_px);
        added(x, y) += static_cast<float>(0.4 * std::exp(-0.5 * square));
      }
    }
  }
  return added;
}

/// Stripes of 52 px that wander through one period, two grey values of noise.
std::vector<Image<std::uint8_t>> sequence() {
  const ImageF added = defects();
  std::vector<Image<std::uint8_t>> frames;
  for (int j = 0; j < kFrames; ++j) {
    Image<std::uint8_t> frame(kWidth, kHeight);
    Rng rng(6, Stream::kTest, static_cast<std::uint64_t>(j));
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const double phase = (x + 0.01 * x * y / 52.0) / 52.0 + static_cast<double>(j) / kFrames;
        const double stripe = phase - std::floor(phase) < 0.5 ? 200.0 : 25.0;
        const double grey = stripe + 255.0 * static_cast<double>(added(x, y)) + 2.0 * rng.normal();
        frame(x, y) = static_cast<std::uint8_t>(std::clamp(grey, 0.0, 255.0));
      }
    }
    frames.push_back(std::move(frame));
  }
  return frames;
}

/// Empty when both lists name the same blobs.
std::string difference(const std::vector<FoundDefect>& ours,
                       const std::vector<OpenCvBlob>& theirs) {
  if (ours.size() != theirs.size()) {
    return std::to_string(ours.size()) + " against " + std::to_string(theirs.size()) + " blobs";
  }
  for (const FoundDefect& defect : ours) {
    const auto same = std::ranges::find_if(theirs, [&](const OpenCvBlob& blob) {
      return std::hypot(blob.x_px - defect.x_px, blob.y_px - defect.y_px) < 0.01 &&
             blob.area_px == defect.area_px && std::abs(blob.weight - defect.weight) < 1e-3;
    });
    if (same == theirs.end()) {
      return "blobs differ";
    }
  }
  return {};
}

void bench_inspect(benchmark::State& state, int threads, std::optional<double> threshold) {
  static const std::vector<Image<std::uint8_t>> frames = sequence();
  static const Mask mask = part_mask();
  using Threshold = InspectionSettings::Threshold;
  const InspectionSettings settings{
      .threshold = threshold.has_value() ? Threshold::kFixed : Threshold::kNoise,
      .threshold_grey = threshold.value_or(1.0),
      .polarity = InspectionSettings::Polarity::kBright};
  const Inspector inspector(settings, mask);
  OpenCvInspector opencv(
      settings.kernel_px, gaussian_sigma(settings), mask, inspector.region(), threads);
  ThreadPool pool(threads);
  std::vector<double> ours_s;
  std::vector<double> theirs_s;
  Inspection found;
  std::vector<OpenCvBlob> blobs;
  for (auto _ : state) {
    const auto ours = std::chrono::steady_clock::now();
    found = inspector.inspect(frames, pool);
    ours_s.push_back(seconds_since(ours));
    const auto theirs = std::chrono::steady_clock::now();
    blobs = opencv.inspect(frames, threshold);
    theirs_s.push_back(seconds_since(theirs));
    state.SetIterationTime(ours_s.back());
  }
  const std::string wrong = difference(found.defects, blobs);
  if (!wrong.empty()) {
    state.SkipWithError(wrong.c_str());
    return;
  }
  state.counters["of_opencv"] = median(ours_s) / median(theirs_s);
  state.counters["ms"] = 1e3 * median(ours_s);
  state.counters["opencv_ms"] = 1e3 * median(theirs_s);
  state.counters["blobs"] = static_cast<double>(blobs.size());
}

BENCHMARK_CAPTURE(bench_inspect, fixed, 2, kThreshold)
    ->Name("inspect/fixed_threshold/jobs2")
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime()
    ->Iterations(301);
BENCHMARK_CAPTURE(bench_inspect, fixed1, 1, kThreshold)
    ->Name("inspect/fixed_threshold/jobs1")
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime()
    ->Iterations(301);
BENCHMARK_CAPTURE(bench_inspect, noise, 2, std::nullopt)
    ->Name("inspect/noise_threshold/jobs2")
    ->Unit(benchmark::kMillisecond)
    ->UseManualTime()
    ->Iterations(301);

}  // namespace
}  // namespace glint
